"""What plots of a page show: panels of curves, by unit for any run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from orchestration.fmi.names import base_name
from orchestration.results.result import Result

PANEL_HEIGHT = 17
"""Height of a panel, rem."""
MOST_CURVES = 7
"""Curves that colours can tell apart."""


@dataclass(frozen=True)
class Curve:
    """A column over time, or the norm of several.

    Attributes
    ----------
    columns
        Names of the columns.
    label
        What the legend says.
    hidden
        Whether the curve is switched off at first.
    """

    columns: Sequence[str]
    label: str
    hidden: bool = False

    @property
    def column(self) -> str:
        """Name of the column that is drawn: that of the norm if there are several."""
        return self.columns[0] if len(self.columns) == 1 else f"{base_name(self.columns[0])} (norm)"


@dataclass(frozen=True)
class Panel:
    """Curves of one unit.

    Attributes
    ----------
    title
        What the panel shows.
    unit
        Of the shown values.
    curves
        At most `MOST_CURVES`.
    factor
        Shown value over stored value, such as 1000 for mm of m.
    """

    title: str
    unit: str
    curves: Sequence[Curve]
    factor: float = 1.0

    def record(self) -> dict[str, Any]:
        """What the page is told of the panel."""
        curves = [{"column": one.column, "label": one.label, "hidden": one.hidden} for one in self.curves]
        return {"title": self.title, "unit": self.unit, "factor": self.factor, "curves": curves}


def panels_by_unit(results: Sequence[Result], most: int = MOST_CURVES) -> list[Panel]:
    """Panels of the first columns of results, each unit in one.

    Parameters
    ----------
    most
        Columns that are shown.
    """
    units = {name: result.unit(name) for result in reversed(results) for name in result.names}
    names = list(dict.fromkeys(name for result in results for name in result.names))[:most]
    return [
        Panel(
            "Values" if not unit else "Columns",
            unit,
            [Curve([name], name) for name in names if units[name] == unit],
        )
        for unit in dict.fromkeys(units[name] for name in names)
    ]


def norms_of(panels: Sequence[Panel]) -> dict[str, Sequence[str]]:
    """Names of the columns whose norm a curve shows, by the name of the norm."""
    curves = [curve for panel in panels for curve in panel.curves]
    return {curve.column: curve.columns for curve in curves if len(curve.columns) > 1}


def with_norms(result: Result, norms: Mapping[str, Sequence[str]]) -> Result:
    """The result with a column for each norm whose columns it has."""
    found = {
        name: np.linalg.norm([result[column] for column in columns], axis=0)
        for name, columns in norms.items()
        if name not in result and all(column in result.names for column in columns)
    }
    if not found:
        return result
    units = {**result.units, **{name: result.unit(norms[name][0]) for name in found}}
    return replace(
        result, names=(*result.names, *found), rows=np.column_stack([result.rows, *found.values()]), units=units
    )
