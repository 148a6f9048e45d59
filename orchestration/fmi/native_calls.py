"""Calls of C functions by address, from compiled and from plain Python code.

Compiled by numba, a call costs as much as in C. Without compilation the same functions go through ctypes,
so a loop that uses them also runs as plain Python, as a slow oracle of itself. Addresses are
arguments, never constants, so that machine code can be kept from one process to the next. In place of
a status that FMI does not define the calls return `UNDEFINED`.
"""

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, cast

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from orchestration.fmi.codes import UNDEFINED, Status, known_status

SOURCES = (Path(__file__), Path(__file__).with_name("codes.py"))
"""Sources that are compiled into every function that calls by address."""

Arguments = ParamSpec("Arguments")

_TRANSFER = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)
_DO_STEP = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int32)
_STATE = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
_RATES = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p
)
_DIRECTION = ctypes.CFUNCTYPE(
    *(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t),
    *(ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p),
)
_ALL_BITS = 2**32 - 1
_I8P, _I32, _I64, _F64 = ir.IntType(8).as_pointer(), ir.IntType(32), ir.IntType(64), ir.DoubleType()


def call_transfer(function: int, component: int, references: int, n: int, values: int) -> int:
    """Call fmi2GetReal or another get or set function; all arguments but `n` are addresses.

    Returns
    -------
    int
        The fmi2Status.
    """
    # ctypes takes no NumPy integers, which is what the table holds
    return known_status(_TRANSFER(int(function))(int(component), int(references), int(n), int(values)))


def call_do_step(function: int, component: int, t: float, h: float) -> int:
    """Call fmi2DoStep at t s with step h s; returns the fmi2Status.

    The argument noSetFMUStatePriorToCurrentPoint is true, because fixed-step algorithms never go back.
    """
    return known_status(_DO_STEP(int(function))(int(component), t, h, 1))


def call_state(function: int, component: int, state: int) -> int:
    """Call fmi2GetFMUstate with the address of a state, or fmi2SetFMUstate with a state.

    Returns
    -------
    int
        The fmi2Status.
    """
    return known_status(_STATE(int(function))(int(component), int(state)))


def call_rates(function: int, component: int, references: int, n: int, orders: int, values: int) -> int:
    """Call fmi2SetRealInputDerivatives; all arguments but `n` are addresses; returns the fmi2Status."""
    return known_status(_RATES(int(function))(int(component), int(references), int(n), int(orders), int(values)))


def call_direction(function: int, component: int, unknowns: int, n: int, known: int, seed: int, values: int) -> int:
    """Call fmi2GetDirectionalDerivative for one known variable.

    Parameters
    ----------
    unknowns, n
        Address of the references of the outputs, and their number.
    known, seed
        Addresses of the input's reference and of its differential.
    values
        Address of the outputs' differentials.

    Returns
    -------
    int
        The fmi2Status.
    """
    return known_status(
        _DIRECTION(int(function))(int(component), int(unknowns), int(n), int(known), 1, int(seed), int(values))
    )


def raw_transfer(function: int, component: int, references: int, n: int, values: int) -> int:
    """Call a get or set function like `call_transfer`, and return its status as the unsigned number that it is.

    A loop that compares the number with the worst accepted status finds negative ones, too, and needs no further
    instruction for that. `known_status` says afterwards which status it was.
    """
    return _TRANSFER(int(function))(int(component), int(references), int(n), int(values)) & _ALL_BITS


def raw_do_step(function: int, component: int, t: float, h: float) -> int:
    """Call fmi2DoStep like `call_do_step`, and return its status like `raw_transfer`."""
    return _DO_STEP(int(function))(int(component), t, h, 1) & _ALL_BITS


def copy_run(source: np.ndarray, first: int, rows: np.ndarray, row: int | np.uint64, column: int, n: int) -> None:
    """Copy n doubles from `first` on into a row from `column` on; both arrays are contiguous."""
    rows[row, int(column) : int(column + n)] = source[int(first) : int(first + n)]


def copy_bytes(source: int, target: int, n: int) -> None:
    """Copy n bytes from an address to another; the ranges do not overlap."""
    ctypes.memmove(int(target), int(source), int(n))


def emitted(emit: Callable[Concatenate[Any, Arguments], Any]) -> Callable[Arguments, Any]:
    """Let compiled functions call what numba's ``intrinsic`` makes of a function.

    Parameters
    ----------
    emit
        Receives numba's typing context, which the caller does not give, and the types of the arguments.
    """
    return cast("Callable[Arguments, Any]", intrinsic(emit))


def call_for_status(builder: Any, callee: Any, arguments: Any) -> Any:
    """Build a call of a function that returns an fmi2Status, or `UNDEFINED` for what FMI does not define."""
    status = builder.call(callee, arguments)
    is_defined = builder.icmp_unsigned("<=", status, ir.Constant(_I32, int(Status.PENDING)))
    return builder.select(is_defined, status, ir.Constant(_I32, UNDEFINED))


def _transfer(result: Any, finish: Callable[[Any, Any, Any], Any]) -> Any:
    """An intrinsic that calls a get or set function, with the type of its result and what makes the result."""

    @emitted
    def emit(typing: Any, function: Any, component: Any, references: Any, n: Any, values: Any) -> Any:
        kind = ir.FunctionType(_I32, [_I8P, _I8P, _I64, _I8P])

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            address, component, references, n, values = arguments
            callee = builder.inttoptr(address, kind.as_pointer())
            pointers = [builder.inttoptr(a, _I8P) for a in (component, references, values)]
            return finish(builder, callee, [pointers[0], pointers[1], n, pointers[2]])

        return result(*[types.int64] * 5), generate

    return emit


def _do_step(result: Any, finish: Callable[[Any, Any, Any], Any]) -> Any:
    """An intrinsic that calls fmi2DoStep, with the type of its result and what makes the result."""

    @emitted
    def emit(typing: Any, function: Any, component: Any, t: Any, h: Any) -> Any:
        kind = ir.FunctionType(_I32, [_I8P, _F64, _F64, _I32])

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            address, component, t, h = arguments
            callee = builder.inttoptr(address, kind.as_pointer())
            pointer = builder.inttoptr(component, _I8P)
            return finish(builder, callee, [pointer, t, h, ir.Constant(_I32, 1)])

        return result(types.int64, types.int64, types.float64, types.float64), generate

    return emit


def _call(builder: Any, callee: Any, arguments: Any) -> Any:
    return builder.call(callee, arguments)


emit_transfer, emit_raw_transfer = _transfer(types.int32, call_for_status), _transfer(types.uint32, _call)
"""What `call_transfer` and `raw_transfer` compile to."""
emit_do_step, emit_raw_do_step = _do_step(types.int32, call_for_status), _do_step(types.uint32, _call)
"""What `call_do_step` and `raw_do_step` compile to."""


@emitted
def emit_state(typing: Any, function: Any, component: Any, state: Any) -> Any:
    """What `call_state` compiles to."""
    signature = types.int32(types.int64, types.int64, types.int64)
    kind = ir.FunctionType(_I32, [_I8P, _I8P])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, component, state = arguments
        callee = builder.inttoptr(address, kind.as_pointer())
        return call_for_status(builder, callee, [builder.inttoptr(component, _I8P), builder.inttoptr(state, _I8P)])

    return signature, generate


@emitted
def emit_rates(typing: Any, function: Any, component: Any, references: Any, n: Any, orders: Any, values: Any) -> Any:
    """What `call_rates` compiles to."""
    signature = types.int32(*[types.int64] * 6)
    kind = ir.FunctionType(_I32, [_I8P, _I8P, _I64, _I8P, _I8P])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, component, references, n, orders, values = arguments
        callee = builder.inttoptr(address, kind.as_pointer())
        pointers = [builder.inttoptr(a, _I8P) for a in (component, references, orders, values)]
        return call_for_status(builder, callee, [*pointers[:2], n, *pointers[2:]])

    return signature, generate


@emitted
def emit_direction(
    typing: Any, function: Any, component: Any, unknowns: Any, n: Any, known: Any, seed: Any, values: Any
) -> Any:
    """What `call_direction` compiles to."""
    signature = types.int32(*[types.int64] * 7)
    kind = ir.FunctionType(_I32, [_I8P, _I8P, _I64, _I8P, _I64, _I8P, _I8P])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, component, unknowns, n, known, seed, values = arguments
        callee = builder.inttoptr(address, kind.as_pointer())
        pointers = [builder.inttoptr(a, _I8P) for a in (component, unknowns, known, seed, values)]
        return call_for_status(builder, callee, [*pointers[:2], n, pointers[2], ir.Constant(_I64, 1), *pointers[3:]])

    return signature, generate


def _load(kind: Any, pointed: Any) -> Callable[[int], Any]:
    """An intrinsic that reads the value at an address."""

    @emitted
    def load(typing: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return builder.load(builder.inttoptr(arguments[0], pointed.as_pointer()))

        return kind(types.int64), generate

    return load


def _store(kind: Any, pointed: Any) -> Callable[[int, Any], None]:
    """An intrinsic that writes a value to an address."""

    @emitted
    def store(typing: Any, address: Any, value: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            builder.store(arguments[1], builder.inttoptr(arguments[0], pointed.as_pointer()))
            return context.get_dummy_value()

        return types.void(types.int64, kind), generate

    return store


# Of functions that a loop calls by address, which get addresses instead of arrays; compiled only.
load_integer, store_integer = _load(types.int64, _I64), _store(types.int64, _I64)
load_real, store_real = _load(types.float64, _F64), _store(types.float64, _F64)
load_reference, store_discrete = _load(types.uint32, _I32), _store(types.int32, _I32)


@emitted
def _copy_run(typing: Any, source: Any, first: Any, rows: Any, row: Any, column: Any, n: Any) -> Any:
    signature = types.void(source, first, rows, row, column, n)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source, first, rows, row, column, n = arguments
        source = context.make_array(signature.args[0])(context, builder, source)
        rows = context.make_array(signature.args[2])(context, builder, rows)
        width = builder.extract_value(rows.shape, 1)
        place = builder.add(builder.mul(row, width), column)
        target = builder.gep(rows.data, [place])
        cgutils.raw_memcpy(builder, target, builder.gep(source.data, [first]), n, 8)
        return context.get_dummy_value()

    return signature, generate


@emitted
def _copy_bytes(typing: Any, source: Any, target: Any, n: Any) -> Any:
    signature = types.void(types.int64, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source, target = (builder.inttoptr(address, _I8P) for address in arguments[:2])
        cgutils.raw_memcpy(builder, target, source, arguments[2], 1)
        return context.get_dummy_value()

    return signature, generate


# numba compares the signatures of overload and implementation, annotations included: both have none.
@overload(call_transfer)
def _compile_transfer(function, component, references, n, values):
    return lambda function, component, references, n, values: emit_transfer(function, component, references, n, values)


@overload(call_do_step)
def _compile_do_step(function, component, t, h):
    return lambda function, component, t, h: emit_do_step(function, component, t, h)


@overload(raw_transfer)
def _compile_raw_transfer(function, component, references, n, values):
    return lambda function, component, references, n, values: emit_raw_transfer(
        function, component, references, n, values
    )


@overload(raw_do_step)
def _compile_raw_do_step(function, component, t, h):
    return lambda function, component, t, h: emit_raw_do_step(function, component, t, h)


@overload(call_state)
def _compile_state(function, component, state):
    return lambda function, component, state: emit_state(function, component, state)


@overload(call_rates)
def _compile_rates(function, component, references, n, orders, values):
    return lambda function, component, references, n, orders, values: emit_rates(
        function, component, references, n, orders, values
    )


@overload(call_direction)
def _compile_direction(function, component, unknowns, n, known, seed, values):
    return lambda function, component, unknowns, n, known, seed, values: emit_direction(
        function, component, unknowns, n, known, seed, values
    )


@overload(copy_run)
def _compile_copy_run(source, first, rows, row, column, n):
    return lambda source, first, rows, row, column, n: _copy_run(source, first, rows, row, column, n)


@overload(copy_bytes)
def _compile_copy_bytes(source, target, n):
    return lambda source, target, n: _copy_bytes(source, target, n)
