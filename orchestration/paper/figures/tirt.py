"""Draws Fig. 3: the target-impedance reference trajectory (TIRT) beside the virtual trajectory."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orchestration.paper import tirt
from orchestration.paper.figures.over_time import Curve, time_axis
from orchestration.paper.figures.plane import Path, near_wall, stretched, whole_plane
from orchestration.paper.figures.run import Run
from orchestration.paper.figures.style import BLACK, BLUE, LIGHT, ORANGE, VERMILLION, legend_above, new_figure
from orchestration.paper.figures.windows import Windows
from orchestration.paper.measure import at_ticks, norms
from orchestration.paper.numbers import TARGET_INERTIA, TARGET_STIFFNESS

OFFSET = r"$(hM/2K)\,\|\dddot{x}_v\|$"  # at which sampling holds the TIRT
CRITICAL_DAMPING = 2 * math.sqrt(TARGET_INERTIA * TARGET_STIFFNESS)  # N.s/m, of the run
LEAST = 1e-7  # mm, the lower end of the logarithmic axis


def tirt_figure(run: Run, windows: Windows, title: str) -> Figure:
    """Panels (a) and (b) the paths, whole and near the wall; (c) their difference; (d) their distance."""
    figure, axes = new_figure(2, 2, title)
    x_t = at_ticks(run.result, "controller.x_t")
    paths = [Path(run.x_v, "virtual $x_v$", BLUE), Path(x_t, "TIRT $x_t$", BLACK, dashed=True)]
    whole_plane(axes[0, 0], run, paths, "(a) In the plane")
    near_wall(axes[0, 1], run, windows, paths)
    axes[0, 1].set_title(f"(b) Near the wall, {stretched(axes[0, 1])}")
    axes[0, 1].set_xlabel("$x_1$ (m)", labelpad=1)
    axes[0, 1].set_ylabel("$x_2$ (m)", labelpad=1)
    legend_above(axes[0, 1])
    difference = (x_t - run.x_v) * 1e3
    for i, colour in enumerate((BLUE, ORANGE)):
        Curve(run.ticks, difference[:, i], f"$x_{{{i + 1}t}} - x_{{{i + 1}v}}$", colour).draw(axes[1, 0])
    time_axis(axes[1, 0], run, "(c) TIRT minus virtual trajectory", "difference (mm)")
    legend_above(axes[1, 0])
    _distance(axes[1, 1], run, norms(difference))
    return figure


def _distance(axis: Axes, run: Run, distance: np.ndarray) -> None:
    axis.set_yscale("log")
    exact = 1e3 * norms(tirt.difference(run.result, CRITICAL_DAMPING, run.wall_offset, run.depth))
    Curve(run.ticks, np.maximum(distance, LEAST / 10), "sampled", LIGHT, 3.0).draw(axis)
    Curve(run.ticks, np.maximum(exact, LEAST / 10), "by (11)", BLUE).draw(axis)
    Curve(run.ticks, 1e3 * tirt.sampling_offset(run.ticks), OFFSET, VERMILLION, 1.0, dashed=True).draw(axis)
    time_axis(axis, run, r"(d) Their distance $\|x_t - x_v\|$", "distance (mm)")
    axis.set_ylim(LEAST, 1e2)
    legend_above(axis)
