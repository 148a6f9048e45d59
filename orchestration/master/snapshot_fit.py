"""Refuses a snapshot whose arrays do not fit a run, before compiled code uses numbers in them as indices."""

from collections.abc import Mapping

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.master.kernel.codes import N_PAST
from orchestration.master.texts import BYTES, LENGTHS, NUMBERS, Texts

DISCRETES, TIMES, ROWS, CHANGES = "discretes", "times", "rows", "changes"


def require_fit(
    arrays: Mapping[str, np.ndarray], present: Mapping[str, np.ndarray], limits: Mapping[str, int], texts: Texts
) -> None:
    """Refuse arrays of a snapshot that are not those of a run.

    Parameters
    ----------
    arrays
        Arrays of the snapshot.
    present
        Arrays of the run that are to get their values, of the same names.
    limits
        Number of intervals, of columns and of components of the run.
    texts
        The texts of the run, which tell where numbers of texts stand.

    Raises
    ------
    OrchestrationError
        If an array is missing, has another shape or type, or holds an impossible index.
    """
    fault = _of_forms(arrays, present, limits["columns"]) or _of_indices(arrays, limits)
    if texts and not fault:
        fault = _of_texts(arrays) or _of_text_numbers(arrays, texts)
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


def _of_texts(arrays: Mapping[str, np.ndarray]) -> str | None:
    """The first fault of the texts, their numbers and lengths; None if there is none."""
    for name, kind in ((NUMBERS, np.int64), (LENGTHS, np.int64), (BYTES, np.uint8)):
        if name not in arrays:
            return f"it has no array {name}"
        if arrays[name].ndim != 1 or arrays[name].dtype != kind:
            return f"array {name} has shape {arrays[name].shape} and type {arrays[name].dtype}"
    numbers, lengths = arrays[NUMBERS].tolist(), arrays[LENGTHS].tolist()
    if len(numbers) != len(lengths) or min(lengths, default=0) < 0 or sum(lengths) != arrays[BYTES].size:
        return f"it has {len(numbers)} texts, {len(lengths)} lengths of texts and {arrays[BYTES].size} bytes of texts"
    if len(set(numbers)) != len(numbers):
        return "two of its texts have the same number"
    if min(numbers, default=0) < 0 or max(numbers, default=0) > np.iinfo(np.int32).max:
        return f"its texts have the numbers {min(numbers)} to {max(numbers)}"
    if 0 not in numbers or lengths[numbers.index(0)]:
        return "its text of the number 0 is not the empty one"
    return None


def _of_text_numbers(arrays: Mapping[str, np.ndarray], texts: Texts) -> str | None:
    """The first number, of a value or in a row, that no text has; None if there is none."""
    for name, used in ((DISCRETES, arrays[DISCRETES][texts.places]), (ROWS, arrays[ROWS][:, texts.first :])):
        unknown = np.setdiff1d(used, arrays[NUMBERS])
        if unknown.size:
            return f"array {name} has the number {unknown[0]:g} for a text, and no text has that number"
    return None
