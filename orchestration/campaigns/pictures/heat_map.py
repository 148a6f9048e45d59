"""Heat maps: the measure over two factors, as the median over everything else that varies."""

from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.pictures.cells import cells, hatch, median, paint
from orchestration.campaigns.pictures.style import (
    FAILED,
    SCALE,
    legend_outside,
    new_figure,
    set_scale,
    strongest,
    wide_span,
)
from orchestration.campaigns.view import View
from orchestration.errors import StudyError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_heat_map(view: View) -> "Figure":
    """Draw the measure over the two factors that move it most, one panel for each variant of the system.

    Raises
    ------
    StudyError
        If fewer than two factors vary.
    """
    x, y = two_factors(view)
    variants = view.variants()
    figure = new_figure(1.2 + 4.2 * len(variants), 4.0)
    panels = figure.subplots(1, len(variants), squeeze=False)[0]
    shown = [_painted(view, some, x, y) for some in variants.values()]
    values = np.concatenate([numbers.ravel() for numbers in shown])
    colours = _colours(values)
    legend: dict[str, Any] = {}
    image = None
    for panel, (variant, some) in zip(panels, variants.items(), strict=True):
        image = _draw(panel, some, (x, y), colours, legend) or image
        panel.set_title(variant)
    if image is not None:
        runs = len(view.frame) // max(1, sum(numbers.size for numbers in shown)) if view.grid else 1
        label = view.label(view.measure) + (f", median of {runs} runs" if runs > 1 else "")
        figure.colorbar(image, ax=list(panels), label=label)
    legend_outside(figure, list(panels), list(legend.values()))
    return figure


def two_factors(view: View) -> tuple[str, str]:
    """The two factors of a map.

    Raises
    ------
    StudyError
        If fewer than two factors vary.
    """
    chosen = strongest(view)
    if len(chosen) < 2:
        varied = ", ".join(view.ordered) or "none"
        msg = f"A map needs two factors that vary besides seeds, and the table has {varied}; draw marginals instead."
        raise StudyError(msg)
    return chosen[0], chosen[1]


def _painted(view: View, some: View, x: str, y: str) -> np.ndarray:
    """The numbers that get colours."""
    return cells(some, x, y, some.values, median).numbers if view.grid else some.values


def _colours(values: np.ndarray) -> dict[str, Any]:
    from matplotlib.colors import LogNorm, Normalize

    found = values[np.isfinite(values)]
    span = (found.min(), found.max()) if found.size else (0.0, 1.0)
    return {"cmap": SCALE, "norm": LogNorm(*span) if wide_span(values) else Normalize(*span)}


def _draw(axes: "Axes", view: View, names: tuple[str, str], colours: dict[str, Any], legend: dict[str, Any]) -> Any:
    x, y = names
    if not view.grid:
        return _draw_samples(axes, view, names, colours)
    found = cells(view, x, y, view.values, median)
    image = paint(axes, view, found, **colours)
    failed = cells(view, x, y, ~np.isfinite(view.values), np.mean).numbers
    if entry := hatch(axes, view, found, failed == 1):
        entry.set_label("all runs failed, or none has a value")
        legend["all"] = entry
    some = (failed > 0) & (failed < 1)
    if some.any():
        rows, columns = np.nonzero(some)
        at = (view.levels(x)[columns], view.levels(y)[rows])
        label = "some runs failed, or have no value"
        legend["some"] = axes.plot(*at, "x", color=FAILED, ms=5, label=label)[0]
    return image


def _draw_samples(axes: "Axes", view: View, names: tuple[str, str], colours: dict[str, Any]) -> Any:
    """Samples as dots, since they have no cells."""
    x, y = (view.column(name) for name in names)
    finite = np.isfinite(view.values)
    set_scale(axes, view, x=names[0], y=names[1])
    axes.grid(visible=True, alpha=0.3)
    image = axes.scatter(x[finite], y[finite], c=view.values[finite], s=14, lw=0, **colours)
    if not finite.all():
        label = f"{int((~finite).sum())} of {len(finite)} runs without a value"
        axes.plot(x[~finite], y[~finite], "x", color=FAILED, ms=4, label=label)
    return image
