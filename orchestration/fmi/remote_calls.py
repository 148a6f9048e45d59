"""Compiled functions that hand the calls of an FMI function over to the process of an isolated FMU, and serve them.

The address of a stand-in is called in place of an FMI function, with the address of a record (`Caller`) in place of
the instance. A stand-in copies the arguments into the shared memory, tells the number of the call, and waits for the
answer: first in a loop, then by letting other threads run, then in Python, which sleeps and sees whether the process
lives. `server` is the other side, as text for LLVM, so that the process of the FMU need not load numba.
"""

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, cast

from numba import njit, types
from numba.core.ccallback import CFunc

from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed
from orchestration.fmi.codes import Status
from orchestration.fmi.kept_code import keep_machine_code
from orchestration.fmi.machine_code import code_folder
from orchestration.fmi.native_calls import (
    SOURCES,
    copy_bytes,
    emit_rates,
    emit_state,
    emit_transfer,
    load_integer,
    load_real,
    store_integer,
    store_real,
)
from orchestration.fmi.remote_layout import COMMON, GONE, IDLE, NO_RESULT, NUMBERS, SLOW, WORD, Caller, Server, Word
from orchestration.fmi.remote_words import (
    call_direction,
    call_step,
    let_others_run,
    pass_byte,
    pause,
    poll,
    read_word,
    write_word,
)

_FATAL, _ERROR, _WARNING = int(Status.FATAL), int(Status.ERROR), int(Status.WARNING)
_SERVER_FILE = "server.ll"
_I64, _F64, _I32 = types.int64, types.float64, types.int32
_OPTIONS = {"error_model": "numpy", "_nrt": False}
_DO_STEP, _SET_STATE = NUMBERS["fmi2DoStep"], NUMBERS["fmi2SetFMUstate"]
_GET_STATE, _RATES = NUMBERS["fmi2GetFMUstate"], NUMBERS["fmi2SetRealInputDerivatives"]
_DIRECTION = NUMBERS["fmi2GetDirectionalDerivative"]
# Distances from the beginning of a record or of the shared memory.
_CALL, _STATUS, _N, _M = (8 * word for word in (Word.CALL, Word.STATUS, Word.N, Word.M))
_TIME, _STEP, _FINAL, _ARRAYS = (8 * word for word in (Word.TIME, Word.STEP, Word.FINAL, Word.ARRAYS))
_SERVER_SLEEPS, _MASTER_SLEEPS, _SAID = (8 * w for w in (Word.SERVER_SLEEPS, Word.MASTER_SLEEPS, Word.SAID))
_SHARED, _ENDED, _CAPACITY, _ATTEND = (
    8 * word for word in (Caller.SHARED, Caller.ENDED, Caller.CAPACITY, Caller.ATTEND)
)
_CALLER_READ, _POLL, _POLLED = (8 * word for word in (Caller.READ, Caller.POLL, Caller.POLLED))
_RESULT = 8 * Caller.RESULT
_COMPONENT, _READ, _FUNCTIONS = (8 * word for word in (Server.COMPONENT, Server.READ, Server.FUNCTIONS))
# Both records have these in the same places.
_SPINS, _YIELDS, _YIELD, _WRITE, _BELL, _BYTE = (8 * word for word in COMMON)


def _part(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function as a part of those that call it."""
    return cast("Any", njit)(no_cpython_wrapper=True, no_cfunc_wrapper=True, **_OPTIONS)(function)


@_part
def _exchange(caller, call):
    """Hand a call over, and wait for its status."""
    if load_integer(caller + _ENDED) != 0:
        return types.int32(_FATAL)
    shared = load_integer(caller + _SHARED)
    write_word(shared + _CALL, call)
    if read_word(shared + _SERVER_SLEEPS) != 0:
        pass_byte(load_integer(caller + _WRITE), load_integer(caller + _BELL), load_integer(caller + _BYTE))
    _wait(caller, shared, IDLE)
    if read_word(shared + _CALL) != IDLE:
        _sleep(caller, shared)
    if read_word(shared + _CALL) != IDLE or read_word(shared + _SAID) != 0:
        store_integer(caller + _RESULT, NO_RESULT)
        while load_integer(caller + _RESULT) == NO_RESULT and load_integer(caller + _ENDED) == 0:
            emit_state(load_integer(caller + _ATTEND), caller, 0)
        return types.int32(_FATAL if load_integer(caller + _ENDED) != 0 else load_integer(caller + _RESULT))
    return types.int32(load_integer(shared + _STATUS))


@_part
def _sleep(caller, shared):
    """Sleep until the process has answered, has something to say or has ended, but not for long."""
    polled = load_integer(caller + _POLLED)
    woken = True
    write_word(shared + _MASTER_SLEEPS, 1)
    while woken and read_word(shared + _CALL) != IDLE:
        woken = poll(load_integer(caller + _POLL), polled) > 0 and load_integer(polled + 8) >> 48 == 0
        pass_byte(load_integer(caller + _CALLER_READ), load_integer(caller + _BELL), load_integer(caller + _BYTE))
    write_word(shared + _MASTER_SLEEPS, 0)


@_part
def _wait(record, shared, ready):
    """Wait a while until the call is `IDLE` if `ready` is `IDLE`, else until there is a call."""
    for _ in range(load_integer(record + _SPINS)):
        if (read_word(shared + _CALL) == IDLE) == (ready == IDLE):
            return
        pause()
    for _ in range(load_integer(record + _YIELDS)):
        if (read_word(shared + _CALL) == IDLE) == (ready == IDLE):
            return
        let_others_run(load_integer(record + _YIELD))


@_part
def _await_call(server, shared):
    """Wait for the next call, at last asleep; returns it, or `GONE` if the other process has ended."""
    while True:
        _wait(server, shared, SLOW)
        call = read_word(shared + _CALL)
        if call != IDLE:
            return call
        write_word(shared + _SERVER_SLEEPS, 1)
        woken = 1
        if read_word(shared + _CALL) == IDLE:
            woken = pass_byte(load_integer(server + _READ), load_integer(server + _BELL), load_integer(server + _BYTE))
        write_word(shared + _SERVER_SLEEPS, 0)
        if woken == 0:
            return GONE


@_part
def _after(address, n, size):
    """Address behind n elements, rounded up to eight bytes."""
    return (address + size * n + 7) & -8


@_part
def _make(server, shared, call):
    """Make a call with the arguments in the shared memory; returns its status."""
    function = load_integer(server + _FUNCTIONS + WORD * (call - 1))
    component = load_integer(server + _COMPONENT)
    first, n = shared + _ARRAYS, load_integer(shared + _N)
    if function == 0 or component == 0:
        return types.int32(_ERROR)
    if call == _DO_STEP:
        t, h = load_real(shared + _TIME), load_real(shared + _STEP)
        return call_step(function, component, t, h, load_integer(shared + _FINAL))
    if call == _GET_STATE:
        return emit_state(function, component, first)
    if call == _SET_STATE:
        return emit_state(function, component, load_integer(first))
    second = _after(first, n, 4)
    if call == _RATES:
        return emit_rates(function, component, first, n, second, _after(second, n, 4))
    if call == _DIRECTION:
        m = load_integer(shared + _M)
        seed = _after(second, m, 4)
        return call_direction(function, component, first, n, second, m, seed, _after(seed, m, 8))
    return emit_transfer(function, component, first, n, second)


def _serve(server):
    """Make the calls that are handed over, until one needs Python or the other process has ended; returns that."""
    shared = load_integer(server + _SHARED)
    while True:
        call = _await_call(server, shared)
        if call < IDLE or call >= SLOW:
            return types.int32(call)
        store_integer(shared + _STATUS, types.int64(_make(server, shared, call)))
        write_word(shared + _CALL, IDLE)
        if read_word(shared + _MASTER_SLEEPS) != 0:
            pass_byte(load_integer(server + _WRITE), load_integer(server + _BELL), load_integer(server + _BYTE))


def _do_step(caller, t, h, final):
    shared = load_integer(caller + _SHARED)
    store_real(shared + _TIME, t)
    store_real(shared + _STEP, h)
    store_integer(shared + _FINAL, types.int64(final))
    return _exchange(caller, _DO_STEP)


def _transfer(call: int, size: int, *, sets: bool) -> Callable[..., Any]:
    """A function that sets or gets variables whose values take so many bytes."""

    def transfer(caller, references, n, values):
        shared = load_integer(caller + _SHARED)
        first = shared + _ARRAYS
        second = _after(first, n, 4)
        if second + size * n - first > load_integer(caller + _CAPACITY):
            return types.int32(_ERROR)
        store_integer(shared + _N, n)
        copy_bytes(references, first, 4 * n)
        if sets:
            copy_bytes(values, second, size * n)
        status = _exchange(caller, call)
        if not sets and status <= _WARNING:
            copy_bytes(second, values, size * n)
        return status

    return transfer


def _get_state(caller, state):
    first = load_integer(caller + _SHARED) + _ARRAYS
    store_integer(first, load_integer(state))
    status = _exchange(caller, _GET_STATE)
    if status <= _WARNING:
        store_integer(state, load_integer(first))
    return status


def _set_state(caller, state):
    store_integer(load_integer(caller + _SHARED) + _ARRAYS, state)
    return _exchange(caller, _SET_STATE)


def _set_rates(caller, references, n, orders, values):
    shared = load_integer(caller + _SHARED)
    first = shared + _ARRAYS
    second = _after(first, n, 4)
    third = _after(second, n, 4)
    if third + 8 * n - first > load_integer(caller + _CAPACITY):
        return types.int32(_ERROR)
    store_integer(shared + _N, n)
    copy_bytes(references, first, 4 * n)
    copy_bytes(orders, second, 4 * n)
    copy_bytes(values, third, 8 * n)
    return _exchange(caller, _RATES)


def _direction(caller, unknowns, n, known, m, seed, values):
    shared = load_integer(caller + _SHARED)
    first = shared + _ARRAYS
    second = _after(first, n, 4)
    third = _after(second, m, 4)
    fourth = _after(third, m, 8)
    if fourth + 8 * n - first > load_integer(caller + _CAPACITY):
        return types.int32(_ERROR)
    store_integer(shared + _N, n)
    store_integer(shared + _M, m)
    copy_bytes(unknowns, first, 4 * n)
    copy_bytes(known, second, 4 * m)
    copy_bytes(seed, third, 8 * m)
    status = _exchange(caller, _DIRECTION)
    if status <= _WARNING:
        copy_bytes(fourth, values, 8 * n)
    return status


_SPECIAL = {
    "fmi2DoStep": (_I32(_I64, _F64, _F64, _I32), _do_step),
    "fmi2GetFMUstate": (_I32(_I64, _I64), _get_state),
    "fmi2SetFMUstate": (_I32(_I64, _I64), _set_state),
    "fmi2SetRealInputDerivatives": (_I32(*[_I64] * 5), _set_rates),
    "fmi2GetDirectionalDerivative": (_I32(*[_I64] * 7), _direction),
}


@cache
def stand_in(function: str) -> int:
    """Return the address of the stand-in for one of `CALLS`; it is compiled when it is first needed."""
    if function in _SPECIAL:
        signature, body = _SPECIAL[function]
    else:
        size, sets = 8 if function.endswith("Real") else 4, function.startswith("fmi2Set")
        signature, body = _I32(*[_I64] * 4), _transfer(NUMBERS[function], size, sets=sets)
    made = keep_machine_code(_compiled_as(body, signature), body, _folder())
    made.compile()
    _kept[function] = made
    return cast("int", made.address)


def server() -> tuple[str, str]:
    """Return the name of the function that serves calls, and the text for LLVM that defines it.

    The function takes the address of a record, `Server`, and returns the call that it cannot make.
    """
    folder = _folder()
    file = None if folder is None else folder / _SERVER_FILE
    kept = None if file is None else read_sealed(file)
    if kept is not None:
        name, _, text = kept.decode("ascii").partition("\n")
        return name, text
    made = _compiled_as(_serve, _I32(_I64))
    made.compile()
    name, text = made.native_name, made.inspect_llvm()
    if file is not None:
        with suppress(OSError):  # a full disk: it is made again
            write_sealed(file, f"{name}\n{text}".encode("ascii"))
    return name, text


def _compiled_as(body: Callable[..., Any], signature: Any) -> CFunc:
    return CFunc(body, (signature.args, signature.return_type), locals={}, options=dict(_OPTIONS))


@cache
def _folder() -> Path | None:
    """Return the folder that keeps the machine code of this module; None if nothing is kept."""
    return code_folder(
        [Path(__file__), *(Path(__file__).with_name(f"remote_{part}.py") for part in ("layout", "words")), *SOURCES]
    )


_kept: dict[str, Any] = {}  # keeps the code that addresses point to
