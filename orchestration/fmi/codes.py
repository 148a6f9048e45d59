"""Names and numbers that FMI 2.0 defines: types of variables, statuses of calls, capability flags."""

from enum import IntEnum

REAL, INTEGER, BOOLEAN, STRING = "Real", "Integer", "Boolean", "String"
"""Types of variables; an Enumeration is treated as an Integer."""
ENUMERATION = "Enumeration"
STANDS_FOR = {"BooleanAsReal": BOOLEAN, "IntegerAsReal": INTEGER}
"""Names of declared types whose Reals are 0 or 1, or whole numbers, and what these stand for; see
`adaptimp_fmu.build`."""

SAVES_STATE, SERIALIZES_STATE = "canGetAndSetFMUstate", "canSerializeFMUstate"
INTERPOLATES, DIFFERENTIATES = "canInterpolateInputs", "providesDirectionalDerivative"
VARIES_STEP = "canHandleVariableCommunicationStepSize"
ONE_INSTANCE = "canBeInstantiatedOnlyOncePerProcess"
NEEDS_TOOL = "needsExecutionTool"
CAPABILITIES = (SAVES_STATE, SERIALIZES_STATE, INTERPOLATES, DIFFERENTIATES, VARIES_STEP, ONE_INSTANCE, NEEDS_TOOL)
"""Capability flags of an FMU for co-simulation that a master asks for."""


class Status(IntEnum):
    """The fmi2Status that a call returns, from best to worst."""

    OK = 0
    WARNING = 1
    DISCARD = 2
    ERROR = 3
    FATAL = 4
    PENDING = 5

    def __str__(self) -> str:
        """The name in the standard, such as ``fmi2Error``."""
        return "fmi2OK" if self is Status.OK else f"fmi2{self.name.capitalize()}"


WORST_ACCEPTED = int(Status.WARNING)
"""Worst status of a call that succeeded."""

UNDEFINED = 2**31 - 1
"""What calls by address return in place of a status that FMI does not define, such as -1: loops see a failure."""


def known_status(status: int) -> int:
    """Return a status of FMI, or `UNDEFINED` in place of any other number."""
    return status if Status.OK <= status <= Status.PENDING else UNDEFINED


def accepted(status: int) -> bool:
    """Whether a call succeeded: its status is fmi2OK or fmi2Warning."""
    return Status.OK <= status <= WORST_ACCEPTED


def status_name(status: int) -> str:
    """Return the name of a status in the standard; an unknown number is named by its value."""
    if status == UNDEFINED:
        return "a status that FMI does not define"
    return str(Status(status)) if Status.OK <= status <= Status.PENDING else f"status {status}"
