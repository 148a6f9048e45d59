"""Refuses a snapshot whose arrays do not fit a run, before compiled code uses numbers in them as indices."""

from collections.abc import Mapping

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.master.kernel.codes import N_PAST

TIMES, ROWS, CHANGES = "times", "rows", "changes"


def require_fit(arrays: Mapping[str, np.ndarray], present: Mapping[str, np.ndarray], limits: Mapping[str, int]) -> None:
    """Refuse arrays of a snapshot that are not those of a run.

    Parameters
    ----------
    arrays
        Arrays of the snapshot.
    present
        Arrays of the run that are to get their values, of the same names.
    limits
        Number of intervals, of columns and of components of the run.

    Raises
    ------
    OrchestrationError
        If an array is missing, has another shape or type, or holds an impossible index.
    """
    fault = _of_forms(arrays, present, limits["columns"]) or _of_indices(arrays, limits)
    if fault:
        msg = f"The snapshot does not fit the run: {fault}; it is damaged, so give another one."
        raise OrchestrationError(msg)


def _of_forms(arrays: Mapping[str, np.ndarray], present: Mapping[str, np.ndarray], n_columns: int) -> str | None:
    """The first array that has a wrong form; None if there is none."""
    if missing := sorted({*present, TIMES, ROWS, CHANGES} - set(arrays)):
        return f"it has no array {missing[0]}"
    for name, array in present.items():
        if (arrays[name].shape, arrays[name].dtype) != (array.shape, array.dtype):
            return f"array {name} has shape {arrays[name].shape} and type {arrays[name].dtype}"
    times, rows = arrays[TIMES], arrays[ROWS]
    if times.dtype != float or rows.dtype != float or times.ndim != 1 or rows.shape != (times.size, n_columns):
        return f"it has {times.shape} times of type {times.dtype} and {rows.shape} rows of type {rows.dtype}"
    return None


def _of_indices(arrays: Mapping[str, np.ndarray], limits: Mapping[str, int]) -> str | None:
    """The first index that is impossible; None if there is none."""
    state, pivots = arrays["state"][0], arrays["pivots"]
    most = {"interval": limits["intervals"], "n_past": N_PAST, "kept_n_past": N_PAST, "moved": limits["components"] - 1}
    for name, largest in most.items():
        if not 0 <= int(state[name]) <= largest:
            return f"{name} is {int(state[name])}"
    if len(arrays[TIMES]) > limits["rows"]:
        return f"it has {len(arrays[TIMES])} rows"
    if pivots.size and not (pivots.min() >= 0 and pivots.max() < pivots.size):
        return "a pivot of its Jacobian is impossible"
    return None
