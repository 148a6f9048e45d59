"""What a run recorded."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.results import csv_file, formats, parquet_file
from orchestration.results.columns import TIME, Columns

TICK_TOLERANCE = 1e-9  # by which a row may miss a tick, in periods


@dataclass(frozen=True)
class Result(Columns):
    """Rows at the communication points.

    Row 0 shows the components after initialization. A plant column in row k is the state at
    ``time[k]``; a sampled column in row k + 1 is the value held over [time[k], time[k + 1]).

    The attributes are those of `orchestration.results.columns.Columns`.
    """

    def __getitem__(self, name: str) -> np.ndarray:
        """A column, float64, shape (n_rows,).

        Raises
        ------
        OrchestrationError
            Listing the recorded columns.
        """
        if name == TIME:
            return self.time
        return self.rows[:, self._index(name)]

    def vector(self, name: str) -> np.ndarray:
        """The columns ``name[1]``, ``name[2]``, ... side by side, shape (n_rows, n)."""
        count = sum(column.startswith(f"{name}[") for column in self.names)
        if count == 0:
            self._index(f"{name}[1]")
        return np.column_stack([self[f"{name}[{i + 1}]"] for i in range(count)])

    def at_ticks(self, name: str) -> np.ndarray:
        """A column realigned to the instants at which its values came about.

        Returns
        -------
        ndarray
            For a sampled component the value of tick j, which belongs to its time j * sample_time
            (`tick_times`); for any other the value at the start of each step. Without realignment a
            sampled column lags a plant column by one row.
        """
        column, rows = self[name], self._tick_rows(name)
        return column[:-1] if rows is None else column[rows + 1]

    def tick_times(self, name: str) -> np.ndarray:
        """Times, s, of the values that `at_ticks` returns."""
        rows = self._tick_rows(name)
        return self.time[:-1] if rows is None else self.time[rows]

    def _tick_rows(self, name: str) -> np.ndarray | None:
        """Rows at the instants of ticks, without the last; None for a component that is not sampled.

        Raises
        ------
        OrchestrationError
            If ticks were not recorded.
        """
        component = name.partition(".")[0]
        if component in self.steps_per_tick:
            return np.arange(0, len(self.time) - 1, self.steps_per_tick[component])
        period = self.sample_times.get(component)
        if period is None:
            return None
        position = (self.time[:-1] - self.time[0]) / period
        rows = np.flatnonzero(np.abs(position - np.round(position)) <= TICK_TOLERANCE * np.maximum(1, position))
        expected = (self.time[-1] - self.time[0]) / period
        if len(rows) < np.ceil(expected - TICK_TOLERANCE * max(1.0, expected)):
            msg = f"{name}: not every tick of {period:g} s is recorded; record every step."
            raise OrchestrationError(msg)
        return rows

    def write(self, path: str | Path) -> None:
        """Write all rows as CSV or Parquet, by the suffix of the path.

        Raises
        ------
        OrchestrationError
            If the suffix is neither ``.csv`` nor ``.parquet``, or the file cannot be written.
        """
        formats.write_columns(self, Path(path))

    def write_csv(self, path: str | Path) -> None:
        """Write names and values, each with all its bits, one line per communication point.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        csv_file.write_csv(self, Path(path))

    def write_parquet(self, path: str | Path) -> None:
        """Write everything, units and metadata included.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        parquet_file.write_parquet(self, Path(path))

    @classmethod
    def read(cls, path: str | Path) -> "Result":
        """Read a file that was written so; from CSV there are names and values only.

        Raises
        ------
        OrchestrationError
            If the suffix is neither ``.csv`` nor ``.parquet``, or the file holds no result.
        """
        columns = formats.read_columns(Path(path))
        return cls(**{field.name: getattr(columns, field.name) for field in fields(Columns)})

    def _index(self, name: str) -> int:
        try:
            return self.names.index(name)
        except ValueError:
            recorded = ", ".join(self.names) or "nothing"
            msg = f"The result has no column {name}; recorded are {recorded}."
            raise OrchestrationError(msg) from None
