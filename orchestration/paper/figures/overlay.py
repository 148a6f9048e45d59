"""Draws the paper's four panels for any runs of the paper's loop, several of them in one figure.

Columns of sampled components are drawn as they are held: from the instant of a tick until the next one. Columns of the
plant are its states at the communication points.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from orchestration.paper.figures.phases import draw_phases, height_of_strips, phases
from orchestration.paper.figures.plane import ROOM
from orchestration.paper.figures.style import BINS, ROW, envelope, legend_above, new_figure, thinned
from orchestration.paper.figures.theme import DASHES, Theme
from orchestration.paper.figures.view import View, wall_of
from orchestration.paper.numbers import WALL_NORMAL
from orchestration.paper.spatial_numbers import LENGTH, POSITIONS
from orchestration.paper.task_shape import PLANAR, SPATIAL, forces, lengths, scales, shape_of
from orchestration.results.columns import TicksMissingError
from orchestration.results.result import Result

TIP, GAP, COMMANDED, ERROR, FORCE = "plant.x", "plant.gap", "trajectory.x_v", "controller.e", "plant.F_ext"
MEASURED = "sensor.F_hat"
TORQUES = ("actuator.tau", "controller.tau_cmd")
"""The torque of the actuators, or else the command."""
NEEDED = (TIP, ERROR, FORCE)
SMALLEST_SPAN = 1e-9  # kg: an estimate that moves less is constant, and the torques are drawn
COLUMNS_OF_LEGEND = 4
AROUND = 0.12  # of the size of the path of a tip in space, left free around it
DIGITS, WIDE = 5, 0.32  # of a longer number beside a panel on the right, and the space that the panels then have
TALL = 195  # points: height of a panel
LINE, WIDER = 1.3, 0.9  # points: width of the last run, and by how much each run before it is wider


@dataclass(frozen=True)
class Overlay:
    """Runs by their labels, and how they look.

    Attributes
    ----------
    runs
        Results of the paper's loop.
    bands
        Phases of each run, of `orchestration.paper.figures.phases.phases`.
    """

    runs: Mapping[str, Result]
    theme: Theme
    bands: Sequence[Mapping[str, np.ndarray]] = field(default_factory=tuple)

    @property
    def alone(self) -> bool:
        """Whether there is one run only, so that colours can tell the components of a vector."""
        return len(self.runs) == 1

    def looks(self, run: int, component: int) -> dict[str, Any]:
        """Colour, dashes and width of a curve; of equal curves the wider ones below are still seen."""
        colour = self.theme.curves[component if self.alone else run]
        width = LINE + WIDER * (len(self.runs) - 1 - run)
        return {"color": colour, "ls": "-" if self.alone else DASHES[component % len(DASHES)], "lw": width}


def missing_columns(result: Result) -> list[str]:
    """Names of columns that the four panels need and the run lacks; empty for a run of the paper's loop."""
    sizes = [(PLANAR,), (SPATIAL,)]
    lacking = [name for name in NEEDED if name not in result or result[name].shape[1:] not in sizes]
    if not any(name in result for name in (*TORQUES, shape_of(result).estimate)):
        lacking.append(TORQUES[0])
    return lacking


def tasks(runs: Mapping[str, Result]) -> dict[int, str]:
    """The first run with each number of task coordinates; panels are drawn of runs with the same number only."""
    found: dict[int, str] = {}
    for label, result in runs.items():
        found.setdefault(shape_of(result).size, label)
    return found


def in_space(runs: Iterable[Result]) -> bool:
    """Whether all runs have a task of position and orientation in space."""
    return all(shape_of(result).size == SPATIAL for result in runs)


def overlay_figure(runs: Mapping[str, Result], theme: Theme, title: str) -> Figure:
    """Draw the path of the tip, torques or the estimate, the tracking error, and the contact force.

    Parameters
    ----------
    runs
        Results by their labels, at most `orchestration.paper.figures.theme.MOST_RUNS`, without `missing_columns`.
    """
    drawn = Overlay(runs, theme, [phases(result) for result in runs.values()])
    rows = -(-len(runs) // COLUMNS_OF_LEGEND) if len(runs) > 1 else 0
    figure, axes = new_figure(2, 2, title, row=ROW + 0.25 * bool(rows), head=(0.25 + 0.2 * rows) * bool(rows))
    if rows:
        figure.subplots_adjust(hspace=0.6)
    if in_space(runs.values()):
        _paths_in_space(axes[0, 0], drawn)
    else:
        _paths(axes[0, 0], drawn)
    draw_torques(axes[0, 1], drawn, "(b) ")
    draw_errors(axes[1, 0], drawn, "(c) ")
    draw_forces(axes[1, 1], drawn, "(d) Contact force")
    if max(map(_digits, axes[:, 1])) > DIGITS:
        figure.subplots_adjust(wspace=WIDE)
    if rows:
        handles = [Line2D([], [], color=colour, lw=2) for colour in theme.curves[: len(runs)]]
        place = {"loc": "upper left", "bbox_to_anchor": (0.005, 1 - 0.33 / figure.get_figheight())}
        figure.legend(handles, list(runs), ncols=COLUMNS_OF_LEGEND, **place)
    return figure


def _digits(axis: Axes) -> int:
    """Length of the longest number beside a panel."""
    return max(map(len, axis.yaxis.get_major_formatter().format_ticks(list(axis.get_yticks()))), default=0)


def _paths(axis: Axes, drawn: Overlay) -> None:
    """The plane of motion, to scale."""
    points = []
    for place, result in enumerate(drawn.runs.values()):
        tip = result[TIP]
        if COMMANDED in result:
            commanded = _ticks(result, COMMANDED)[1]
            points.append(commanded)
            axis.plot(*thinned(commanded), "--", color=drawn.theme.ink, lw=1.0, label="virtual $x_v$")
        points.append(tip)
        axis.plot(*thinned(tip), label="tip $x$" if drawn.alone else "", **drawn.looks(place, 0))
        axis.plot(*tip[0], "s", color=drawn.theme.curves[2], ms=5, zorder=6, label="start")
        if GAP in result:
            offset = float(tip[0] @ np.array(WALL_NORMAL) - result[GAP][0])
            axis.axvspan(-10, -offset, facecolor=drawn.theme.wall, lw=0, zorder=0, label="wall")
    whole = np.concatenate(points)
    whole = whole[np.isfinite(whole).all(axis=1)]
    low, high = (whole.min(axis=0) - ROOM, whole.max(axis=0) + ROOM) if len(whole) else ((-1, -1), (1, 1))
    _plane(axis, low, high, (0, 1))


def _plane(axis: Axes, low: Sequence[float], high: Sequence[float], shown: tuple[int, int]) -> None:
    """Limits and names of a panel of a plane, which is drawn to scale."""
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    axis.set_aspect("equal", adjustable="box", anchor="W")
    axis.set_title("(a) Path of the tip")
    axis.set_xlabel(f"$x_{shown[0] + 1}$ (m)", labelpad=1)
    axis.set_ylabel(f"$x_{shown[1] + 1}$ (m)", labelpad=1)
    legend_above(axis)


def _paths_in_space(axis: Axes, drawn: Overlay) -> None:
    """The path of the tip, seen along the axis of the base along which it moves least."""
    runs = list(drawn.runs.values())
    views = [View.of(result[TIP], wall_of(result)) for result in runs]
    shown = views[0].axes
    for place, (result, view) in enumerate(zip(runs, views, strict=True)):
        if COMMANDED in result:
            path = view.seen(_ticks(result, COMMANDED)[1])
            axis.plot(*thinned(path), "--", color=drawn.theme.ink, lw=1.0, label="virtual $x_v$")
        tip = view.seen(result[TIP])
        axis.plot(*thinned(tip), label="tip $x$" if drawn.alone else "", **drawn.looks(place, 0))
        axis.plot(*tip[0], "s", color=drawn.theme.curves[2], ms=5, zorder=6, label="start")
    whole = np.concatenate([view.seen(result[TIP]) for result, view in zip(runs, views, strict=True)])
    whole = whole[np.isfinite(whole).all(axis=1)]
    room = AROUND * float(np.ptp(whole, axis=0).max(initial=1e-3)) if len(whole) else 1.0
    low, high = (whole.min(axis=0) - room, whole.max(axis=0) + room) if len(whole) else ((-1, -1), (1, 1))
    for corners in filter(None, [view.wall(np.array(low), np.array(high)) for view in views]):
        axis.fill(*np.array(corners).T, color=drawn.theme.wall, lw=0, zorder=0, label="wall")
    _plane(axis, low, high, shown)


def draw_errors(axis: Axes, drawn: Overlay, letter: str) -> None:
    """Draw the tracking error: its components, or in space with several runs its size, in which an angle counts L."""
    if not in_space(drawn.runs.values()):
        _vectors(axis, drawn, ERROR, 1e3, "e")
        _finish(axis, drawn, f"{letter}Tracking error $e = x - x_t$", "error (mm)")
        return
    for place, result in enumerate(drawn.runs.values()):
        times, error = _ticks(result, ERROR)
        if not drawn.alone:
            _steps(axis, result, times, 1e3 * lengths(error), **drawn.looks(place, 0))
            continue
        for component, values in enumerate((1e3 * error * scales(SPATIAL)).T):
            label = f"${'' if component < POSITIONS else 'L '}e_{component + 1}$"
            _steps(axis, result, times, values, label=label, **drawn.looks(place, component))
    what = "e = x - x_t$" if drawn.alone else "\\|S e\\|$"
    _finish(axis, drawn, f"{letter}Tracking error ${what}, $L$ = {LENGTH:g} m", "error (mm)")


def draw_torques(axis: Axes, drawn: Overlay, letter: str) -> None:
    """Draw the estimate of the mass if it moves, or else the torques; the letter begins the title."""
    runs = drawn.runs.values()
    torque = next((name for name in TORQUES if all(name in result for result in runs)), None)
    shapes = [shape_of(result) for result in runs]
    shape = shapes[0]
    moves = (
        own.estimate in result and np.ptp(result[own.estimate]) > SMALLEST_SPAN
        for own, result in zip(shapes, runs, strict=True)
    )
    if torque is None or any(moves):
        for place, (own, result) in enumerate(zip(shapes, runs, strict=True)):
            if own.estimate in result:  # its place goes with the number of joints
                label = f"${shape.symbol}$" if drawn.alone else ""
                _steps(axis, result, *_ticks(result, own.estimate), label=label, **drawn.looks(place, 0))
        what = "Estimated $m_2$" if shape.size == PLANAR else "Estimated mass of the payload"
        _finish(axis, drawn, f"{letter}{what}", "mass (kg)")
        return
    _vectors(axis, drawn, torque, 1.0, r"\tau")
    which = "Control torques" if torque == TORQUES[0] else "Commanded torques"
    _finish(axis, drawn, f"{letter}{which}", "torque (N m)")


def _vectors(axis: Axes, drawn: Overlay, name: str, factor: float, letter: str) -> None:
    """The components of a vector at the ticks, each with a line of its own."""
    for place, result in enumerate(drawn.runs.values()):
        times, vectors = _ticks(result, name)
        for component, values in enumerate(factor * vectors.T):
            looks = drawn.looks(place, component)
            _steps(axis, result, times, values, label=f"${letter}_{component + 1}$" if drawn.alone else "", **looks)
    if not drawn.alone:
        for component in range(next(iter(drawn.runs.values()))[name].shape[1]):
            label = f"${letter}_{component + 1}$"
            axis.plot([], [], color=drawn.theme.ink, ls=DASHES[component % len(DASHES)], label=label)


def draw_forces(axis: Axes, drawn: Overlay, title: str) -> None:
    """Draw the magnitude of the contact force, and of what the sensor measured if there is a single run."""
    for place, result in enumerate(drawn.runs.values()):
        if drawn.alone and MEASURED in result:
            times, measured = _ticks(result, MEASURED)
            _steps(axis, result, times, forces(measured), label="measured", color=drawn.theme.curves[4], ls="-", lw=0.7)
        label = r"$\|F_{ext}\|$" if drawn.alone else ""
        axis.plot(*envelope(result.time, forces(result[FORCE])), label=label, **drawn.looks(place, 0))
    _finish(axis, drawn, title, "force (N)")


def _ticks(result: Result, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Instants, s, and values of a column at the ticks, where a sampled component takes its values.

    Of a run that does not record every tick, these are the rows, each with the value of the step before it.
    """
    try:
        return result.tick_times(name), result.at_ticks(name)
    except TicksMissingError:
        return result.time, result[name]


def _steps(axis: Axes, result: Result, times: np.ndarray, values: np.ndarray, **looks: Any) -> None:
    """A column that holds each value until the next instant, of which a line is drawn where steps cannot be seen."""
    if 0 < len(times) < len(result.time) and result.sample_times:
        times, values = np.append(times, result.time[-1]), np.append(values, values[-1])
    steps = bool(result.sample_times) and len(times) <= 2 * BINS
    axis.plot(*envelope(times, values), drawstyle="steps-post" if steps else "default", **looks)


def _finish(axis: Axes, drawn: Overlay, title: str, ylabel: str) -> None:
    """Bands, names and limits of a panel over time."""
    draw_phases(axis, drawn.bands, drawn.theme)
    gap = height_of_strips(len(drawn.runs))
    axis.set_title(title, pad=21 + TALL * gap)
    axis.set_xlabel("t (s)", labelpad=1)
    axis.set_ylabel(ylabel, labelpad=2)
    begin = min(float(result.time[0]) for result in drawn.runs.values())
    end = max(float(result.time[-1]) for result in drawn.runs.values())
    if end > begin:  # a run that failed in its first step has one row
        axis.set_xlim(begin, end)
    # One legend names the phases: that of the error has room for them, however many joints there are. The six
    # components of an error in space leave none.
    named = "force" if drawn.alone and in_space(drawn.runs.values()) else "error"
    bands = [] if named in ylabel else [name for run in drawn.bands for name in run]
    curves = [label for label in axis.get_legend_handles_labels()[1] if label not in bands]
    legend_above(axis, curves, gap=gap)
