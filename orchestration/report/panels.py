"""What plots of a page show: panels of curves, by unit for any run."""

from collections.abc import Sequence
from dataclasses import dataclass

from orchestration.results.result import Result

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
