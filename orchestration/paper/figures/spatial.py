"""Draws the figures of the PUMA 560 that stand beside Figs. 2 to 7 of the paper."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from orchestration.paper.figures.overlay import Overlay, overlay_figure
from orchestration.paper.figures.phases import draw_phases, phases
from orchestration.paper.figures.style import envelope, legend_above, new_figure
from orchestration.paper.figures.theme import LIGHT_PAGE, Theme
from orchestration.paper.figures.view import View, wall_of
from orchestration.paper.measure import Contact, at_ticks, contact
from orchestration.paper.task_shape import lengths
from orchestration.results.picture_file import save
from orchestration.results.result import Result

LEAST = 1e-5  # mm, the lower end of the logarithmic axis
NEAR = (0.35, 0.4, 1.6)  # left free: of the length of the contact at both ends, and of the depth below and above it


def draw_in_space(
    results: Mapping[str, Result], captions: Mapping[str, str], folder: Path, image: str = "png"
) -> list[Path]:
    """Draw the runs of the PUMA 560 by the name of the paper's figure, and both algorithms' torques; returns the files.

    Parameters
    ----------
    results, captions
        Runs with all outputs, and what they are, by ``"fig2"`` to ``"fig7"``.
    image
        File format, ``"png"`` or ``"svg"``.

    Raises
    ------
    NoContactError
        If the tip never touched the table in the run of Fig. 3.
    """
    folder.mkdir(parents=True, exist_ok=True)
    theme, paths = LIGHT_PAGE, []
    with mpl.rc_context(theme.settings()):
        for name, figure in _figures(results, captions, theme).items():
            paths.append(folder / f"puma-{name}.{image}")
            save(figure, paths[-1])
    return paths


def _figures(results: Mapping[str, Result], captions: Mapping[str, str], theme: Theme) -> dict[str, Figure]:
    drawn = {}
    for name in ("fig2", "fig4", "fig5", "fig7"):
        drawn[name] = overlay_figure({name: results[name]}, theme, f"As Fig. {name[3:]}: {captions[name]}")
    drawn["fig3"] = tirt_in_space(results["fig3"], theme, "As Fig. 3: the TIRT versus the virtual trajectory, PUMA 560")
    both = {"with saturation": results["fig6"], "without": results["fig5"]}
    drawn["fig6"] = overlay_figure(both, theme, f"As Fig. 6: {captions['fig6']}")
    drawn["torques"] = torques_in_space(results, theme)
    return dict(sorted(drawn.items()))


def tirt_in_space(result: Result, theme: Theme, title: str) -> Figure:
    """Panels (a) paths near the table, each axis with a scale of its own, and (b) the distance |S (x_t - x_v)|."""
    figure, axes = new_figure(1, 2, title)
    near, over_time = axes[0]
    x_v, x_t = at_ticks(result, "trajectory.x_v"), at_ticks(result, "controller.x_t")
    touch, view = contact(result), View.of(result["plant.x"], wall_of(result))
    for points, style, colour, label in (
        (x_v, "--", theme.ink, "virtual $x_v$"),
        (x_t, "-", theme.curves[0], "TIRT $x_t$"),
        (result["plant.x"], ":", theme.curves[1], "tip $x$"),
    ):
        near.plot(*view.seen(points).T, style, color=colour, label=label)
    window = _near(view, touch, [result["plant.x"], x_v])
    for corner in filter(None, [view.wall(*window)]):
        near.fill(*np.array(corner).T, color=theme.wall, lw=0, zorder=0, label="table")
    near.set_xlim(window[0][0], window[1][0])
    near.set_ylim(window[0][1], window[1][1])
    figure.subplots_adjust(left=0.1, wspace=0.24)
    near.set_title("(a) Near the table, stretched")
    near.set_xlabel(f"$x_{view.axes[0] + 1}$ (m)", labelpad=1)
    near.set_ylabel(f"$x_{view.axes[1] + 1}$ (m)", labelpad=1)
    legend_above(near)
    distance = np.maximum(1e3 * lengths(x_t - x_v), LEAST / 10)
    over_time.set_yscale("log")
    over_time.plot(*envelope(result.tick_times("controller.x_t[1]"), distance), color=theme.curves[0])
    draw_phases(over_time, [phases(result)], theme)
    over_time.set_xlim(float(result.time[0]), float(result.time[-1]))
    over_time.set_ylim(LEAST, 1e1)
    over_time.set_title(r"(b) Their distance $\|S (x_t - x_v)\|$")
    over_time.set_xlabel("t (s)", labelpad=1)
    over_time.set_ylabel("distance (mm)", labelpad=2)
    legend_above(over_time)
    return figure


def _near(view: View, touch: Contact, paths: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner of what is shown near the table, m, shape (2,) each."""
    ends = view.seen(np.array([touch.enter, touch.leave]))
    deepest = min(float(view.seen(path)[:, 1].min()) for path in paths)
    span, depth = float(np.ptp(ends[:, 0])), float(ends[:, 1].mean() - deepest)
    low = np.array([ends[:, 0].min() - NEAR[0] * span, deepest - NEAR[1] * depth])
    return low, ends.max(axis=0) + np.array([NEAR[0] * span, NEAR[2] * depth])


def torques_in_space(results: Mapping[str, Result], theme: Theme) -> Figure:
    """The commanded torques of both algorithms near the contact, a panel for each joint, with the limits of Fig. 6."""
    figure, axes = new_figure(
        3, 2, "PUMA 560: commanded torques of algorithms 1 (Fig. 5) and 2 (Fig. 7) in contact", 2.6
    )
    touch = contact(results["fig5"])
    edge = 0.2 * (touch.last - touch.first)
    drawn = Overlay({"algorithm 1": results["fig5"], "algorithm 2": results["fig7"]}, theme)
    for joint, axis in enumerate(axes.ravel()):
        for place, (label, result) in enumerate(drawn.runs.items()):
            times, torques = result.tick_times("controller.tau_cmd[1]"), at_ticks(result, "controller.tau_cmd")
            shown = (times >= touch.first - edge) & (times <= touch.last + edge)
            looks = {**drawn.looks(place, 0), "ls": "-", "lw": 0.8}
            axis.plot(*envelope(times[shown], torques[shown, joint]), label=label, **looks)
        limited = results["fig6"]
        cut = limited[f"actuator.saturated[{joint + 1}]"] > 0
        if cut.any():
            limit = float(np.abs(limited[f"actuator.tau[{joint + 1}]"][cut]).max())
            for sign, label in ((1, "limit of Fig. 6"), (-1, "")):
                axis.axhline(sign * limit, color=theme.ink, ls=":", lw=1.2, label=label)
        axis.set_xlim(touch.first - edge, touch.last + edge)
        axis.set_title(f"({'abcdef'[joint]}) Joint {joint + 1}")
        axis.set_xlabel("t (s)", labelpad=1)
        axis.set_ylabel("torque (N m)", labelpad=2)
        legend_above(axis)
    figure.subplots_adjust(hspace=0.75)
    return figure
