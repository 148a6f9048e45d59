"""Gives inputs the values of time series: a compiled function that a loop calls as if it were an fmi2DoStep.

At the start of each step, the loops call the address of `give` with the address of a table of series in the place
of an instance. So a fixed step needs no further kind of operation, and a run without series runs the same code as
if this module did not exist. The function reads the arrays that the user gave, in place.

    held      input = the value of the last point whose time is reached
    linear    input = the straight line between that point and the next one, at t
              rate  = the slope of that line; if the step leads beyond the next point, the slope from the value at t
                      to the value at t + h

Each series has a cursor, which moves by less than a point per step in most runs. The cursor also moves back, after a
step that was refused or a snapshot that was restored.
"""

from enum import IntEnum
from functools import cache
from typing import Any, cast

import numpy as np
from numba import types
from numba.core.ccallback import CFunc

from orchestration.fmi.kept_code import keep_machine_code
from orchestration.fmi.native_calls import (
    call_do_step,
    load_integer,
    load_real,
    store_discrete,
    store_integer,
    store_real,
)
from orchestration.master.kernel.compiled import FOLDER


class Column(IntEnum):
    """Columns of the table of series; row 0 has the number of series in its first column, each other row a series."""

    TIMES = 0  # address of the first time, s
    LAST = 1  # position of the last point
    VALUES = 2  # address of the first value
    STRIDE = 3  # bytes from a value to the next
    CURSOR = 4  # position of the last point whose time is reached
    FORM = 5  # a `Form`
    PLACE = 6  # address of the input
    RATE = 7  # address of the input's derivative; 0 for an input that is held over a step


class Form(IntEnum):
    """How a series gives values between its points, and of which type."""

    HELD = 0
    LINEAR = 1
    HELD_DISCRETE = 2


N_COLUMNS = len(Column)
REACHED = 1e-9  # of a step by which a point may lie ahead and count as reached, because k h and the data are rounded

ROUNDING = 4 * float(np.finfo(float).eps)

_WORD = 8
_LINEAR, _HELD_DISCRETE = int(Form.LINEAR), int(Form.HELD_DISCRETE)
_TIMES, _LAST, _VALUES, _STRIDE, _CURSOR, _FORM, _PLACE, _RATE = (_WORD * int(column) for column in Column)
_ROW = _WORD * N_COLUMNS


def new_table(n: int) -> np.ndarray:
    """A table for n series, int64, shape (n + 1, N_COLUMNS), still without addresses."""
    table = np.zeros((n + 1, N_COLUMNS), np.int64)
    table[0, 0] = n
    return table


@cache
def address() -> int:
    """Address of the compiled function, which is compiled when it is first needed."""
    made = CFunc(_give, (_SIGNATURE.args, _SIGNATURE.return_type), locals={}, options={"error_model": "numpy"})
    keep_machine_code(made, _give, FOLDER).compile()
    _compiled.append(made)
    return cast("int", made.address)


def reached(t: float, h: float) -> float:
    """Return the time, s, up to which points count as reached in a step from t, s, of length h, s."""
    return t + REACHED * h + ROUNDING * abs(t)


def give(table: np.ndarray, t: float, h: float) -> None:
    """Give all inputs of a table their values for a step from t, s, of length h, s."""
    call_do_step(address(), table.ctypes.data, t, h)


_SIGNATURE = types.int32(types.int64, types.float64, types.float64, types.int32)
_compiled: list[Any] = []  # keeps the code that the address points to


def _give(table, t, h, final):  # noqa: ARG001 - the signature of fmi2DoStep
    until = t + REACHED * h + ROUNDING * abs(t)
    for k in range(load_integer(table)):
        row = table + (k + 1) * _ROW
        times, last = load_integer(row + _TIMES), load_integer(row + _LAST)
        values, stride = load_integer(row + _VALUES), load_integer(row + _STRIDE)
        i = load_integer(row + _CURSOR)
        while i < last and load_real(times + 8 * (i + 1)) <= until:
            i += 1
        while i > 0 and load_real(times + 8 * i) > until:
            i -= 1
        store_integer(row + _CURSOR, i)
        value, form, place = load_real(values + stride * i), load_integer(row + _FORM), load_integer(row + _PLACE)
        if form == _HELD_DISCRETE:
            store_discrete(place, types.int32(value))
            continue
        if form == _LINEAR:
            rate = load_integer(row + _RATE)
            j, slope, end = i, 0.0, value
            for part in range(2 if rate != 0 else 1):
                at = t + part * h
                while j < last and load_real(times + 8 * (j + 1)) < at:
                    j += 1
                begin = load_real(times + 8 * j)
                slope, end = 0.0, load_real(values + stride * j)
                if j < last and at > begin:
                    next_value, next_time = load_real(values + stride * (j + 1)), load_real(times + 8 * (j + 1))
                    slope = (next_value - end) / (next_time - begin)
                    end += slope * (at - begin)
                if part == 0:
                    value = end
            if rate != 0:
                whole = j == i and load_real(times + 8 * i) <= until
                store_real(rate, slope if whole else (end - value) / h)
        store_real(place, value)
    return types.int32(0)
