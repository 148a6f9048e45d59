"""The result of a run: recorded columns over time, with access by name, reading and writing."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.results import csv_file, formats, parquet_file
from orchestration.results.columns import TIME, Columns

TICK_TOLERANCE = 1e-9  # largest distance of a row from a tick, in sampling periods


@dataclass(frozen=True)
class Result(Columns):
    """Recorded outputs of a run at its communication points.

    Row 0 holds the outputs after initialization. For a continuous component, row k holds the outputs at
    ``time[k]``. For a sampled component, row k + 1 holds the outputs during [time[k], time[k + 1]).

    All attributes come from `orchestration.results.columns.Columns`.
    """

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the values of a column, float64, shape (n_rows,), in the unit of the column.

        Raises
        ------
        OrchestrationError
            If there is no such column. The message lists the recorded columns.
        """
        if name == TIME:
            return self.time
        return self.rows[:, self._index(name)]

    def vector(self, name: str) -> np.ndarray:
        """Return the columns ``name[1]``, ``name[2]``, ... of an array variable, shape (n_rows, n).

        Raises
        ------
        OrchestrationError
            If there is no such array. The message lists the recorded columns.
        """
        count = sum(column.startswith(f"{name}[") for column in self.names)
        if count == 0:
            self._index(f"{name}[1]")
        return np.column_stack([self[f"{name}[{i + 1}]"] for i in range(count)])

    def at_ticks(self, name: str) -> np.ndarray:
        """Return the values of a column at the ticks of its component.

        A column of a sampled component is one row late in comparison with a column of a continuous component.
        This method removes the delay.

        Returns
        -------
        ndarray
            For a sampled component: the values of all ticks, at the times `tick_times`. For a continuous
            component: the values at the start of each step, shape (n_rows - 1,).

        Raises
        ------
        OrchestrationError
            If there is no such column, or not every tick was recorded.
        """
        column, rows = self[name], self._tick_rows(name)
        return column[:-1] if rows is None else column[rows + 1]

    def tick_times(self, name: str) -> np.ndarray:
        """Return the times of the values of `at_ticks`, s.

        Raises
        ------
        OrchestrationError
            If not every tick was recorded.
        """
        rows = self._tick_rows(name)
        return self.time[:-1] if rows is None else self.time[rows]

    def _tick_rows(self, name: str) -> np.ndarray | None:
        """Row numbers of all ticks before the last row; None for a component that is not sampled.

        Raises
        ------
        OrchestrationError
            If not every tick was recorded.
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
        """Write all rows to a CSV or Parquet file, as the suffix of the path says.

        Raises
        ------
        OrchestrationError
            If the suffix is neither ``.csv`` nor ``.parquet``, or the file cannot be written.
        """
        formats.write_columns(self, Path(path))

    def write_csv(self, path: str | Path) -> None:
        """Write a CSV file with names and values, without loss of any bit of a value.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        csv_file.write_csv(self, Path(path))

    def write_parquet(self, path: str | Path) -> None:
        """Write a Parquet file with values, units and metadata.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        parquet_file.write_parquet(self, Path(path))

    @classmethod
    def read(cls, path: str | Path) -> "Result":
        """Read a result from a CSV or Parquet file, as the suffix of the path says.

        A CSV file gives names and values only: no units, no metadata and no ticks.

        Raises
        ------
        OrchestrationError
            If the suffix is neither ``.csv`` nor ``.parquet``, or the file does not hold a result.
        """
        columns = formats.read_columns(Path(path))
        return cls(**{field.name: getattr(columns, field.name) for field in fields(Columns)})

    def _index(self, name: str) -> int:
        """Index of a column; an error lists the recorded columns."""
        try:
            return self.names.index(name)
        except ValueError:
            recorded = ", ".join(self.names) or "nothing"
            msg = f"The result has no column {name}; recorded are {recorded}."
            raise OrchestrationError(msg) from None
