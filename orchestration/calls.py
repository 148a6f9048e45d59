"""Calls of C functions by address, from compiled and from plain Python code.

Compiled by numba, a call costs what it costs in C. Not compiled, the same names go through ctypes:
so the loop that uses them also runs undecorated, as a slow oracle of itself. Addresses are
arguments, never constants, so that numba's cache stays valid.
"""

import ctypes
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

_TRANSFER = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)
_DO_STEP = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int32)
_I8P, _I32, _I64, _F64 = ir.IntType(8).as_pointer(), ir.IntType(32), ir.IntType(64), ir.DoubleType()


def call_transfer(function: int, component: int, references: int, n: int, values: int) -> int:
    """Call fmi2GetReal or one of its like; all arguments but `n` are addresses.

    Returns
    -------
    int
        The fmi2Status.
    """
    # ctypes takes no NumPy integers, which is what the table holds
    return _TRANSFER(int(function))(int(component), int(references), int(n), int(values))


def call_do_step(function: int, component: int, t: float, h: float) -> int:
    """Call fmi2DoStep at t s with step h s; returns the fmi2Status.

    noSetFMUStatePriorToCurrentPoint is true: fixed-step algorithms never go back.
    """
    return _DO_STEP(int(function))(int(component), t, h, 1)


@intrinsic
def _transfer(typing: Any, function: Any, component: Any, references: Any, n: Any, values: Any) -> Any:
    signature = types.int32(types.int64, types.int64, types.int64, types.int64, types.int64)
    kind = ir.FunctionType(_I32, [_I8P, _I8P, _I64, _I8P])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, component, references, n, values = arguments
        callee = builder.inttoptr(address, kind.as_pointer())
        pointers = [builder.inttoptr(a, _I8P) for a in (component, references, values)]
        return builder.call(callee, [pointers[0], pointers[1], n, pointers[2]])

    return signature, generate


@intrinsic
def _do_step(typing: Any, function: Any, component: Any, t: Any, h: Any) -> Any:
    signature = types.int32(types.int64, types.int64, types.float64, types.float64)
    kind = ir.FunctionType(_I32, [_I8P, _F64, _F64, _I32])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, component, t, h = arguments
        callee = builder.inttoptr(address, kind.as_pointer())
        pointer = builder.inttoptr(component, _I8P)
        return builder.call(callee, [pointer, t, h, ir.Constant(_I32, 1)])

    return signature, generate


# numba compares the signatures of overload and implementation, annotations included: both have none.
@overload(call_transfer)
def _compile_transfer(function, component, references, n, values):
    return lambda function, component, references, n, values: _transfer(function, component, references, n, values)


@overload(call_do_step)
def _compile_do_step(function, component, t, h):
    return lambda function, component, t, h: _do_step(function, component, t, h)
