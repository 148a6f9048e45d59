"""The functions of an FMI 2.0 co-simulation FMU and their C types; nothing here needs more than ctypes."""

import ctypes as ct
from typing import Any

CO_SIMULATION = 1

_component, _text, _flag, _size = ct.c_void_p, ct.c_char_p, ct.c_int, ct.c_size_t
_references, _reals, _integers = ct.POINTER(ct.c_uint), ct.POINTER(ct.c_double), ct.POINTER(ct.c_int)
_texts, _state, _states = ct.POINTER(ct.c_char_p), ct.c_void_p, ct.POINTER(ct.c_void_p)

Logger = ct.CFUNCTYPE(None, ct.c_void_p, ct.c_char_p, ct.c_int, ct.c_char_p, ct.c_char_p)
Allocate = ct.CFUNCTYPE(ct.c_void_p, ct.c_size_t, ct.c_size_t)
Free = ct.CFUNCTYPE(None, ct.c_void_p)


class Callbacks(ct.Structure):
    """fmi2CallbackFunctions."""

    _fields_ = (
        ("logger", Logger),
        ("allocateMemory", Allocate),
        ("freeMemory", Free),
        ("stepFinished", ct.c_void_p),
        ("componentEnvironment", ct.c_void_p),
    )


# Arguments after the component, of all functions that take one and return a status.
ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "fmi2SetDebugLogging": (_flag, _size, _texts),
    "fmi2SetupExperiment": (_flag, ct.c_double, ct.c_double, _flag, ct.c_double),
    "fmi2EnterInitializationMode": (),
    "fmi2ExitInitializationMode": (),
    "fmi2Terminate": (),
    "fmi2Reset": (),
    "fmi2GetReal": (_references, _size, _reals),
    "fmi2GetInteger": (_references, _size, _integers),
    "fmi2GetBoolean": (_references, _size, _integers),
    "fmi2GetString": (_references, _size, _texts),
    "fmi2SetReal": (_references, _size, _reals),
    "fmi2SetInteger": (_references, _size, _integers),
    "fmi2SetBoolean": (_references, _size, _integers),
    "fmi2SetString": (_references, _size, _texts),
    "fmi2GetFMUstate": (_states,),
    "fmi2SetFMUstate": (_state,),
    "fmi2FreeFMUstate": (_states,),
    "fmi2SerializedFMUstateSize": (_state, ct.POINTER(_size)),
    "fmi2SerializeFMUstate": (_state, ct.c_char_p, _size),
    "fmi2DeSerializeFMUstate": (ct.c_char_p, _size, _states),
    "fmi2GetDirectionalDerivative": (_references, _size, _references, _size, _reals, _reals),
    "fmi2SetRealInputDerivatives": (_references, _size, _integers, _reals),
    "fmi2GetRealOutputDerivatives": (_references, _size, _integers, _reals),
    "fmi2DoStep": (ct.c_double, ct.c_double, _flag),
    "fmi2CancelStep": (),
    "fmi2GetStatus": (_flag, _integers),
    "fmi2GetRealStatus": (_flag, _reals),
    "fmi2GetIntegerStatus": (_flag, _integers),
    "fmi2GetBooleanStatus": (_flag, _integers),
    "fmi2GetStringStatus": (_flag, _texts),
}
_INSTANTIATE = (_text, _flag, _text, _text, ct.POINTER(Callbacks), _flag, _flag)
# The other four: result and arguments.
OTHERS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "fmi2GetTypesPlatform": (_text, ()),
    "fmi2GetVersion": (_text, ()),
    "fmi2Instantiate": (_component, _INSTANTIATE),
    "fmi2FreeInstance": (None, (_component,)),
}
FUNCTIONS = (*OTHERS, *ARGUMENTS)


def prototype(function: str) -> tuple[Any, tuple[Any, ...]]:
    """C types of a function: of its result, and of all its arguments."""
    return OTHERS[function] if function in OTHERS else (ct.c_int, (_component, *ARGUMENTS[function]))
