"""Numbers of the faults, which are parameters of the FMU, and of the functions that misbehave."""

from enum import IntEnum

from orchestration.fmi.signatures import FUNCTIONS

NO_FAULT = -1


class Fault(IntEnum):
    """What a call does instead of, or besides, what it should do; below 100 it returns that status."""

    WARNING = 1
    DISCARD = 2
    ERROR = 3
    FATAL = 4
    PENDING = 5
    UNKNOWN = 77
    SEGMENTATION = 100
    ARITHMETIC = 101
    ABORT = 102
    EXIT = 103
    HANG = 104
    LEAK = 105
    BEYOND = 106
    THREADS = 107
    PERCENT_N = 108
    PERCENT_S = 109
    NAN = 110
    IDLE = 111

    @property
    def word(self) -> str:
        """Its name in the documented table."""
        return self.name.lower().replace("_", " ")


FIRST_BESIDE_STATUS = Fault.SEGMENTATION
NUMBERS = {name: number for number, name in enumerate(FUNCTIONS)}
"""Number of each function of FMI 2.0 for co-simulation."""


def header(references: dict[str, int]) -> str:
    """C definitions of the faults, the functions, and the value references of the FMU's parameters."""
    lines = [f"#define NO_FAULT ({NO_FAULT})", f"#define FIRST_FAULT_BESIDE_STATUS {int(FIRST_BESIDE_STATUS)}"]
    lines += [f"#define FAULT_{fault.name} {int(fault)}" for fault in Fault]
    lines += [f"#define FUNCTION_{name.removeprefix('fmi2')} {number}" for name, number in NUMBERS.items()]
    lines += [f"#define REFERENCE_{name.upper()} {reference}" for name, reference in references.items()]
    return "\n".join(lines) + "\n"
