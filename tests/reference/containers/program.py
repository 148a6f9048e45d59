"""The C program of a system as a shared library that Python steps."""

import ctypes
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from adaptimp_fmu.binary import binary
from adaptimp_fmu.toolchain import host_platform
from orchestration import System
from orchestration.containers.c.program import c_sources, compiled_files
from orchestration.containers.plan import GAUSS_SEIDEL, OUTPUT, Plan, plan_of

EXPORTS = """#include "step.h"
#define EXPORT __attribute__((visibility("default")))
EXPORT uint64_t program_size(void);
EXPORT uint32_t program_place(uint32_t variable);
EXPORT void program_reset(ID(System) *s);
EXPORT int program_set(ID(System) *s, uint32_t variable, double value, Failure *failure);
EXPORT double program_get(ID(System) *s, uint32_t variable);
EXPORT double program_time(const ID(System) *s);
EXPORT void program_begin(ID(System) *s, double start_time);
EXPORT int program_finish(ID(System) *s, Failure *failure);
EXPORT int program_initialize(ID(System) *s, double start_time, Failure *failure);
EXPORT int program_step(ID(System) *s, uint64_t n, Failure *failure);
uint64_t program_size(void) { return sizeof(ID(System)); }
uint32_t program_place(uint32_t variable) { return ID(variables)[variable].place; }
void program_reset(ID(System) *s) { ID(reset)(s); }
int program_set(ID(System) *s, uint32_t variable, double value, Failure *f) { return ID(set)(s, variable, value, f); }
double program_get(ID(System) *s, uint32_t variable) { return ID(get)(s, variable); }
double program_time(const ID(System) *s) { return ID(time)(s); }
void program_begin(ID(System) *s, double start_time) { ID(begin)(s, start_time); }
int program_finish(ID(System) *s, Failure *f) { return ID(finish)(s, f); }
int program_initialize(ID(System) *s, double start_time, Failure *f) { return ID(initialize)(s, start_time, f); }
int program_step(ID(System) *s, uint64_t n, Failure *f) { return ID(step)(s, n, f); }
"""


class _Argument(ctypes.Structure):
    _fields_ = (("kind", ctypes.c_char), ("number", ctypes.c_double), ("text", ctypes.c_char_p))


class _Failure(ctypes.Structure):
    _fields_ = (
        ("component", ctypes.c_char_p),
        ("sentence", ctypes.c_char_p),
        ("n", ctypes.c_int),
        ("arguments", _Argument * 6),
    )

    def __str__(self) -> str:
        """The sentence with its arguments, after the name of the component."""
        found = [a.text.decode() if a.kind == b"s" else a.number for a in self.arguments[: self.n]]
        sentence = (self.sentence or b"").decode() % tuple(found)
        return f"{self.component.decode()}: {sentence}" if self.component else sentence


class RefusedError(Exception):
    """A function of the program returned 0; the message is the failure."""


class Program:
    """One instance of the program of a system.

    Parameters
    ----------
    plan
        Plan of the program; equal programs are compiled once.
    """

    def __init__(self, plan: Plan, folder: Path) -> None:
        self.plan = plan
        sources = c_sources(plan) | {"exports.c": f"#define ID(name) {plan.identifier}_##name\n{EXPORTS}"}
        content = binary("program", sources, host_platform(), compiled=[*compiled_files(plan), "exports.c"])
        path = folder / f"{plan.identifier}_{abs(hash(content))}{host_platform().extension}"
        if not path.exists():
            path.write_bytes(content)
        self._library = ctypes.CDLL(str(path))
        for name, kind in (("size", ctypes.c_uint64), ("get", ctypes.c_double), ("time", ctypes.c_double)):
            getattr(self._library, f"program_{name}").restype = kind
        self._memory = np.zeros(int(self._library.program_size()) // 8)
        self._state = ctypes.c_void_p(self._memory.ctypes.data)
        self.index = {variable.path: i for i, variable in enumerate(plan.variables)}
        outputs = [i for i, variable in enumerate(plan.variables) if variable.role == OUTPUT]
        self.names = tuple(plan.variables[i].path for i in outputs)
        self._outputs = outputs
        self._places = [int(self._library.program_place(ctypes.c_uint32(i))) for i in outputs]
        self.reset()

    @classmethod
    def of(cls, system: System, folder: Path, algorithm: str = GAUSS_SEIDEL) -> "Program":
        """Return the program of a system."""
        return cls(plan_of(system, algorithm), folder)

    def reset(self) -> None:
        """Every value at its start."""
        self._library.program_reset(self._state)

    def initialize(self, start_time: float = 0.0) -> None:
        """Initialize for a run from a time on, s."""
        self._call("initialize", ctypes.c_double(start_time))

    def begin(self, start_time: float = 0.0) -> None:
        """Enter the initialization."""
        self._library.program_begin(self._state, ctypes.c_double(start_time))

    def finish(self) -> None:
        """Leave the initialization."""
        self._call("finish")

    def step(self, n: int = 1) -> None:
        """Make n inner steps."""
        self._call("step", ctypes.c_uint64(n))

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by their names."""
        for name, value in values.items():
            self._call("set", ctypes.c_uint32(self.index[name]), ctypes.c_double(value))

    def __getitem__(self, name: str) -> float:
        """The present value of a variable."""
        return self._library.program_get(self._state, ctypes.c_uint32(self.index[name]))

    @property
    def time(self) -> float:
        """The present time, s."""
        return self._library.program_time(self._state)

    def shown(self) -> np.ndarray:
        """The outputs by ``get``."""
        return np.array([self._library.program_get(self._state, ctypes.c_uint32(i)) for i in self._outputs])

    def rows(self, counts: Sequence[int]) -> np.ndarray:
        """Run, and read the outputs from memory before and after each step of so many inner steps."""
        return np.array(list(self._read_rows(counts)))

    def _read_rows(self, counts: Sequence[int]) -> Iterator[np.ndarray]:
        yield self._memory[self._places]
        for n in counts:
            self.step(n)
            yield self._memory[self._places]

    def snapshot(self) -> np.ndarray:
        """A copy of the memory, which is the whole state."""
        return self._memory.copy()

    def restore(self, snapshot: np.ndarray) -> None:
        """Put a copy of the memory back."""
        self._memory[:] = snapshot

    def _call(self, name: str, *arguments: object) -> None:
        failure = _Failure()
        if not getattr(self._library, f"program_{name}")(self._state, *arguments, ctypes.byref(failure)):
            raise RefusedError(str(failure))
