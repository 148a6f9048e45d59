"""Valid arguments for the 34 functions of FMI, the states that allow each function, and the meaning of a refusal.

The table is that of FMI 2.0.5, section 4.2.4 (co-simulation); "error" is stepFailed and error.
"""

import ctypes as ct
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from tests.conformance.binary import ARGUMENTS, ERROR, PHASES, Instance, array

INSTANTIATED, INITIALIZATION, STEP_COMPLETE, TERMINATED, FAILED = PHASES
ALWAYS = frozenset(PHASES)
GET = frozenset({INITIALIZATION, STEP_COMPLETE, TERMINATED, FAILED})
SET = frozenset({INSTANTIATED, INITIALIZATION, STEP_COMPLETE})
STATUS = frozenset({STEP_COMPLETE, TERMINATED, FAILED})
NEVER: frozenset[str] = frozenset()

ALLOWED: dict[str, frozenset[str]] = {
    "fmi2SetDebugLogging": ALWAYS,
    "fmi2SetupExperiment": frozenset({INSTANTIATED}),
    "fmi2EnterInitializationMode": frozenset({INSTANTIATED}),
    "fmi2ExitInitializationMode": frozenset({INITIALIZATION}),
    "fmi2Terminate": frozenset({STEP_COMPLETE}),
    "fmi2Reset": ALWAYS,
    "fmi2GetReal": GET,
    "fmi2GetInteger": GET,
    "fmi2GetBoolean": GET,
    "fmi2GetString": GET,
    "fmi2SetReal": SET,
    "fmi2SetInteger": SET,
    "fmi2SetBoolean": SET,
    "fmi2SetString": SET,
    "fmi2GetFMUstate": ALWAYS,
    "fmi2SetFMUstate": ALWAYS,
    "fmi2FreeFMUstate": ALWAYS,
    "fmi2SerializedFMUstateSize": ALWAYS,
    "fmi2SerializeFMUstate": ALWAYS,
    "fmi2DeSerializeFMUstate": ALWAYS,
    "fmi2DoStep": frozenset({STEP_COMPLETE}),
    "fmi2GetStatus": STATUS,
    "fmi2GetRealStatus": STATUS,
    "fmi2GetBooleanStatus": STATUS,
    "fmi2GetStringStatus": STATUS,
    # No step is ever in progress; FMI 2.0 defines no Integer status.
    "fmi2CancelStep": NEVER,
    "fmi2GetIntegerStatus": NEVER,
}
# Functions that modelDescription.xml may declare as absent: attribute, its value then, and where the
# function is allowed otherwise.
CAPABILITIES: dict[str, tuple[str, Any, frozenset[str]]] = {
    "fmi2GetDirectionalDerivative": ("providesDirectionalDerivative", False, GET),
    "fmi2SetRealInputDerivatives": ("canInterpolateInputs", False, SET),
    "fmi2GetRealOutputDerivatives": ("maxOutputDerivativeOrder", 0, STATUS),
}


@dataclass
class Call:
    """A call's arguments after the component, and memory that only has to outlive it."""

    arguments: tuple[Any, ...]
    results: list[Any] = field(default_factory=list)


def arguments(instance: Instance, function: str) -> Call:
    """Arguments with which `function` succeeds where it is allowed, and changes something if it sets."""
    make = _MAKERS.get(function)
    return make(instance) if make else Call(tuple(kind() for kind in ARGUMENTS[function]))


def assert_refused(instance: Instance, status: int, before: bytes, *texts: str) -> None:
    """The call failed with a message that holds the texts, and changed nothing."""
    assert status == ERROR
    for text in texts:
        assert text in instance.last, instance.last
    assert instance.blob() == before


def _get(c_type: Any, type: str) -> Callable[[Instance], Call]:
    def make(instance: Instance) -> Call:
        names = instance.binary.names("output", "input", "parameter", type=type)
        values = array(c_type, [c_type(77).value] * len(names))
        return Call((instance.references(*names), len(names), values), [values])

    return make


def _set(c_type: Any, type: str) -> Callable[[Instance], Call]:
    """The first input of that type, set to something else; none if there is none."""

    def make(instance: Instance) -> Call:
        names = instance.binary.names("input", type=type)[:1]
        starts = instance.binary.starts("input")
        values = array(c_type, (c_type(int(starts[n]) + 1).value for n in names))
        return Call((instance.references(*names), len(names), values))

    return make


def _state(instance: Instance) -> ct.c_void_p:
    """A state of the instance; it stays allocated until the process ends."""
    state = ct.c_void_p()
    instance.call("fmi2GetFMUstate", ct.byref(state))
    return state


def _serialize(instance: Instance) -> Call:
    size = len(instance.blob())
    return Call((_state(instance), ct.create_string_buffer(size), size))


def _deserialize(instance: Instance) -> Call:
    blob = instance.blob()
    return Call((blob, len(blob), ct.byref(ct.c_void_p())))


def _status(kind: int, c_type: Any) -> Callable[[Instance], Call]:
    def make(_: Instance) -> Call:
        return Call((kind, ct.byref(c_type())))

    return make


_MAKERS: dict[str, Callable[[Instance], Call]] = {
    "fmi2SetDebugLogging": lambda _: Call((1, 0, None)),
    "fmi2SetupExperiment": lambda _: Call((0, 0.0, 0.25, 1, 8.0)),
    "fmi2GetReal": _get(ct.c_double, "Real"),
    "fmi2GetInteger": _get(ct.c_int, "Integer"),
    "fmi2GetBoolean": _get(ct.c_int, "Boolean"),
    "fmi2SetReal": _set(ct.c_double, "Real"),
    "fmi2SetInteger": _set(ct.c_int, "Integer"),
    "fmi2SetBoolean": _set(ct.c_int, "Boolean"),
    "fmi2GetFMUstate": lambda _: Call((ct.byref(ct.c_void_p()),)),
    "fmi2SetFMUstate": lambda instance: Call((_state(instance),)),
    "fmi2FreeFMUstate": lambda instance: Call((ct.byref(_state(instance)),)),
    "fmi2SerializedFMUstateSize": lambda instance: Call((_state(instance), ct.byref(ct.c_size_t()))),
    "fmi2SerializeFMUstate": _serialize,
    "fmi2DeSerializeFMUstate": _deserialize,
    "fmi2DoStep": lambda instance: Call((instance.time, 1e-4, 1)),
    "fmi2GetStatus": _status(0, ct.c_int),
    "fmi2GetRealStatus": _status(2, ct.c_double),
    "fmi2GetIntegerStatus": _status(0, ct.c_int),
    "fmi2GetBooleanStatus": _status(3, ct.c_int),
    "fmi2GetStringStatus": _status(1, ct.c_char_p),
}
