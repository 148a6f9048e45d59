"""Sensitivity indices as bars with their confidence."""

from typing import TYPE_CHECKING

import numpy as np

from orchestration.campaigns.pictures.style import COLOURS, legend_outside, new_figure

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_WORDS = {"S1": "S1: share that goes when the factor is fixed", "ST": "ST: share that stays when all others are fixed"}


def draw_indices(found: "pd.DataFrame") -> "Figure":
    """Draw what `orchestration.sensitivity` returns, the strongest factor on top."""
    kinds = [kind for kind in ("ST", "S1") if kind in found]
    ordered = found.sort_values(kinds[0])
    figure = new_figure(6.4, 1.3 + 0.45 * len(ordered))
    axes = figure.subplots()
    height = 0.8 / len(kinds)
    for place, kind in enumerate(kinds):
        at = np.arange(len(ordered)) + (len(kinds) - 1 - 2 * place) * height / 2
        spread = ordered[f"{kind}_conf"].to_numpy() if f"{kind}_conf" in ordered else None
        colour = COLOURS[0] if kind == "S1" else COLOURS[4]
        axes.barh(at, ordered[kind], height, color=colour, label=_WORDS[kind])
        if spread is not None:
            axes.errorbar(ordered[kind], at, xerr=spread, fmt="none", ecolor="black", capsize=2.5, lw=1)
    axes.set_yticks(np.arange(len(ordered)), ordered.index)
    axes.axvline(0, color="black", lw=0.8)
    axes.grid(visible=True, axis="x", alpha=0.3)
    about = found.attrs
    bars = ", bars: 95 % confidence" if f"{kinds[0]}_conf" in ordered else ""
    axes.set_xlabel(f"share of the variance of {about['measure']}\n{about['method']}, {about['points']} points{bars}")
    if about["left_out"]:
        axes.set_title(f"{about['left_out']} points left out: a run failed, or has no value", loc="left")
    legend_outside(figure, [axes])
    return figure
