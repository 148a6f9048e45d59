"""Draws the paper's figures, with panels as in its captions.

They are drawn without pyplot, each on an Agg canvas of its own: a caller's backend and settings stay as they are.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from adaptimp_fmu.files.whole_file import whole_file
from orchestration.paper.measure import ESTIMATE, at_ticks, contact
from orchestration.paper.numbers import TORQUE_LIMITS, TORQUE_SHARE, TRUE_M2, WALL_OFFSET
from orchestration.paper.scenarios import SCENARIOS
from orchestration.paper.theory import wall_points
from orchestration.results.result import Result

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

STYLE: "dict[RcKeyType, Any]" = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "legend.framealpha": 0.7,
    "legend.edgecolor": "none",
    "legend.fontsize": 8,
    "lines.linewidth": 1.2,
    "savefig.dpi": 150,
    # Fixed: a computed layout draws every figure twice.
    "figure.subplot.left": 0.08,
    "figure.subplot.right": 0.985,
    "figure.subplot.bottom": 0.065,
    "figure.subplot.top": 0.925,
    "figure.subplot.hspace": 0.26,
    "figure.subplot.wspace": 0.2,
    "svg.hashsalt": "adaptimp",
}
ACTUAL, IDEAL, WALL = "tab:blue", "black", "0.75"
METADATA = {"png": {"Software": None}, "svg": {"Creator": None, "Date": None}}  # same input, same bytes
BINS = 2000  # of a time axis: more than the pixels it is drawn on
ZOOM_X = (-1.475, -1.435)  # m
ZOOM_Y = (-0.34, 0.34)  # m


def draw(results: Mapping[str, Result], folder: Path, image: str = "png") -> list[Path]:
    """Draw every figure whose run is in `results`; returns the files.

    Parameters
    ----------
    image
        File format, ``"png"`` or ``"svg"``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn = {}
    with mpl.rc_context(STYLE):
        for name, result in results.items():
            drawn[name] = _tirt_figure(result) if name == "fig3" else _control_figure(result)
            drawn[name].suptitle(f"Fig. {name[3:]}: {SCENARIOS[name].caption}", x=0.01, ha="left")
        if {"fig5", "fig7"} <= set(results):
            drawn["torques"] = _torque_figure(results["fig5"], results["fig7"])
        for name, figure in drawn.items():
            with whole_file(folder / f"{name}.{image}") as file:
                figure.savefig(file, format=image, metadata=METADATA[image])
    return [folder / f"{name}.{image}" for name in drawn]


def _panels() -> tuple[Figure, np.ndarray]:
    """An empty figure, and its axes, shape (2, 2)."""
    figure = Figure(figsize=(10, 7.5))
    FigureCanvasAgg(figure)
    return figure, figure.subplots(2, 2)


def _control_figure(result: Result) -> Figure:
    """Panels (a) trajectories, (b) torques or estimate, (c) tracking error, (d) contact force."""
    figure, axes = _panels()
    _trajectories(axes[0, 0], result)
    ticks = result.tick_times("actuator.tau[1]")
    estimate = result.at_ticks(ESTIMATE)
    if np.ptp(estimate) > 0:
        axes[0, 1].axhspan(0.8 * TRUE_M2, 1.2 * TRUE_M2, color="tab:green", alpha=0.12, lw=0, label="±20 %")
        axes[0, 1].axhline(TRUE_M2, color=IDEAL, ls="--", lw=0.8, label="true")
        axes[0, 1].plot(*_envelope(ticks, estimate), color=ACTUAL, label=r"$\hat m_2$")
        _time_axis(axes[0, 1], result, "(b) Estimated $m_2$", "mass (kg)")
    else:
        _torques(axes[0, 1], result)
        _time_axis(axes[0, 1], result, "(b) Control torques", "torque (N m)")
    for i in (1, 2):
        error = result.at_ticks(f"controller.e[{i}]") * 1e3
        axes[1, 0].plot(*_envelope(ticks, error), label=f"$e_{i}$")
    _time_axis(axes[1, 0], result, "(c) Tracking error $e = x - x_t$", "error (mm)")
    axes[1, 0].legend(loc="lower right")
    force = np.linalg.norm(result["plant.F_ext"], axis=1)
    axes[1, 1].plot(*_envelope(result.time, force), color=ACTUAL, label=r"$\|F_{ext}\|$")
    _time_axis(axes[1, 1], result, "(d) Contact force", "force (N)")
    return figure


def _torque_figure(one: Result, two: Result) -> Figure:
    """Commanded torques of algorithms 1 and 2 at each joint, whole and in contact, with Fig. 6's limits."""
    figure, axes = _panels()
    for row, limit in enumerate(TORQUE_LIMITS):
        for column, axis in enumerate(axes[row]):
            for result, name in ((one, "algorithm 1"), (two, "algorithm 2")):
                command = f"controller.tau_cmd[{row + 1}]"
                curve = result.tick_times(command), result.at_ticks(command)
                axis.plot(*(curve if column else _envelope(*curve)), lw=0.8, label=name)
            axis.axhline(limit, color="tab:red", ls=":", label=f"{100 * TORQUE_SHARE:g} % of the largest")
            axis.axhline(-limit, color="tab:red", ls=":")
            title = f"({'abcd'[2 * row + column]}) Joint {row + 1}{', in contact' if column else ''}"
            _time_axis(axis, one, title, "torque (N m)")
    touch = contact(one)
    for whole, detail in axes:
        whole.legend(loc="lower right")
        detail.get_legend().remove()
        detail.set_xlim(touch.first - 0.01, touch.last + 0.02)
    figure.suptitle("Commanded torques of algorithm 1 (Fig. 5) and algorithm 2 (Fig. 7)", x=0.01, ha="left")
    return figure


def _torques(axis: Axes, result: Result) -> None:
    for i in (1, 2):
        torque = result.at_ticks(f"actuator.tau[{i}]")
        axis.plot(*_envelope(result.tick_times("actuator.tau[1]"), torque), label=f"$\\tau_{i}$")


def _tirt_figure(result: Result) -> Figure:
    """The TIRT (dashed) and the virtual trajectory (solid), whole and near the wall; and their distance."""
    figure, axes = _panels()
    x_t, x_v = at_ticks(result, "controller.x_t"), at_ticks(result, "trajectory.x_v")
    for axis, title in ((axes[0, 0], "(a) In the plane"), (axes[0, 1], "(b) Near the wall")):
        _wall(axis)
        axis.plot(*_path(x_v), color=ACTUAL, label="virtual $x_v$")
        axis.plot(*_path(x_t), "--", color=IDEAL, label="TIRT $x_t$")
        _plane(axis, title)
    _zoom(axes[0, 1])
    axes[0, 1].legend(loc="center left")
    ticks = result.tick_times("controller.x_t[1]")
    for i in (1, 2):
        difference = (x_t[:, i - 1] - x_v[:, i - 1]) * 1e3
        axes[1, 0].plot(*_envelope(ticks, difference), label=f"$x_{{{i}t}} - x_{{{i}v}}$")
    _time_axis(axes[1, 0], result, "(c) TIRT minus virtual trajectory", "difference (mm)")
    distance = np.linalg.norm(x_t - x_v, axis=1) * 1e3
    axes[1, 1].semilogy(ticks, np.maximum(distance, 1e-9), color=ACTUAL, label=r"$\|x_t - x_v\|$")
    _time_axis(axes[1, 1], result, "(d) Their distance", "distance (mm)")
    axes[1, 1].set_ylim(1e-7, 1e2)
    return figure


def _trajectories(axis: Axes, result: Result) -> None:
    _wall(axis)
    virtual, actual = at_ticks(result, "trajectory.x_v"), result["plant.x"]
    axis.plot(*_path(virtual), "--", color=IDEAL, label="ideal (virtual)")
    axis.plot(*_path(actual), color=ACTUAL, label="actual")
    _plane(axis, "(a) Ideal and actual trajectories")
    inset = axis.inset_axes((0.3, 0.27, 0.27, 0.46))
    _wall(inset, labels=False)
    inset.plot(*_path(virtual), "--", color=IDEAL)
    inset.plot(*_path(actual), color=ACTUAL)
    _zoom(inset)
    inset.tick_params(labelsize=7)
    axis.indicate_inset_zoom(inset, edgecolor="0.4")


def _plane(axis: Axes, title: str) -> None:
    axis.set_title(title)
    axis.set_xlabel("$x_1$ (m)")
    axis.set_ylabel("$x_2$ (m)")
    axis.set_xlim(-1.75, 1.75)
    axis.set_ylim(-1.3, 1.3)
    axis.set_aspect("equal", adjustable="box")
    axis.legend(loc="center", bbox_to_anchor=(0.78, 0.5))


def _zoom(axis: Axes) -> None:
    axis.set_aspect("auto")
    axis.set_xlim(*ZOOM_X)
    axis.set_ylim(*ZOOM_Y)
    axis.xaxis.set_major_locator(MaxNLocator(4 if axis.get_window_extent().width > 300 else 2))


def _wall(axis: Axes, *, labels: bool = True) -> None:
    """The wall's inside, and the points a and b."""
    axis.axvspan(-3, -WALL_OFFSET, color=WALL, lw=0, label="wall" if labels else None, zorder=0)
    for point, name, offset in zip(wall_points(), "ab", ((6, 3), (6, -9)), strict=True):
        axis.plot(*point, "o", color="tab:red", ms=4, zorder=5)
        axis.annotate(name, (point[0], point[1]), textcoords="offset points", xytext=offset, color="tab:red")


def _time_axis(axis: Axes, result: Result, title: str, ylabel: str) -> None:
    """Label a plot over time and shade the contact."""
    touch = contact(result)
    axis.axvspan(touch.first, touch.last, color=WALL, alpha=0.4, lw=0, label="contact", zorder=0)
    axis.set_title(title)
    axis.set_xlabel("t (s)")
    axis.set_ylabel(ylabel)
    axis.set_xlim(result.time[0], result.time[-1])
    axis.legend(loc="upper right")


def _envelope(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve thinned to what a picture shows: the least and the largest value of each of `BINS` pieces."""
    size = t.size // BINS
    if size <= 2:
        return t, y
    pieces = y[: size * BINS].reshape(BINS, size)
    ends = np.sort(np.stack([pieces.argmin(axis=1), pieces.argmax(axis=1)], axis=1), axis=1)
    kept = (ends + size * np.arange(BINS)[:, None]).ravel()
    kept = np.concatenate([kept, np.arange(size * BINS, t.size)])
    return t[kept], y[kept]


def _path(points: np.ndarray) -> np.ndarray:
    """A smooth path, thinned to about 10 `BINS` points, shape (2, n)."""
    return points[:: max(1, len(points) // (10 * BINS))].T
