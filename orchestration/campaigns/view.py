"""A table of a study as pictures and sensitivities look at it: one row for each run, factors told from measures."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.columns import MESSAGE, STATUS, SYSTEM
from orchestration.errors import StudyError, UnknownNameError
from orchestration.fmi.given import shown
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

SEED = "seed"
"""Last part of the names of factors whose values are seeds."""
_COMPLETE = "complete"
_LIKE_A_RATIO = 10.0  # from this ratio on, two levels are a step of a logarithmic scale
_EQUAL_RATIOS = 0.02


@dataclass(frozen=True, eq=False)
class View:
    """All runs of a table with one of their measures.

    Attributes
    ----------
    frame
        One row for each run: factors, measures, and ``status`` if the table has it.
    measure
        Name of the measure that is looked at.
    factors
        Factors with more than one value, without the variants.
    every_factor
        All factors, in the order of the table.
    units
        Units by column; empty where there is none.
    sets
        What each factor sets, by its name.
    grid
        Whether the table is one of all combinations of levels.
    """

    frame: "pd.DataFrame"
    measure: str
    factors: tuple[str, ...]
    every_factor: tuple[str, ...]
    units: Mapping[str, str]
    sets: Mapping[str, str]
    grid: bool

    @classmethod
    def of(cls, table: "xr.Dataset | pd.DataFrame", measure: str) -> "View":
        """Look at a table of `orchestration.Study`.

        Raises
        ------
        StudyError
            If it is not such a table, or nothing varies in it.
        UnknownNameError
            If it has no such measure.
        """
        parts = _parts(table)
        frame, factors = parts.frame, parts.factors
        if measure not in parts.measures:
            msg = f"The table has no measure {shown(measure)}; {suggestion(str(measure), parts.measures)}"
            raise UnknownNameError(msg)
        several = [name for name in factors if len(frame[name].unique()) > 1]
        varied = tuple(name for name in several if name != SYSTEM)
        if not several:
            msg = "Nothing varies in the table; give the study a factor with several values."
            raise StudyError(msg)
        return cls(frame, measure, varied, factors, parts.units, parts.sets, parts.grid)

    @property
    def values(self) -> np.ndarray:
        """The measure of each run, float64, shape (n_runs,); NaN of a run that failed."""
        return self.frame[self.measure].to_numpy(np.float64)

    @property
    def complete(self) -> np.ndarray:
        """Whether each run succeeded, shape (n_runs,)."""
        if STATUS in self.frame:
            return (self.frame[STATUS] == _COMPLETE).to_numpy()
        return np.isfinite(self.values)

    @property
    def seeds(self) -> tuple[str, ...]:
        """The factors that are seeds, whose values have no order."""
        return tuple(name for name in self.factors if name.rpartition(".")[2] == SEED)

    @property
    def ordered(self) -> tuple[str, ...]:
        """The factors that are no seeds."""
        return tuple(name for name in self.factors if name not in self.seeds)

    def column(self, name: str) -> np.ndarray:
        """Values of a factor in each run, float64, shape (n_runs,)."""
        return self.frame[name].to_numpy(np.float64)

    def levels(self, name: str) -> np.ndarray:
        """The different values of a factor, increasing."""
        return np.unique(self.column(name))

    def variants(self) -> "dict[str, View]":
        """The runs of each variant of the system by its name; of a table without variants all under an empty name."""
        if SYSTEM not in self.frame:
            return {"": self}
        names = dict.fromkeys(self.frame[SYSTEM])
        return {str(name): replace(self, frame=self.frame[self.frame[SYSTEM] == name]) for name in names}

    def label(self, name: str) -> str:
        """A column with its unit, for an axis."""
        unit = self.units.get(name, "")
        return f"{name} ({unit})" if unit else name

    def logarithmic(self, name: str) -> bool:
        """Whether the values of a factor are spread evenly on a logarithmic scale rather than on a linear one."""
        return spread_by_ratio(self.column(name))


def spread_by_ratio(values: np.ndarray) -> bool:
    """Whether values are spread evenly by ratio: few levels with equal ratios, or many whose logarithms are even."""
    levels = np.unique(values)
    if len(levels) < 2 or levels[0] <= 0:
        return False
    if len(levels) == 2:
        return bool(levels[1] / levels[0] >= _LIKE_A_RATIO)
    ratios, steps = levels[1:] / levels[:-1], np.diff(levels)
    if np.ptp(ratios) <= _EQUAL_RATIOS * ratios.min():
        return True
    if np.ptp(steps) <= _EQUAL_RATIOS * steps.min():
        return False
    return bool(levels[-1] / levels[0] >= _LIKE_A_RATIO and _unevenness(np.log(levels)) < _unevenness(levels))


def _unevenness(levels: np.ndarray) -> float:
    """How far increasing values are from evenly spaced ones, in parts of their span."""
    return float(np.abs((levels - levels[0]) / (levels[-1] - levels[0]) - np.linspace(0, 1, len(levels))).max())


def measures_in(table: "xr.Dataset | pd.DataFrame") -> tuple[str, ...]:
    """Return the names of the measures of a study's table, in its order.

    Raises
    ------
    StudyError
        If it is not such a table.
    """
    return _parts(table).measures


@dataclass(frozen=True, eq=False)
class _Parts:
    """A table taken apart: runs as a DataFrame, names of factors, units, what factors set, whether it is a grid."""

    frame: "pd.DataFrame"
    factors: tuple[str, ...]
    units: Mapping[str, str]
    sets: Mapping[str, str]
    grid: bool

    @property
    def measures(self) -> tuple[str, ...]:
        return tuple(str(name) for name in self.frame.columns if name not in (*self.factors, STATUS, MESSAGE))


def _parts(table: Any) -> _Parts:
    if hasattr(table, "data_vars") and table.dims:
        factors = tuple(str(name) for name in table.dims)
        units = {str(name): str(table[name].attrs.get("units", "")) for name in (*table.coords, *table.data_vars)}
        sets = {name: str(table[name].attrs.get("sets", "")) for name in factors}
        single = [name for name in table.coords if name not in factors]
        return _Parts(table.drop_vars(single).to_dataframe().reset_index(), factors, units, sets, grid=True)
    if hasattr(table, "columns") and "sets" in getattr(table, "attrs", {}):
        about = table.attrs
        factors = tuple(str(name) for name in table.columns if name in about["sets"] or name == SYSTEM)
        return _Parts(table, factors, about.get("units", {}), about["sets"], grid=False)
    msg = (
        f"{shown(table)} is no table of a study; give what Study.run returns. A DataFrame has to keep its attrs, which"
        " tell factors from measures."
    )
    raise StudyError(msg)
