"""Draws Figs. 2, 4, 5 and 7: the path of the tip, torques or the estimate, the tracking error, the contact force."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orchestration.paper.figures.over_time import Curve, time_axis, zoom
from orchestration.paper.figures.plane import Path, plane
from orchestration.paper.figures.run import Run, Span
from orchestration.paper.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    VERMILLION,
    legend_above,
    new_figure,
)
from orchestration.paper.figures.windows import Windows, near_contact
from orchestration.paper.numbers import TRUE_M2

COLOURS = (BLUE, ORANGE)  # of the first and the second component


def control_figure(run: Run, windows: Windows, title: str) -> Figure:
    """Panels (a) trajectories, (b) torques or estimate, (c) tracking error, (d) contact force."""
    figure, axes = new_figure(2, 2, title)
    four_panels(axes, run, windows)
    return figure


def four_panels(axes: np.ndarray, run: Run, windows: Windows, behind: Run | None = None) -> None:
    """Draw the four panels of a run.

    Parameters
    ----------
    axes
        Shape (2, 2).
    behind
        Another run whose curves are drawn in grey behind those of the run.
    """
    trajectories(axes[0, 0], run, windows, behind)
    if np.ptp(run.estimate) > 0:
        _estimate(axes[0, 1], run, windows, behind)
    else:
        _torques(axes[0, 1], run, windows)
    _error(axes[1, 0], run, windows, behind)
    _force(axes[1, 1], run, windows, behind)


def trajectories(axis: Axes, run: Run, windows: Windows, behind: Run | None) -> None:
    """Panel (a)."""
    paths = [Path(run.x_v, "ideal (virtual)", BLACK, dashed=True), Path(run.x, "actual", BLUE)]
    if behind is not None:
        paths.insert(0, Path(behind.x, "Fig. 5", GREY))
    plane(axis, run, windows, paths, "(a) Ideal and actual trajectories")


def _estimate(axis: Axes, run: Run, windows: Windows, behind: Run | None) -> None:
    curves = [Curve(run.ticks, run.estimate, r"$\hat m_2$", BLUE)]
    if behind is not None:
        curves.insert(0, Curve(behind.ticks, behind.estimate, "Fig. 5", GREY, 2.2))
    _true_mass(axis)
    _panel(axis, run, curves, "(b) Estimated $m_2$", "mass (kg)", limits=windows.mass.whole)
    if windows.mass.near:
        inset = zoom(axis, run, curves, windows.contact, windows.mass.near, at_top=windows.mass.inset_at_top)
        _true_mass(inset)
        _inset_title(inset, "near the contact")
    legend_above(axis)


def _true_mass(axis: Axes) -> None:
    axis.axhspan(0.8 * TRUE_M2, 1.2 * TRUE_M2, facecolor=GREEN, alpha=0.15, lw=0, label="true ±20 %", zorder=0.5)
    axis.axhline(TRUE_M2, color=BLACK, ls="--", lw=0.9)


def _torques(axis: Axes, run: Run, windows: Windows) -> None:
    curves = [Curve(run.ticks, run.torque[:, i], f"$\\tau_{i + 1}$", colour) for i, colour in enumerate(COLOURS)]
    _panel(axis, run, curves, "(b) Control torques", "torque (N m)", limits=windows.torque.whole)
    legend_above(axis)


def _error(axis: Axes, run: Run, windows: Windows, behind: Run | None) -> None:
    curves = [Curve(run.ticks, run.e[:, i], f"$e_{i + 1}$", colour) for i, colour in enumerate(COLOURS)]
    if behind is not None:
        curves[:0] = [Curve(behind.ticks, behind.e[:, i], "Fig. 5", GREY, 2.2) for i in (0, 1)]
    _panel(axis, run, curves, "(c) Tracking error $e = x - x_t$", "error (mm)", limits=windows.error.whole)
    if near := windows.error.near_of(near_contact(run, run.e, windows.contact)):
        inset = zoom(axis, run, curves, windows.contact, near, at_top=windows.error.inset_at_top)
        _inset_title(inset, "near the contact" if windows.error.near else "in contact, own scale")
    legend_above(axis)


def _force(axis: Axes, run: Run, windows: Windows, behind: Run | None) -> None:
    curves = [Curve(run.result.time, run.force, r"$\|F_{ext}\|$", BLUE)]
    if behind is not None:
        curves.insert(0, Curve(behind.result.time, behind.force, "Fig. 5", GREY, 2.2))
    if run.noisy:
        curves.insert(0, Curve(run.ticks, run.measured, "measured", LIGHT, 0.6))
    _panel(axis, run, curves, "(d) Contact force", "force (N)", limits=windows.force)
    inset = zoom(axis, run, curves, windows.contact, (0, windows.sliding), at_top=True)
    inset.axhline(run.steady_force, color=VERMILLION, ls="--", lw=1.1)
    _inset_title(inset, f"dashed: $K$ depth = {run.steady_force:.3g} N")
    legend_above(axis)


def _inset_title(inset: Axes, title: str) -> None:
    inset.set_title(title, fontsize=7.5, loc="center", pad=2)


def _panel(axis: Axes, run: Run, curves: list[Curve], title: str, ylabel: str, *, limits: Span) -> None:
    """Draw curves over the whole time."""
    for curve in curves:
        curve.draw(axis)
    time_axis(axis, run, title, ylabel)
    axis.set_ylim(*limits)
