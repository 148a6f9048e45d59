"""Draws what the theory of algorithm 1 says about saturated actuators, (27) and (28), along Fig. 6."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orchestration.paper.figures.over_time import Curve, time_axis
from orchestration.paper.figures.run import Run
from orchestration.paper.figures.style import BINS, BLACK, BLUE, LIGHT, VERMILLION, legend_above, new_figure
from orchestration.paper.figures.windows import Windows, with_margin
from orchestration.paper.saturation import Along, Gains, along

TITLE = "Saturation along Fig. 6, with what (27) and (28) say about it"
LEAST = 1e-12  # of V_c at the start, m and m/s: below it a logarithmic axis shows nothing


def saturation_figure(run: Run, gains: Gains, windows: Windows) -> Figure:
    """Panels (a) force that saturation takes away, (b) V_c, (c) its rate and the bound (28), (d) the region of (28).

    Parameters
    ----------
    run
        A run of algorithm 1 in which an actuator saturates.
    """
    terms = along(run.result, gains)
    figure, axes = new_figure(2, 2, TITLE)
    _missing_force(axes[0, 0], run, terms, gains.noise_bound)
    axes[0, 0].set_xlim(*windows.contact)
    _energy(axes[0, 1], run, terms)
    _rates(axes[1, 0], terms)
    _region(axes[1, 1], terms)
    return figure


def _missing_force(axis: Axes, run: Run, terms: Along, noise_bound: float) -> None:
    Curve(terms.time, terms.missing, r"$\|\Delta F_s\|$", BLUE, 0.9).draw(axis, run.span)
    axis.axhline(noise_bound, color=BLACK, ls="--", lw=1.0, label=r"noise bound $\delta$")
    time_axis(axis, run, "(a) Force that saturation takes away", "force (N)")
    axis.set_ylim(bottom=0)
    legend_above(axis)


def _energy(axis: Axes, run: Run, terms: Along) -> None:
    axis.set_yscale("log")
    share = np.maximum(terms.V / terms.V[0], LEAST)
    Curve(terms.time, share, "$V_c$", BLUE).draw(axis)
    axis.plot(terms.time[terms.saturated], share[terms.saturated], ".", color=VERMILLION, ms=4, label="while saturated")
    time_axis(axis, run, "(b) $V_c$ as a share of its value at the start", "$V_c(t) / V_c(0)$")
    legend_above(axis)


def _rates(axis: Axes, terms: Along) -> None:
    """What V_c does over each saturated sample, beside the most that (28) allows at its begin.

    Equation (28) is one of continuous time. A sampled F_c turns e* around within a sample if gamma h/2 is above 1, and
    takes less from V_c than (28) says.
    """
    bound, rate = terms.bound[terms.saturated], terms.rate[terms.saturated]
    ends = np.array(with_margin(float(min(bound.min(), rate.min())), float(max(bound.max(), rate.max()))))
    axis.plot(ends, ends, "--", color=BLACK, lw=1.0, label="equality: below it (28) holds")
    axis.plot(bound, rate, ".", color=VERMILLION, ms=4, label="while saturated")
    axis.axhline(0, color=BLACK, lw=0.8)
    axis.axvline(0, color=BLACK, lw=0.8)
    axis.set_xlim(*ends)
    axis.set_ylim(*ends)
    axis.set_title("(c) Rate of $V_c$, and its bound")
    axis.set_xlabel("right side of (28) (m$^2$/s$^3$)", labelpad=1)
    axis.set_ylabel("change of $V_c$ over a sample (m$^2$/s$^3$)", labelpad=2)
    legend_above(axis)


def _region(axis: Axes, terms: Along) -> None:
    """Errors of the run, and the reach of the region outside of which (28) makes V_c fall."""
    e, de = np.maximum(terms.e, LEAST), np.maximum(terms.de, LEAST)
    shown = slice(None, None, max(1, len(e) // BINS))
    axis.loglog(1e3 * e[shown], de[shown], ".", color=LIGHT, ms=2, label="run")
    axis.loglog(1e3 * e[terms.saturated], de[terms.saturated], ".", color=VERMILLION, ms=4, label="while saturated")
    reach = 1e3 * terms.region.e, terms.region.de
    axis.plot(
        [LEAST, reach[0], reach[0]], [reach[1], reach[1], LEAST], color=BLACK, lw=1.3, label="reach of (28)", zorder=1
    )
    axis.set_xlim(1e3 * float(np.percentile(terms.e, 1)), 3 * reach[0])
    axis.set_ylim(float(np.percentile(terms.de, 1)), 3 * reach[1])
    axis.set_title("(d) Errors, and where (28) allows $V_c$ to grow")
    axis.set_xlabel(r"$\|e\|$ (mm)", labelpad=1)
    axis.set_ylabel(r"$\|\dot e\|$ (m/s)", labelpad=2)
    legend_above(axis)
