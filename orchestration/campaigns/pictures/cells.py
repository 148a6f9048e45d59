"""The runs of a grid put into the cells of two factors."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.pictures.style import FAILED, HATCH, set_scale
from orchestration.campaigns.view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Cells:
    """Numbers by the levels of two factors.

    Attributes
    ----------
    x, y
        Names of the factors.
    numbers
        One for each cell, shape (n_y, n_x).
    runs
        Number of runs in each cell, shape (n_y, n_x).
    """

    x: str
    y: str
    numbers: np.ndarray
    runs: np.ndarray


def cells(view: View, x: str, y: str, per_run: np.ndarray, of_cell: Callable[[np.ndarray], float]) -> Cells:
    """Put runs into cells.

    Parameters
    ----------
    per_run
        A number of each run, shape (n_runs,).
    of_cell
        Makes one number of those of a cell; a cell without a run has NaN.
    """
    columns = np.unique(view.column(x), return_inverse=True)[1]
    rows = np.unique(view.column(y), return_inverse=True)[1]
    shape = (len(view.levels(y)), len(view.levels(x)))
    cell = np.ravel_multi_index((rows, columns), shape)
    order = np.argsort(cell, kind="stable")
    found, begins, counts = np.unique(cell[order], return_index=True, return_counts=True)
    numbers, runs = np.full(shape, np.nan), np.zeros(shape, dtype=np.int64)
    runs.flat[found] = counts
    numbers.flat[found] = [of_cell(some) for some in np.split(per_run[order], begins[1:])]
    return Cells(x, y, numbers, runs)


def median(values: np.ndarray) -> float:
    """Median of the runs with a value; NaN if there is none."""
    if len(values) == 1:  # the usual case, in which a median would take most of the time
        return float(values[0])
    found = values[np.isfinite(values)]
    return float(np.median(found)) if found.size else float("nan")


def edges(levels: np.ndarray, *, logarithmic: bool) -> np.ndarray:
    """Borders of the cells around levels, on the scale of their axis, shape (n + 1,)."""
    at = np.log(levels) if logarithmic else levels
    middles = (at[1:] + at[:-1]) / 2
    ends = (2 * at[0] - middles[0], 2 * at[-1] - middles[-1]) if len(middles) else (at[0] - 0.5, at[0] + 0.5)
    found = np.concatenate(([ends[0]], middles, [ends[1]]))
    if logarithmic:
        return np.exp(found)
    if levels[0] >= 0 > found[0]:
        found[0] = 0.0  # a quantity that is not negative should not look so
    return found


def paint(axes: "Axes", view: View, found: Cells, **colours: Any) -> Any:
    """Draw cells in colours; return what a colour bar needs."""
    borders = [edges(view.levels(name), logarithmic=view.logarithmic(name)) for name in (found.x, found.y)]
    set_scale(axes, view, x=found.x, y=found.y)
    return axes.pcolormesh(*borders, np.ma.masked_invalid(found.numbers), shading="flat", **colours)


def hatch(axes: "Axes", view: View, found: Cells, chosen: np.ndarray) -> Any:
    """Hatch chosen cells, shape (n_y, n_x); return the entry of a legend, or None if there is no such cell."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    if not chosen.any():
        return None
    x, y = (edges(view.levels(name), logarithmic=view.logarithmic(name)) for name in (found.x, found.y))
    rows, columns = np.nonzero(chosen)
    left, right, low, high = x[columns], x[columns + 1], y[rows], y[rows + 1]
    corners = np.stack([[left, low], [right, low], [right, high], [left, high]]).transpose(2, 0, 1)
    style: dict[str, Any] = {"facecolor": "white", "edgecolor": FAILED, "hatch": HATCH, "linewidth": 0}
    axes.add_collection(PolyCollection(list(corners), **style))
    return Patch(**style)
