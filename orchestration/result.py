"""What a run recorded."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from orchestration.errors import OrchestrationError


@dataclass(frozen=True)
class Result:
    """Rows at the communication points.

    Row 0 shows the components after initialization. A plant column in row k is the state at
    ``time[k]``; a sampled column in row k + 1 is the value held over [time[k], time[k + 1]).

    Attributes
    ----------
    time
        Communication points, s, shape (n_rows,).
    names
        Columns as ``component.variable``.
    rows
        Values, float64, shape (n_rows, n_columns); Booleans and Integers are numbers.
    units
        Unit of each column, empty where none is declared.
    steps_per_tick
        Number of steps per sampling period, by the name of a sampled component.
    """

    time: np.ndarray
    names: tuple[str, ...]
    rows: np.ndarray
    units: Mapping[str, str] = field(default_factory=dict)
    steps_per_tick: Mapping[str, int] = field(default_factory=dict)

    def __getitem__(self, name: str) -> np.ndarray:
        """A column, float64, shape (n_rows,).

        Raises
        ------
        OrchestrationError
            Listing the recorded columns.
        """
        if name == "time":
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
        column = self[name]
        ratio = self.steps_per_tick.get(name.partition(".")[0])
        return column[:-1] if ratio is None else column[1::ratio]

    def tick_times(self, name: str) -> np.ndarray:
        """Times, s, of the values that `at_ticks` returns."""
        ratio = self.steps_per_tick.get(name.partition(".")[0])
        return self.time[:-1] if ratio is None else self.time[:-1:ratio]

    def write_csv(self, path: Path) -> None:
        """Write all rows, 17 significant digits, one line per communication point.

        The first line has the names; the file is whole or not there.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        header = ",".join(["time", *(_quoted(name) for name in self.names)])
        line = ",".join(["%.17g"] * (len(self.names) + 1))
        draft = path.with_name(path.name + ".part")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with draft.open("w", encoding="utf-8", newline="\n") as file:
                file.write(header + "\n")
                for t, row in zip(self.time.tolist(), self.rows.tolist(), strict=True):
                    file.write(line % (t, *row) + "\n")
            draft.replace(path)
        except OSError as error:
            msg = f"{path}: the result cannot be written: {error.strerror}."
            raise OrchestrationError(msg) from error
        finally:
            with suppress(OSError):
                draft.unlink(missing_ok=True)

    def _index(self, name: str) -> int:
        try:
            return self.names.index(name)
        except ValueError:
            recorded = ", ".join(self.names) or "nothing"
            msg = f"The result has no column {name}; recorded are {recorded}."
            raise OrchestrationError(msg) from None


def _quoted(name: str) -> str:
    """A name as a field of a CSV file (RFC 4180)."""
    return '"' + name.replace('"', '""') + '"' if set(name) & set(',"\r\n') else name
