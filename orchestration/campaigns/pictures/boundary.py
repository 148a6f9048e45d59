"""Boundaries: where in the plane of two factors the runs succeed, and where a measure stays within a limit."""

from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.pictures.cells import Cells, cells, edges, paint
from orchestration.campaigns.pictures.heat_map import two_factors
from orchestration.campaigns.pictures.style import BAD, COLOURS, GOOD, legend_outside, new_figure, set_scale
from orchestration.campaigns.view import View
from orchestration.errors import StudyError

_STABLE: dict[str, Any] = {"color": COLOURS[3], "lw": 2.4, "ls": (0, (2, 1))}

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_boundary(view: View, limit: float | None = None, stability: View | None = None) -> "Figure":
    """Draw where runs are good: they succeed, and if there is a limit, their measure is at most as large.

    Where several runs share a cell, the colour is the share of the good ones.

    Parameters
    ----------
    limit
        Largest good value of the measure.
    stability
        Predicted growth rates of a grid of the same factors, whose border is drawn, too.

    Raises
    ------
    StudyError
        If fewer than two factors vary, or `stability` does not have the same levels.
    """
    x, y = two_factors(view)
    if stability is not None:
        _require_same_levels(view, stability, (x, y))
    variants = view.variants()
    figure = new_figure(1.2 + 4.2 * len(variants), 4.0)
    panels = figure.subplots(1, len(variants), squeeze=False)[0]
    shared = view.grid and len(view.frame) > len(variants) * len(view.levels(x)) * len(view.levels(y))
    image: Any = None
    for panel, (variant, some) in zip(panels, variants.items(), strict=True):
        good = good_runs(some, limit)
        set_scale(panel, view, x=x, y=y)
        if view.grid:
            image = _draw_cells(panel, some, cells(some, x, y, good.astype(float), np.mean), shared=shared)
            if stability is not None:
                _draw_stability(panel, stability.variants()[variant], x, y)
        else:
            _draw_dots(panel, some, (x, y), good)
        panel.set_title(variant)
    words = meaning(view, limit)
    if shared:
        figure.colorbar(image, ax=list(panels), label=f"share of the runs that are good ({words})")
    entries = _legend(words, dots=not view.grid, shared=shared)
    legend_outside(figure, list(panels), entries if stability is None else [*entries, _stable_entry()])
    return figure


def _require_same_levels(view: View, stability: View, names: tuple[str, str]) -> None:
    """Refuse growth rates of another grid.

    Raises
    ------
    StudyError
    """
    same = view.grid and stability.grid and list(view.variants()) == list(stability.variants())
    same = same and all(name in stability.factors for name in names)
    if not same or any(not np.array_equal(view.levels(name), stability.levels(name)) for name in names):
        msg = (
            f"The growth rates are not those of a grid with the same levels of {names[0]} and {names[1]}; make them by"
            " the stability of the same study, without seeds."
        )
        raise StudyError(msg)


def good_runs(view: View, limit: float | None) -> np.ndarray:
    """Whether each run succeeds and keeps within the limit, shape (n_runs,)."""
    return view.complete if limit is None else view.complete & (view.values <= limit)


def meaning(view: View, limit: float | None) -> str:
    """What good means, in words."""
    if limit is None:
        return "the run succeeds"
    unit = view.units.get(view.measure, "")
    return f"{view.measure} ≤ {limit:g}{f' {unit}' if unit else ''}"


def _colours() -> Any:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("share", [BAD, "#F2F2F2", GOOD])


def _draw_cells(axes: "Axes", view: View, found: Cells, *, shared: bool) -> Any:
    image = paint(axes, view, found, cmap=_colours(), vmin=0, vmax=1)
    _outline(axes, view, found, found.numbers >= 0.5, color="black", lw=1.6)
    if not shared:
        bad = np.nonzero(found.numbers < 0.5)
        axes.plot(view.levels(found.x)[bad[1]], view.levels(found.y)[bad[0]], "x", color="black", ms=4, lw=0)
    return image


def _outline(axes: "Axes", view: View, found: Cells, inside: np.ndarray, **style: Any) -> None:
    """Draw the border between cells that are inside, bool of shape (n_y, n_x), and those that are not."""
    x, y = (edges(view.levels(name), logarithmic=view.logarithmic(name)) for name in (found.x, found.y))
    for row, column in zip(*np.nonzero(inside[:, 1:] != inside[:, :-1]), strict=True):
        axes.plot([x[column + 1]] * 2, y[row : row + 2], solid_capstyle="projecting", **style)
    for row, column in zip(*np.nonzero(inside[1:] != inside[:-1]), strict=True):
        axes.plot(x[column : column + 2], [y[row + 1]] * 2, solid_capstyle="projecting", **style)


def _draw_stability(axes: "Axes", stability: View, x: str, y: str) -> None:
    """Draw where no deviation is predicted to grow, and mark where it does."""
    found = cells(stability, x, y, (stability.values <= 0).astype(float), np.mean)
    _outline(axes, stability, found, found.numbers >= 0.5, **_STABLE)
    rows, columns = np.nonzero(found.numbers < 0.5)
    marks = (stability.levels(x)[columns], stability.levels(y)[rows])
    axes.plot(*marks, "o", mfc="none", mec=_STABLE["color"], ms=9, mew=1.8, lw=0)


def _stable_entry() -> Any:
    from matplotlib.lines import Line2D

    label = "predicted border of stability (rings: unstable)"
    return Line2D([], [], marker="o", mfc="none", mec=_STABLE["color"], ms=8, mew=1.8, label=label, **_STABLE)


def _draw_dots(axes: "Axes", view: View, names: tuple[str, str], good: np.ndarray) -> None:
    x, y = (view.column(name) for name in names)
    axes.grid(visible=True, alpha=0.3)
    axes.plot(x[good], y[good], "o", color=GOOD, ms=3.5, mew=0)
    axes.plot(x[~good], y[~good], "x", color=BAD, ms=4.5)


def _legend(words: str, *, dots: bool, shared: bool) -> list[Any]:
    """Entries of the legend, which are the same for all panels."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if dots:
        plain: dict[str, Any] = {"ls": ""}
        return [
            Line2D([], [], marker="o", color=GOOD, ms=4, label=words, **plain),
            Line2D([], [], marker="x", color=BAD, ms=5, label="otherwise", **plain),
        ]
    line = Line2D([], [], color="black", lw=1.6, label="half of the runs are good" if shared else "boundary")
    if shared:
        return [line]
    return [
        Patch(facecolor=GOOD, label=words),
        Patch(facecolor=BAD, label="otherwise (crosses)"),
        line,
    ]
