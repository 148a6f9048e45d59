"""The flat form of a system as plain arrays, and the functions that exchange values with its components.

The functions neither allocate memory nor raise errors nor see a Python object. From Python they call an FMU through
ctypes. Compiled loops compile them as parts of their own.
"""

from typing import NamedTuple

import numpy as np

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import call_transfer, copy_run
from orchestration.master.kernel.codes import GROUP_SIZE, Column, Group
from orchestration.master.kernel.compiled import compiled_with_caller


class Plan(NamedTuple):
    """A system as flat arrays.

    Attributes
    ----------
    table
        One row per component, int64, shape (n_components, `N_COLUMNS`), see
        `orchestration.master.kernel.codes.Column`.
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


@compiled_with_caller
def copy_links(links: np.ndarray, first: int, end: int, values: np.ndarray) -> None:
    """Copy values from sources of connections to their targets."""
    for j in range(np.uint64(first), np.uint64(end)):  # signed, each index would be tested for < 0
        values[links[j, 1]] = values[links[j, 0]]


@compiled_with_caller
def exchange(table: np.ndarray, i: int, first: Column) -> tuple[int, int]:
    """Set or get the Real, Integer and Boolean variables of component i by three calls; returns (call, status).

    The first call is `Column.SET_REAL` or `Column.GET_REAL`. A call without variables is not made.
    """
    call, status = first.value, 0
    for k in range(3):
        call = first + k * GROUP_SIZE
        if table[i, call + Group.COUNT] > 0:
            status = call_transfer(
                table[i, call + Group.FUNCTION],
                table[i, Column.INSTANCE],
                table[i, call + Group.REFERENCES],
                table[i, call + Group.COUNT],
                table[i, call + Group.VALUES],
            )
            if status > WORST_ACCEPTED:
                break
    return call, status


def set_inputs(table: np.ndarray, i: int) -> tuple[int, int]:
    """Hand component i its inputs; returns (call, status)."""
    return exchange(table, i, Column.SET_REAL)


def get_outputs(table: np.ndarray, i: int) -> tuple[int, int]:
    """Fetch the outputs of component i; returns (call, status)."""
    return exchange(table, i, Column.GET_REAL)


@compiled_with_caller
def record(plan: Plan, rows: np.ndarray, row: np.uint64) -> None:
    """Copy the recorded outputs into a row of the results; the row's index is unsigned."""
    runs, index = plan.recorded_reals, plan.recorded_discretes
    for j in range(runs.shape[0]):
        copy_run(plan.reals, runs[j, 0], rows, row, runs[j, 1], runs[j, 2])
    for j in range(index.shape[0]):
        rows[row, index[j, 1]] = plan.discretes[index[j, 0]]
