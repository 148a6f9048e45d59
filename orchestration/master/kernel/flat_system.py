"""The flat form of a system, and the calls of its components.

Addresses and arrays in, (call, status) out. Nothing here allocates, raises or sees a Python object: these
functions are compiled into the loops (``loop``, ``stepping``). Without compilation (NUMBA_DISABLE_JIT=1) the
same source goes through ctypes, a slow oracle of itself. They take plain arrays: a tuple of arrays would
be reference-counted at every call (10 times slower, measured).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import call_transfer, copy_run

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
    recorded_reals
        (index, column, number) of each run of recorded Real outputs that are neighbours in the buffer
        and in a row, uint64, shape (n, 3).
    recorded_discretes
        (index, column) of each recorded discrete output, uint64, shape (n, 2).
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
def record(plan: Plan, rows: np.ndarray, row: int) -> None:
    """Copy what is recorded into a row (a view of it would be reference-counted)."""
    runs, index = plan.recorded_reals, plan.recorded_discretes
    for j in range(runs.shape[0]):
        copy_run(plan.reals, runs[j, 0], rows, row, runs[j, 1], runs[j, 2])
    for j in range(index.shape[0]):
        rows[row, index[j, 1]] = plan.discretes[index[j, 0]]
