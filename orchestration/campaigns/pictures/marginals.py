"""Marginals: the measure over each factor, as median and quantiles over everything else that varies."""

from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.pictures.style import (
    FAILED,
    GREY,
    groups,
    legend_outside,
    looks,
    new_figure,
    set_scale,
    wide_span,
)
from orchestration.campaigns.view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = 3
LOW, HIGH = 0.1, 0.9  # quantiles of the band
MOST_DOTS = 4000  # runs that are shown one by one


def draw_marginals(view: View) -> "Figure":
    """Draw the measure over each factor, one panel for each."""
    names = view.ordered or view.seeds
    columns = min(COLUMNS, len(names))
    rows = -(-len(names) // columns)
    figure = new_figure(max(4.8, 3.4 * columns), 0.7 + 2.7 * rows)
    panels = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for panel, name in zip(panels, names, strict=False):
        for prefix, some, look in looks(view):
            _draw(panel, some, name, prefix, look)
        set_scale(panel, view, x=name)
        panel.grid(visible=True, alpha=0.3)
    for panel in panels[len(names) :]:
        panel.set_visible(False)
    if wide_span(view.values):
        panels[0].set_yscale("log")
    for panel in panels[::columns]:
        panel.set_ylabel(view.label(view.measure))
    legend_outside(figure, panels)
    return figure


def _draw(axes: "Axes", view: View, name: str, prefix: str, look: dict[str, Any]) -> None:
    found, grouped = groups(view, name)
    found = [(level, values) for level, values in found if values.size]
    at, values = view.column(name), view.values
    spread = any(values.size > 1 for _, values in found)
    if spread and len(values) <= MOST_DOTS:
        colour = look["color"] if prefix else GREY
        axes.plot(at, values, ".", color=colour, ms=5, alpha=0.5, mew=0, label=f"{prefix}runs")
    if found:
        levels = np.array([level for level, _ in found])
        quantiles = np.array([np.quantile(values, (LOW, 0.5, HIGH)) for _, values in found]).T
        if spread:
            label = f"{prefix}{LOW:.0%} to {HIGH:.0%} of the runs"
            axes.fill_between(levels, quantiles[0], quantiles[2], color=look["color"], alpha=0.2, lw=0, label=label)
        what = "median of neighbours" if grouped else "median" if spread else "run"
        axes.plot(levels, quantiles[1], label=f"{prefix}{what}", **look)
    failed = ~np.isfinite(values)
    if failed.any():
        bottom = axes.get_xaxis_transform()
        label = f"{prefix}{int(failed.sum())} of {len(values)} runs without a value"
        axes.plot(at[failed], np.full(failed.sum(), 0.03), "x", color=FAILED, ms=4, transform=bottom, label=label)
