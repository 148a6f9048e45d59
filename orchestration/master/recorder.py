"""Rows as they come: kept in memory, or handed to a file."""

from typing import Protocol

import numpy as np

BLOCK_BYTES = 2**22  # of the rows that are handed on at a time, if they are not all preallocated


class Sink(Protocol):
    """Takes rows; `orchestration.results.parquet_file.ParquetSink` is one."""

    def append(self, time: np.ndarray, rows: np.ndarray) -> object:
        """Take times, s, shape (n,), and rows, shape (n, n_columns)."""


class Recorder:
    """Collects rows.

    Parameters
    ----------
    n_columns
        Width of a row.
    expected
        Number of rows, if it is known: all are preallocated, so that memory holds them once.
    sink
        Where rows go instead of being kept.
    """

    def __init__(self, n_columns: int, expected: int | None, sink: Sink | None) -> None:
        self._sink = sink
        self._fixed = expected is not None and sink is None
        block = max(16, BLOCK_BYTES // (8 * (n_columns + 1)))
        size = expected if expected is not None and sink is None else block
        self._times, self._rows = np.empty(size), np.empty((size, n_columns))
        self._filled = 0
        self._full: list[tuple[np.ndarray, np.ndarray]] = []
        self.count = 0

    def room(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and rows to be filled from the beginning; at least one unless all expected are there."""
        if self._filled == len(self._times) and not self._fixed:
            self._hand_on()
        return self._times[self._filled :], self._rows[self._filled :]

    def filled(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Accept n rows of what `room` gave; returns them."""
        first, self._filled = self._filled, self._filled + n
        self.count += n
        return self._times[first : self._filled], self._rows[first : self._filled]

    def drop(self, n: int) -> None:
        """Take back the last n rows, which must be of the last call of `filled`."""
        self._filled -= n
        self.count -= n

    def reset(self, times: np.ndarray, rows: np.ndarray) -> None:
        """Go back to having just these rows."""
        self._full, self.count = [], len(times)
        if self._fixed:
            self._filled = len(times)
            self._times[: len(times)], self._rows[: len(times)] = times, rows
        else:
            self._filled = 0
            self._full.append((times.copy(), rows.copy()))

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """All rows that are kept; those of a sink are not."""
        present = (self._times[: self._filled], self._rows[: self._filled])
        if not self._full:
            return present
        parts = [*self._full, present]
        return np.concatenate([t for t, _ in parts]), np.concatenate([r for _, r in parts])

    def flush(self) -> None:
        """Hand to the sink what it does not have yet."""
        if self._sink is not None and self._filled:
            self._sink.append(self._times[: self._filled], self._rows[: self._filled])
            self._filled = 0

    @property
    def streams(self) -> bool:
        """Whether rows leave, so that they cannot be taken back."""
        return self._sink is not None

    def _hand_on(self) -> None:
        if self._sink is not None:
            self.flush()
        else:
            self._full.append((self._times, self._rows))
            self._times, self._rows = np.empty_like(self._times), np.empty_like(self._rows)
            self._filled = 0


def not_finite(columns: tuple[str, ...], times: np.ndarray, rows: np.ndarray, *, first: int) -> tuple[int, str] | None:
    """The first row with a value that is NaN or infinite, and the sentence that says so."""
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(rows.sum()):  # NaN and infinity stay in a sum; one that overflows is looked at below
            return None
    finite = np.isfinite(rows)
    if finite.all():
        return None
    bad = np.argwhere(~finite)
    k, column = int(bad[0, 0]), bad[0, 1]
    why = "the run has diverged" if first + k > 0 else "start values are wrong or missing"
    where = f"at t = {times[k]:.9g} s (row {first + k})"
    return k, f"{columns[column]} is {rows[k, column]} {where}; {why}."
