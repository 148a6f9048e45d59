"""The hot loop: addresses and arrays in, (step, component, call, status) out.

    for k = first, ..., last - 1:                       t = times[k], h = steps[k] or steps[0]
        Gauss-Seidel: for each component: set inputs, doStep, get outputs
        Jacobi:       set all inputs; doStep all; get all outputs
        after every n-th step: a row = what the outputs show

Nothing here allocates, raises or sees a Python object. `run` is compiled; without compilation
(NUMBA_DISABLE_JIT=1) the same source goes through ctypes, a slow oracle of itself. The inner
functions take plain arrays: a tuple of arrays would be reference-counted at every call (10 times
slower, measured).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from orchestration.calls import call_do_step, call_transfer
from orchestration.fmu import WORST_ACCEPTED

GAUSS_SEIDEL, JACOBI = 0, 1

# Columns of the table: the instance, fmi2DoStep, the ranges of the links into the component, then
# one group of four for each kind of set and get call.
COMPONENT, DO_STEP, FIRST_REAL, END_REAL, FIRST_DISCRETE, END_DISCRETE = range(6)
SET_REAL, SET_INTEGER, SET_BOOLEAN, GET_REAL, GET_INTEGER, GET_BOOLEAN = range(6, 30, 4)
FUNCTION, REFERENCES, COUNT, VALUES = range(4)
N_COLUMNS = 30
CALL_NAMES = {
    DO_STEP: "fmi2DoStep",
    SET_REAL: "fmi2SetReal",
    SET_INTEGER: "fmi2SetInteger",
    SET_BOOLEAN: "fmi2SetBoolean",
    GET_REAL: "fmi2GetReal",
    GET_INTEGER: "fmi2GetInteger",
    GET_BOOLEAN: "fmi2GetBoolean",
}


class Plan(NamedTuple):
    """A system as flat arrays.

    Attributes
    ----------
    table
        One row per component, int64, shape (n_components, `N_COLUMNS`): addresses of the instance
        and of its functions; for each set and get call the function, the addresses of the value
        references (uint32) and of the first value, and the number of variables (0: no call);
        ranges of the component's inputs in the links.
    real_links, discrete_links
        (source, target) of each connection as indices into `reals` or `discretes`, uint64,
        shape (n_links, 2).
    reals, discretes
        Buffers of all outputs and inputs, float64 and int32.
    recorded_reals, recorded_discretes
        (index, column) of each recorded output, uint64, shape (n, 2).
    """

    table: np.ndarray
    real_links: np.ndarray
    discrete_links: np.ndarray
    reals: np.ndarray
    discretes: np.ndarray
    recorded_reals: np.ndarray
    recorded_discretes: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def exchange(table: np.ndarray, i: int, call: int) -> int:
    """One set or get call of component i, if it has such variables; returns its status."""
    count = table[i, call + COUNT]
    if count == 0:
        return 0
    return call_transfer(
        table[i, call + FUNCTION],
        table[i, COMPONENT],
        table[i, call + REFERENCES],
        count,
        table[i, call + VALUES],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def copy_links(links: np.ndarray, first: int, end: int, values: np.ndarray) -> None:
    """Copy sources to targets."""
    for j in range(np.uint64(first), np.uint64(end)):  # signed, each index would be tested for < 0
        values[links[j, 1]] = values[links[j, 0]]


@njit(cache=True, nogil=True, error_model="numpy")
def set_inputs(table: np.ndarray, i: int) -> tuple[int, int]:
    """Hand component i its inputs; returns (call, status)."""
    status = exchange(table, i, SET_REAL)
    if status > WORST_ACCEPTED:
        return SET_REAL, status
    status = exchange(table, i, SET_INTEGER)
    if status > WORST_ACCEPTED:
        return SET_INTEGER, status
    return SET_BOOLEAN, exchange(table, i, SET_BOOLEAN)


@njit(cache=True, nogil=True, error_model="numpy")
def get_outputs(table: np.ndarray, i: int) -> tuple[int, int]:
    """Fetch what component i shows; returns (call, status)."""
    status = exchange(table, i, GET_REAL)
    if status > WORST_ACCEPTED:
        return GET_REAL, status
    status = exchange(table, i, GET_INTEGER)
    if status > WORST_ACCEPTED:
        return GET_INTEGER, status
    return GET_BOOLEAN, exchange(table, i, GET_BOOLEAN)


@njit(cache=True, nogil=True, error_model="numpy")
def record(index: np.ndarray, values: np.ndarray, rows: np.ndarray, row: int) -> None:
    """Copy recorded values into their columns of a row (a view of it would be reference-counted)."""
    for j in range(index.shape[0]):
        rows[row, index[j, 1]] = values[index[j, 0]]


@njit(cache=True, nogil=True, error_model="numpy")
def run(
    plan: Plan,
    algorithm: int,
    grid: tuple[np.ndarray, np.ndarray],
    span: tuple[int, int],
    rows: np.ndarray,
    every: int,
) -> tuple[int, int, int, int]:
    """Make the steps span[0] to span[1] - 1.

    Parameters
    ----------
    grid
        Communication points, s, shape (n_steps + 1,), and step sizes, s, shape (n_steps,), or (1,)
        if all are equal.
    rows
        Receives the recorded outputs after each step k for which k + 1 is a multiple of `every`, one
        row after the other, shape (n_rows, n_columns).

    Returns
    -------
    tuple
        (step, component, call, status) of the call that failed; step is span[1] if none did.
    """
    table, real_links, discrete_links, reals, discretes, recorded_reals, recorded_discretes = plan
    times, steps = grid
    n = table.shape[0]
    sequential = algorithm == GAUSS_SEIDEL
    until_record, row = every - span[0] % every, np.uint64(0)
    for k in range(span[0], span[1]):
        t = times[k]
        h = steps[k] if steps.size > 1 else steps[0]
        for i in range(n):
            copy_links(real_links, table[i, FIRST_REAL], table[i, END_REAL], reals)
            copy_links(discrete_links, table[i, FIRST_DISCRETE], table[i, END_DISCRETE], discretes)
            call, status = set_inputs(table, i)
            if status > WORST_ACCEPTED:
                return k, i, call, status
            if sequential:
                status = call_do_step(table[i, DO_STEP], table[i, COMPONENT], t, h)
                if status > WORST_ACCEPTED:
                    return k, i, DO_STEP, status
                call, status = get_outputs(table, i)
                if status > WORST_ACCEPTED:
                    return k, i, call, status
        if not sequential:
            for i in range(n):
                status = call_do_step(table[i, DO_STEP], table[i, COMPONENT], t, h)
                if status > WORST_ACCEPTED:
                    return k, i, DO_STEP, status
            for i in range(n):
                call, status = get_outputs(table, i)
                if status > WORST_ACCEPTED:
                    return k, i, call, status
        until_record -= 1
        if until_record == 0:
            record(recorded_reals, reals, rows, row)
            record(recorded_discretes, discretes, rows, row)
            until_record, row = every, row + np.uint64(1)
    return span[1], 0, 0, 0
