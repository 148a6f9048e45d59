"""What compiled code needs to talk to another process: words in shared memory, system calls, calls by address.

Addresses are arguments, as in `orchestration.fmi.native_calls`.
"""

import platform
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils

from orchestration.fmi.native_calls import call_for_status, emitted
from orchestration.fmi.remote_layout import LONGEST_SLEEP

_I64, _F64, _I32 = types.int64, types.float64, types.int32
_PAUSES = {"x86_64": "llvm.x86.sse2.pause", "AMD64": "llvm.x86.sse2.pause"}
_BYTES, _WORD, _INT, _REAL = ir.IntType(8).as_pointer(), ir.IntType(64), ir.IntType(32), ir.DoubleType()


@emitted
def read_word(typing: Any, address: Any) -> Any:
    """Read a word that the other process writes, and after it what was written before it."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load_atomic(builder.inttoptr(arguments[0], _WORD.as_pointer()), "seq_cst", 8)

    return _I64(_I64), generate


@emitted
def write_word(typing: Any, address: Any, value: Any) -> Any:
    """Write a word for the other process, which then sees what was written before it."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store_atomic(arguments[1], builder.inttoptr(arguments[0], _WORD.as_pointer()), "seq_cst", 8)
        return context.get_dummy_value()

    return types.void(_I64, _I64), generate


@emitted
def pause(typing: Any) -> Any:
    """Tell the processor that this is a loop that waits."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        name = _PAUSES.get(platform.machine())
        if name is not None:
            kind = ir.FunctionType(ir.VoidType(), [])
            builder.call(cgutils.get_or_insert_function(builder.module, kind, name), [])
        return context.get_dummy_value()

    return types.void(), generate


@emitted
def let_others_run(typing: Any, function: Any) -> Any:
    """Call ``int sched_yield(void)`` by address."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_INT, [])
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [])

    return _I32(_I64), generate


@emitted
def pass_byte(typing: Any, function: Any, descriptor: Any, byte: Any) -> Any:
    """Call ``ssize_t read(int, void *, size_t)`` or ``write`` by address, for one byte."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_WORD, [_INT, _BYTES, _WORD])
        callee = builder.inttoptr(arguments[0], kind.as_pointer())
        place = builder.inttoptr(arguments[2], _BYTES)
        return builder.call(callee, [builder.trunc(arguments[1], _INT), place, ir.Constant(_WORD, 1)])

    return _I64(_I64, _I64, _I64), generate


@emitted
def poll(typing: Any, function: Any, descriptors: Any) -> Any:
    """Call ``int poll(struct pollfd *, nfds_t, int)`` by address, for the two descriptors of a record."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_INT, [_BYTES, _WORD, _INT])
        callee = builder.inttoptr(arguments[0], kind.as_pointer())
        place = builder.inttoptr(arguments[1], _BYTES)
        return builder.call(callee, [place, ir.Constant(_WORD, 2), ir.Constant(_INT, LONGEST_SLEEP)])

    return _I32(_I64, _I64), generate


@emitted
def call_step(typing: Any, function: Any, component: Any, t: Any, h: Any, final: Any) -> Any:
    """Call fmi2DoStep by address, with the last argument as it is given."""
    kind = ir.FunctionType(_INT, [_BYTES, _REAL, _REAL, _INT])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        callee = builder.inttoptr(arguments[0], kind.as_pointer())
        pointer = builder.inttoptr(arguments[1], _BYTES)
        return call_for_status(builder, callee, [pointer, *arguments[2:4], builder.trunc(arguments[4], _INT)])

    return _I32(_I64, _I64, _F64, _F64, _I64), generate


@emitted
def call_direction(typing: Any, function: Any, component: Any, y: Any, n: Any, u: Any, m: Any, du: Any, dy: Any) -> Any:
    """Call fmi2GetDirectionalDerivative by address; all arguments but the numbers are addresses."""
    kind = ir.FunctionType(_INT, [_BYTES, _BYTES, _WORD, _BYTES, _WORD, _BYTES, _BYTES])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        callee = builder.inttoptr(arguments[0], kind.as_pointer())
        given = [
            builder.inttoptr(a, t) if isinstance(t, ir.PointerType) else a
            for a, t in zip(arguments[1:], kind.args, strict=True)
        ]
        return call_for_status(builder, callee, given)

    return _I32(*[_I64] * 8), generate
