"""Tables of a study: a Dataset of xarray for a grid, a DataFrame for samples."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.columns import MESSAGE, STATUS, SYSTEM
from orchestration.campaigns.design.design import Design
from orchestration.campaigns.execution.campaign import Rows

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

COMPLETE, FAILED, MISSING = "complete", "failed", "missing"
"""Status of a run that succeeded, of one that failed, and of one that was not made because of an interrupt."""
RUN = "run"
"""Name of the index of a DataFrame: the number of the run."""


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns of a study's table.

    Attributes
    ----------
    factors
        Names of the factors' columns, in the order of the design, without that of the variants.
    variants
        Whether there is a column ``system``.
    units
        Units by column, of factors and measures.
    whole
        Factors whose values are whole numbers.
    descriptions
        What each factor sets, by column.
    measures
        Names of the measures.
    attributes
        What holds for all runs: texts and numbers.
    """

    factors: tuple[str, ...]
    variants: bool
    units: Mapping[str, str]
    whole: frozenset[str]
    descriptions: Mapping[str, str]
    measures: tuple[str, ...]
    attributes: Mapping[str, str | float]

    @property
    def all_factors(self) -> tuple[str, ...]:
        """Names of the columns of all factors, that of the variants first."""
        return ((SYSTEM,) if self.variants else ()) + self.factors

    def values(self, design: Design, numbers: np.ndarray) -> dict[str, np.ndarray]:
        """Values of all factors in some runs, by column: float64 or int64, texts of variants."""
        table = design.values(numbers)
        found: dict[str, np.ndarray] = {}
        if self.variants:
            found[SYSTEM] = np.array(design.variants, dtype=object)[design.variant_numbers(numbers)]
        for place, name in enumerate(self.factors):
            found[name] = self._typed(name, table[:, place])
        return found

    def _typed(self, name: str, values: np.ndarray) -> np.ndarray:
        return values.astype(np.int64) if name in self.whole else np.ascontiguousarray(values)

    def levels(self, design: Design) -> dict[str, np.ndarray]:
        """Levels of each factor of a grid, by column."""
        found: dict[str, np.ndarray] = {}
        if self.variants:
            found[SYSTEM] = np.array(design.variants, dtype=object)
        for name, block in zip(self.factors, design.blocks, strict=True):
            found[name] = self._typed(name, block.values[:, 0])
        return found


def points_frame(columns: Columns, design: Design) -> "pd.DataFrame":
    """The factors of all runs, one row for each run."""
    import pandas as pd

    frame = pd.DataFrame(columns.values(design, np.arange(len(design))))
    frame.index.name = RUN
    frame.attrs.update(_attributes(columns))
    return frame


def frame_of(columns: Columns, design: Design, rows: Rows) -> "pd.DataFrame":
    """All runs as a DataFrame: factors, measures, status, message."""
    frame = points_frame(columns, design)
    for place, name in enumerate(columns.measures):
        frame[name] = rows.measured[:, place]
    frame[STATUS], frame[MESSAGE] = _status(rows), _messages(rows)
    return frame


def dataset_of(columns: Columns, design: Design, rows: Rows) -> "xr.Dataset":
    """All runs of a grid as a Dataset whose dimensions are the factors."""
    import xarray as xr

    levels = columns.levels(design)
    dims = tuple(levels)
    shape = tuple(len(values) for values in levels.values())

    def variable(values: np.ndarray, **attributes: str) -> Any:
        return dims, values.reshape(shape), attributes

    data = {
        name: variable(np.ascontiguousarray(rows.measured[:, place]), units=columns.units[name])
        for place, name in enumerate(columns.measures)
    }
    data |= {STATUS: variable(_status(rows)), MESSAGE: variable(_messages(rows))}
    coordinates = {
        name: (name, values, {"units": columns.units.get(name, ""), "sets": columns.descriptions.get(name, "")})
        for name, values in levels.items()
    }
    return xr.Dataset(data, coordinates, dict(columns.attributes))


def table_of(columns: Columns, design: Design, rows: Rows) -> "xr.Dataset | pd.DataFrame":
    """All runs: of a grid as a Dataset, else as a DataFrame."""
    grid = columns.all_factors and not design.sampled
    return dataset_of(columns, design, rows) if grid else frame_of(columns, design, rows)


def _attributes(columns: Columns) -> dict[str, Any]:
    return {"units": dict(columns.units), "sets": dict(columns.descriptions), **columns.attributes}


def _status(rows: Rows) -> np.ndarray:
    status = np.where(rows.made, COMPLETE, MISSING).astype(object)
    status[list(rows.messages)] = FAILED
    return status


def _messages(rows: Rows) -> np.ndarray:
    messages = np.full(len(rows.made), "", dtype=object)
    for number, message in rows.messages.items():
        messages[number] = message
    return messages


def evaluated_row(measures: Sequence[str], rows: Rows) -> dict[str, Any]:
    """Measures, status and message of the only run."""
    numbers = dict(zip(measures, rows.measured[0].tolist(), strict=True))
    return numbers | {STATUS: str(_status(rows)[0]), MESSAGE: rows.messages.get(0, "")}


def evaluated_frame(measures: Sequence[str], table: "pd.DataFrame", rows: Rows) -> "pd.DataFrame":
    """A DataFrame with the measures, the status and the message of the run of each row."""
    found = {name: rows.measured[:, place] for place, name in enumerate(measures)}
    return table.assign(**found, **{STATUS: _status(rows), MESSAGE: _messages(rows)})
