"""Spread over seeds: quantiles of the measure over the seeds of noise, at each level of one factor."""

from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.pictures.style import (
    FAILED,
    groups,
    legend_outside,
    looks,
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

BANDS = ((0.05, 0.95, 0.15), (0.25, 0.75, 0.3))
"""Lower and upper quantile of each band, and how opaque it is."""


def draw_seeds(view: View) -> "Figure":
    """Draw quantiles over the seeds, at each level of the strongest factor; without one, the distribution.

    Raises
    ------
    StudyError
        If no seed varies.
    """
    if not view.seeds:
        msg = "No seed varies in the table; give the study seeds, such as study.seeds(range(1, 31))."
        raise StudyError(msg)
    figure = new_figure(6.0, 3.8)
    axes = figure.subplots()
    name = next(iter(strongest(view, 1)), None)
    for prefix, some, look in looks(view):
        if name is None:
            _draw_distribution(axes, some, prefix, look)
        else:
            _draw_bands(axes, some, name, prefix, look)
    axes.grid(visible=True, alpha=0.3)
    wide = "log" if wide_span(view.values) else "linear"
    if name is None:
        axes.set_xlabel(view.label(view.measure))
        axes.set_ylabel("share of the seeds with at most this value")
        axes.set_xscale(wide)
    else:
        axes.set_ylabel(view.label(view.measure))
        axes.set_yscale(wide)
        set_scale(axes, view, x=name)
    legend_outside(figure, [axes])
    return figure


def _draw_bands(axes: "Axes", view: View, name: str, prefix: str, look: dict[str, Any]) -> None:
    found = [(level, values) for level, values in groups(view, name)[0] if values.size]
    levels = np.array([level for level, _ in found])
    for low, high, opacity in BANDS:
        lower, upper = np.array([np.quantile(values, (low, high)) for _, values in found]).reshape(-1, 2).T
        label = f"{prefix}{low:.0%} to {high:.0%} of the seeds"
        axes.fill_between(levels, lower, upper, color=look["color"], alpha=opacity, lw=0, label=label)
    medians = [np.median(values) for _, values in found]
    axes.plot(levels, medians, label=f"{prefix}median", **look)
    failed = ~np.isfinite(view.values)
    if failed.any():
        label = f"{prefix}{int(failed.sum())} of {len(failed)} runs without a value"
        at = view.column(name)[failed]
        axes.plot(at, np.full(len(at), 0.03), "x", color=FAILED, transform=axes.get_xaxis_transform(), label=label)


def _draw_distribution(axes: "Axes", view: View, prefix: str, look: dict[str, Any]) -> None:
    """The empirical distribution, with its quantiles as dots."""
    values = np.sort(view.values[np.isfinite(view.values)])
    if not values.size:
        return
    label = f"{prefix}{len(values)} of {len(view.values)} runs"
    axes.step(
        values,
        np.arange(1, len(values) + 1) / len(view.values),
        where="post",
        color=look["color"],
        ls=look["ls"],
        label=label,
    )
    marked = np.array([0.05, 0.25, 0.5, 0.75, 0.95])
    share = len(values) / len(view.values)
    quantiles = np.quantile(values, marked, method="inverted_cdf")
    dots: dict[str, Any] = look | {"ls": ""}
    axes.plot(quantiles, marked * share, label=f"{prefix}5, 25, 50, 75, 95 %", **dots)
