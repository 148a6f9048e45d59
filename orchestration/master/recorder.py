"""A recorder collects the rows of a run, in memory or in a file."""

from typing import Protocol

import numpy as np

BLOCK_BYTES = 2**22  # size of a block of rows, if the rows of the run are not all preallocated


class Sink(Protocol):
    """Receiver of rows, such as `orchestration.results.parquet_file.ParquetSink`."""

    def append(self, time: np.ndarray, rows: np.ndarray) -> object:
        """Take rows, shape (n, n_columns), and the times of the rows, s, shape (n,)."""


class Recorder:
    """Collects the rows of a run.

    Parameters
    ----------
    n_columns
        Number of recorded outputs.
    expected
        Number of rows of the whole run. Memory for all rows is then preallocated, so that memory holds
        each row once. None if the number is not known.
    sink
        Receiver of the rows. None to keep the rows in memory.

    Attributes
    ----------
    count
        Number of rows collected, those that a sink has received included.
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
        """Return free places for times, shape (n,), and rows, shape (n, n_columns).

        There is at least one free place unless all expected rows have been collected. `filled` says how
        many places were used.
        """
        if self._filled == len(self._times) and not self._fixed:
            self._hand_on()
        return self._times[self._filled :], self._rows[self._filled :]

    def filled(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Accept the first n places that `room` returned as rows; return the times and rows accepted."""
        first, self._filled = self._filled, self._filled + n
        self.count += n
        return self._times[first : self._filled], self._rows[first : self._filled]

    def drop(self, n: int) -> None:
        """Take back the last n rows, which must belong to the last call of `filled`."""
        self._filled -= n
        self.count -= n

    def reset(self, times: np.ndarray, rows: np.ndarray) -> None:
        """Replace all rows by the given rows, shape (n, n_columns), at `times`, s, shape (n,).

        Rows that `rows` returned before stay as they are, because new memory is taken.
        """
        self._full, self.count = [], len(times)
        self._times, self._rows = np.empty_like(self._times), np.empty_like(self._rows)
        if self._fixed:
            self._filled = len(times)
            self._times[: len(times)], self._rows[: len(times)] = times, rows
        else:
            self._filled = 0
            self._full.append((times.copy(), rows.copy()))

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the times and rows in memory; rows that a sink has received are not in memory."""
        present = (self._times[: self._filled], self._rows[: self._filled])
        if not self._full:
            return present
        parts = [*self._full, present]
        return np.concatenate([t for t, _ in parts]), np.concatenate([r for _, r in parts])

    def parts(self) -> list[np.ndarray]:
        """Return the rows in memory, shape (n, n_columns) each, without a copy."""
        return [*(rows for _, rows in self._full), self._rows[: self._filled]]

    def flush(self) -> None:
        """Hand the rows in memory to the sink."""
        if self._sink is not None and self._filled:
            self._sink.append(self._times[: self._filled], self._rows[: self._filled])
            self._filled = 0

    @property
    def streams(self) -> bool:
        """Whether rows go to a sink, from which rows cannot be taken back."""
        return self._sink is not None

    def _hand_on(self) -> None:
        """Hand a full block to the sink, or keep it and begin another block."""
        if self._sink is not None:
            self.flush()
        else:
            self._full.append((self._times, self._rows))
            self._times, self._rows = np.empty_like(self._times), np.empty_like(self._rows)
            self._filled = 0


def not_finite(columns: tuple[str, ...], times: np.ndarray, rows: np.ndarray, *, first: int) -> tuple[int, str] | None:
    """Find the first row with a value that is NaN or infinite.

    Parameters
    ----------
    columns
        Names of the outputs.
    times, rows
        Times, s, shape (n,), and rows, shape (n, n_columns).
    first
        Number of the first of these rows in the run.

    Returns
    -------
    tuple of int and str, or None
        Index of the row and a sentence for the user; None if all values are finite.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(rows.sum()):  # NaN and infinity stay in a sum; a sum that overflows is looked at below
            return None
    finite = np.isfinite(rows)
    if finite.all():
        return None
    bad = np.argwhere(~finite)
    k, column = int(bad[0, 0]), bad[0, 1]
    why = "the run has diverged" if first + k > 0 else "start values are wrong or missing"
    where = f"at t = {times[k]:.9g} s (row {first + k})"
    return k, f"{columns[column]} is {rows[k, column]} {where}; {why}. With allow_nan, --allow-nan, a run goes on."


def any_value(columns: tuple[str, ...], times: np.ndarray, rows: np.ndarray, *, first: int) -> None:
    """Accept every row; the counterpart of `not_finite` for runs in which NaN is allowed."""
