"""Tests of calls by address: compiled and as plain Python, a status that FMI does not define is a failure."""

import ctypes as ct
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest
from numba import njit

from orchestration.fmi import native_calls
from orchestration.fmi.codes import UNDEFINED, Status, accepted, status_name

_WORD, _REAL = ct.c_int64, ct.c_double
CALLS = {
    "call_transfer": [_WORD] * 4,
    "call_do_step": [_WORD, _REAL, _REAL, ct.c_int32],
    "call_state": [_WORD] * 2,
    "call_rates": [_WORD] * 5,
    "call_direction": [_WORD] * 7,
}
GIVEN = {"call_do_step": (0, 0.0, 0.1), "call_state": (0, 0), "call_rates": (0,) * 5, "call_transfer": (0,) * 4}


def returning(call: str, status: int) -> Any:
    """A C function of the right signature that returns a status."""
    return ct.CFUNCTYPE(ct.c_int32, *CALLS[call])(lambda *_: status)


@pytest.mark.parametrize("call", CALLS)
def test_a_status_that_is_not_defined_is_a_failure(call: str) -> None:
    function = getattr(native_calls, call)
    given = GIVEN.get(call, (0,) * 6)
    compiled = _compiled(function, len(given))
    for returned in (-1, -2, np.iinfo(np.int32).min, *Status, 6, 100, UNDEFINED):
        c_function = returning(call, int(returned))
        address = ct.cast(c_function, ct.c_void_p).value
        found = {int(function(address, *given)), int(compiled(address, *given))}
        assert found == {returned if returned in tuple(Status) else UNDEFINED}
    assert not accepted(UNDEFINED)
    assert status_name(UNDEFINED) == "a status that FMI does not define"


def _compiled(function: Callable[..., int], n: int) -> Callable[..., int]:
    """Compile a call of a function, whose number of arguments after the first is given."""
    names = ", ".join(f"a{k}" for k in range(n + 1))
    made: dict[str, Any] = {"function": function}
    exec(f"def call({names}):\n    return function({names})", made)
    return cast("Any", njit)(made["call"])
