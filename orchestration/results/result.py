"""The result of a run: recorded columns by name, as arrays over time."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.errors import UnknownNameError
from orchestration.fmi.given import shown
from orchestration.fmi.names import arrays, suggestion
from orchestration.results import csv_file, formats, parquet_file
from orchestration.results.columns import LATENESS, MESSAGES, TIME, Columns
from orchestration.results.prediction import PredictedColumns
from orchestration.results.texts import same_texts, text_column
from orchestration.results.ticks import tick_rows

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class Result(PredictedColumns, Mapping[str, np.ndarray]):
    """Recorded columns by name; a mapping from ``component.variable`` to an array over time.

    Row 0 shows the components after initialization. A column of a continuous component in row k is its state at
    ``time[k]``. A column of a sampled component in row k + 1 is the value that is held over [time[k], time[k + 1]).

    Besides the recorded names, ``"time"`` and the names of whole arrays can be looked up. The attributes are those
    of `Columns` and `PredictedColumns` in `orchestration.results`.

    Examples
    --------
    >>> from orchestration import scenario, simulate
    >>> result = simulate(scenario("fig2"), stop_time=0.1, record=["plant.x", "plant.gap"])
    >>> result
    <Result: 1001 rows, t = 0 to 0.1 s, 3 columns (plant.x[1], plant.x[2], plant.gap)>
    >>> result["plant.x"].shape, result["plant.x[2]"].shape, "plant.y" in result, list(result)
    ((1001, 2), (1001,), False, ['plant.x[1]', 'plant.x[2]', 'plant.gap'])
    >>> float(result["plant.gap"].max().round(3)), result.unit("plant.gap")
    (-2.863, 'm')

    A result of numbers that come from elsewhere:

    >>> import numpy as np
    >>> from orchestration import Result
    >>> measured = Result(np.array([0.0, 0.1]), ("arm.x[1]", "arm.x[2]"), np.array([[1.0, 2.0], [3.0, 4.0]]))
    >>> measured["arm.x[2]"].tolist()
    [2.0, 4.0]

    Names of columns, files with one format each, and what else a result knows:

    >>> result.columns_of("plant.x"), result.lateness, result.messages
    (('plant.x[1]', 'plant.x[2]'), None, ())
    >>> result.tick_times("plant.x").shape
    (1000,)
    >>> result.known_verdict is None, result.verdict.stable
    (True, True)
    >>> result.write_csv("tip.csv")
    >>> result.write_parquet("tip.parquet")
    """

    def __getitem__(self, name: str) -> np.ndarray:
        """A column, or the columns of an array side by side.

        Returns
        -------
        ndarray
            float64, shape (n_rows,); of an array of k variables (n_rows, k), of a matrix (n_rows, k, m). Of Strings an
            array of objects of type str.

        Raises
        ------
        UnknownNameError
            A KeyError that gives near names.
        """
        if isinstance(name, str) and name == TIME:
            return self.time
        if isinstance(name, str) and (texts := text_column(self.texts, name)) is not None:
            return texts
        places = self._places(name)
        return self.rows[:, places] if isinstance(places, int) else np.take(self.rows, places, axis=1)

    def __iter__(self) -> Iterator[str]:
        """The recorded names, in the order of the columns, those of texts last."""
        return iter((*self.names, *self.texts))

    def __len__(self) -> int:
        """Number of columns, without time."""
        return len(self.names) + len(self.texts)

    def __contains__(self, name: object) -> bool:
        """Whether the name can be looked up."""
        return name == TIME or (
            isinstance(name, str) and (name in self._columns or name in self._arrays or name in self.texts)
        )

    def __eq__(self, other: object) -> bool:
        """Whether all attributes agree, numbers bit by bit; so NaN equals itself."""
        if not isinstance(other, Result):
            return NotImplemented
        plain = all(_same(getattr(self, f.name), getattr(other, f.name)) for f in fields(Columns) if f.name != "texts")
        return plain and same_texts(self.texts, other.texts)

    __hash__ = None  # type: ignore[assignment] - arrays can change

    def __repr__(self) -> str:
        """Number of rows, time span and columns in one line."""
        span = f", t = {self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else ""
        names = ", ".join(list(self)[:4]) + (f", and {len(self) - 4} more" if len(self) > 4 else "")
        return f"<Result: {len(self.time)} rows{span}, {len(self)} columns ({names or 'none'}){self._state}>"

    def _repr_html_(self) -> str:
        from orchestration.results.display import result_html

        return result_html(self)

    def _ipython_key_completions_(self) -> list[str]:
        return [TIME, *arrays(tuple(self)), *self]

    def at_ticks(self, name: str) -> np.ndarray:
        """A column or an array, realigned to the instants at which its values came about.

        Returns
        -------
        ndarray
            Of a sampled component the value of tick j, which belongs to its time j * sample_time
            (`tick_times`); of any other component the value at the start of each step. Without realignment a
            sampled column lags a continuous column by one row.

        Examples
        --------
        The error of the tip, from columns that belong to one instant each:

        >>> from orchestration import scenario, simulate
        >>> result = simulate(scenario("fig2"), stop_time=0.5)
        >>> error = result.at_ticks("plant.x") - result.at_ticks("controller.x_t")  # m
        >>> bool(abs(error - result.at_ticks("controller.e")).max() < 1e-12)
        True
        """
        column, spacing = self[name], self.steps_per_tick.get(name.partition(".")[0])
        if spacing is not None:
            return column[1::spacing].copy()
        rows = tick_rows(self, name)
        return column[:-1] if rows is None else column[rows + 1]

    def tick_times(self, name: str) -> np.ndarray:
        """Times, s, of the values that `at_ticks` returns."""
        rows = tick_rows(self, name)
        return self.time[:-1] if rows is None else self.time[rows]

    @property
    def lateness(self) -> np.ndarray | None:
        """By how many seconds each row was made after it was due, shape (n_rows,); None if the run was not paced."""
        return self[LATENESS] if LATENESS in self.names else None

    @property
    def messages(self) -> tuple[str, ...]:
        """What the FMUs logged, each text after the name of its component; of many texts the last of each component."""
        return tuple(json.loads(self.metadata.get(MESSAGES, "[]")))

    def unit(self, name: str) -> str:
        """Unit of a column, or of an array whose elements share one; empty if there is none."""
        if name == TIME:
            return "s"
        if text_column(self.texts, name) is not None:
            return ""
        found = {self.units.get(self.names[i], "") for i in np.ravel(self._places(name))}
        return found.pop() if len(found) == 1 else ""

    def columns_of(self, name: str) -> tuple[str, ...]:
        """Names of the recorded columns that a name stands for: its own, or those of the elements of an array.

        Raises
        ------
        UnknownNameError
            A KeyError that gives near names.
        """
        if name == TIME or text_column(self.texts, name) is not None:
            return (name,)
        return tuple(self.names[place] for place in np.ravel(self._places(name)))

    def measure(self, formula: str) -> float:
        """Compute one number of the run.

        Parameters
        ----------
        formula
            Such as ``max(norm(plant.F_ext))``; `orchestration.results.measures.parser.parse_formula` says what can
            stand in it.

        Returns
        -------
        float
            NaN where no row fulfils the conditions of the formula.

        Raises
        ------
        FormulaError
            If the text is no formula, or an array stands where one number is needed.
        UnknownNameError
            If the result lacks a column.

        Examples
        --------
        >>> from orchestration import scenario, simulate
        >>> result = simulate(scenario("fig2"), record=["plant.F_ext", "controller.e"])
        >>> round(result.measure("max(norm(plant.F_ext))"))  # N
        633
        >>> round(result.measure("duration(norm(plant.F_ext) > 0)"), 2)  # s
        0.15
        >>> result.measure("rms(norm(controller.e), where=norm(plant.F_ext) > 0)") < 1e-3  # m
        True
        """
        from orchestration.results.measures.parser import parse_formula

        return parse_formula(formula).evaluate(self)

    def to_pandas(self) -> "pd.DataFrame":
        """All columns as a DataFrame over time.

        Returns
        -------
        DataFrame
            The index is ``time`` in s, a column bears its recorded name; ``attrs`` has ``units``, ``metadata``,
            ``status`` and ``message``.

        Examples
        --------
        >>> from orchestration import scenario, simulate
        >>> frame = simulate(scenario("fig2"), stop_time=0.1, record="plant.x").to_pandas()
        >>> frame.loc[0.1].round(2).to_dict(), frame.attrs["units"]["plant.x[1]"]
        ({'plant.x[1]': 1.43, 'plant.x[2]': 0.31}, 'm')
        """
        from orchestration.results.exchange import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> "xr.Dataset":
        """All columns as a Dataset over time.

        Returns
        -------
        Dataset
            Coordinate ``time`` in s. A variable ``component.name`` for each column, or for each array with one more
            dimension for each index. ``attrs`` of a variable has ``units``, ``attrs`` of the Dataset the metadata.

        Examples
        --------
        >>> from orchestration import scenario, simulate
        >>> data = simulate(scenario("fig2"), stop_time=1.2).to_xarray()
        >>> data["plant.x"].dims, data["plant.x"].attrs["units"]
        (('time', 'plant.x_1'), 'm')
        >>> data["plant.F_ext"].sel(time=1.0, method="nearest").values.round(1).tolist()  # N
        [-54.2, 0.0]
        """
        from orchestration.results.exchange import to_xarray

        return to_xarray(self)

    def plot(self, *names: str, ax: "Axes | None" = None) -> np.ndarray:
        """Draw columns over time, those of one unit in one panel.

        Parameters
        ----------
        names
            Columns, arrays, or patterns such as ``"plant.*"``; all columns if none is given.
        ax
            Axes of matplotlib to draw into, instead of a new figure; then all names must share a unit.

        Returns
        -------
        ndarray
            Axes of matplotlib, shape (n_panels,); notebooks and ``matplotlib.pyplot.show()`` display the figure.

        Raises
        ------
        UnknownNameError
            If a name chooses nothing.
        OrchestrationError
            If the columns for one panel have several units.

        Examples
        --------
        >>> from orchestration import scenario, simulate
        >>> result = simulate(scenario("fig2"), stop_time=1.2)
        >>> panels = result.plot("plant.x", "plant.F_ext")
        >>> [panel.get_ylabel() for panel in panels]
        ['plant.x (m)', 'plant.F_ext (N)']
        >>> panels[0].figure.savefig("tip.png")
        """
        from orchestration.results.plotting import plot

        return plot(self, names, ax)

    def write(self, path: str | Path) -> None:
        """Write all rows as CSV or Parquet, by the suffix of the path.

        Raises
        ------
        OrchestrationError
            If the suffix is neither ``.csv`` nor ``.parquet``, or the file cannot be written.

        Examples
        --------
        >>> from orchestration import Result, scenario, simulate
        >>> result = simulate(scenario("fig2"), stop_time=0.1, record="plant.x")
        >>> result.write("tip.csv")
        >>> with open("tip.csv") as file:
        ...     print(file.readline().strip())
        "time","plant.x[1]","plant.x[2]"
        >>> result.write("tip.parquet")
        >>> Result.read("tip.parquet") == result
        True
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
        """Read a CSV or Parquet file; a CSV file has names and values only.

        Raises
        ------
        OrchestrationError
            If the suffix is neither ``.csv`` nor ``.parquet``, or the file holds no result.

        Examples
        --------
        >>> from orchestration import Result, compare, scenario, simulate
        >>> system = scenario("fig2")
        >>> simulate(system, stop_time=0.1).write("yesterday.parquet")
        >>> compare(Result.read("yesterday.parquet"), simulate(system, stop_time=0.1)).identical
        True
        """
        columns = formats.read_columns(Path(path))
        return cls(**{field.name: getattr(columns, field.name) for field in fields(Columns)})

    @cached_property
    def _columns(self) -> Mapping[str, int]:
        return {name: place for place, name in reversed(list(enumerate(self.names)))}

    @cached_property
    def _arrays(self) -> Mapping[str, np.ndarray]:
        return arrays(self.names)

    def _places(self, name: str) -> Any:
        """Position of a column, or positions of the columns of an array, in its shape."""
        if not isinstance(name, str):
            example = next(iter(self), TIME)
            msg = f"The result has no column {shown(name)}; give its name, a text, such as {example!r}."
            raise UnknownNameError(msg)
        if name in self._columns:
            return self._columns[name]
        positions = self._arrays.get(name)
        if positions is None:
            msg = f"The result has no column {name}; {suggestion(name, tuple(self))}"
            raise UnknownNameError(msg)
        return positions


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.shape == b.shape and a.tobytes() == b.tobytes()
    return a == b
