"""Draws Fig. 1: the arm in its start pose, the wall, and the virtual trajectory."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from orchestration.paper.figures.plane import Path, near_wall, stretched
from orchestration.paper.figures.run import Run
from orchestration.paper.figures.style import BLACK, BLUE, GREEN, GREY, VERMILLION, WALL, new_figure, thinned
from orchestration.paper.figures.windows import Windows
from orchestration.paper.numbers import ARM, TRUE_MASSES, WALL_STIFFNESS

TITLE = "Fig. 1: The robot manipulator and its virtual trajectory"
SIZE = (1.95, 1.25)  # m: half of what is shown
INSET = (0.575, 0.575, 0.165, 0.18)  # of the panel, between the arm and the ellipse


def manipulator_figure(run: Run, windows: Windows) -> Figure:
    """The arm at the start and in contact, with frame, angles, masses, wall and force.

    Parameters
    ----------
    run
        Any run: it tells where the wall is, and the poses.
    """
    figure, axes = new_figure(1, 1, TITLE, 5.75)
    axis = axes[0, 0]
    axis.set_position((0.06, 0.08, 0.93, 0.85))
    axis.grid(visible=False)
    _wall(axis, run)
    axis.plot(*thinned(run.x_v), "--", color=BLACK, lw=1.2, zorder=2)
    rows = np.flatnonzero(run.force > 0)
    touching = run.result["plant.q"][rows[3 * rows.size // 4]]
    at_start = run.result["plant.q"][0]
    _arm(axis, touching, GREY)
    _arm(axis, at_start, BLUE)
    _names(axis, at_start)
    _angles(axis, at_start)
    _marks(axis, run)
    _force(axis, _joints(touching)[-1])
    axis.set_xlim(-SIZE[0], SIZE[0])
    axis.set_ylim(-SIZE[1], SIZE[1])
    axis.set_aspect("equal", adjustable="box")
    axis.set_xlabel("$x_1$ (m)", labelpad=1)
    axis.set_ylabel("$x_2$ (m)", labelpad=1)
    _segment(axis, run, windows)
    return figure


def _joints(q: np.ndarray) -> np.ndarray:
    """Base, elbow and tip of the arm, m, shape (3, 2)."""
    angles = np.cumsum(q)
    links = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(ARM.link_lengths)[:, None]
    return np.vstack([[0.0, 0.0], np.cumsum(links, axis=0)])


def _wall(axis: Axes, run: Run) -> None:
    size = (SIZE[0] - run.wall_offset, 2 * SIZE[1])
    axis.add_patch(Rectangle((-SIZE[0], -SIZE[1]), *size, facecolor=WALL, edgecolor=GREY, hatch="//", lw=0, zorder=0))
    axis.axvline(-run.wall_offset, color=BLACK, lw=1.5, zorder=1)
    power = round(math.log10(WALL_STIFFNESS))
    _text(axis, f"wall, $K_f = 10^{power}$ N/m", (-(SIZE[0] + run.wall_offset) / 2, -0.8), rotation=90, boxed=True)


def _arm(axis: Axes, q: np.ndarray, colour: str) -> None:
    points = _joints(q)
    axis.plot(*points.T, "-", color=colour, lw=5, solid_capstyle="round", alpha=0.6, zorder=3)
    axis.plot(*points[:-1].T, "o", color="white", mec=colour, mew=1.6, ms=9, zorder=4)
    axis.plot(*points[1:].T, "o", color=colour, ms=6, zorder=5)


def _names(axis: Axes, q: np.ndarray) -> None:
    """Names of links and point masses, on the outer side of the elbow."""
    points = _joints(q)
    outward = points[1] - (points[0] + points[2]) / 2
    outward /= np.linalg.norm(outward)
    for i, side, shift in ((0, 1, -0.2), (1, -1, -0.08)):
        middle = (points[i] + points[i + 1]) / 2
        _text(axis, f"$l_{i + 1} = {ARM.link_lengths[i]:g}$ m", middle + 0.15 * side * outward, shift=(shift, 0))
    _text(axis, f"$m_1 = {TRUE_MASSES[0]:g}$ kg", points[1] + 0.08 * outward, shift=(-0.24, 0))
    _text(axis, f"$m_2 = {TRUE_MASSES[1]:g}$ kg", points[2], shift=(0.22, -0.15))
    axis.annotate("", (0.45, 0), (0, 0), arrowprops=_arrow(BLACK), zorder=6)
    axis.annotate("", (0, 0.45), (0, 0), arrowprops=_arrow(BLACK), zorder=6)
    _text(axis, "$x_1$", (0.53, 0))
    _text(axis, "$x_2$", (-0.09, 0.42))


def _angles(axis: Axes, q: np.ndarray) -> None:
    """The joint angles, which count counterclockwise from the direction before the joint."""
    points = _joints(q)
    for joint, (before, radius) in enumerate(zip((0.0, q[0]), (0.34, 0.26), strict=True)):
        ray = np.array([math.cos(before), math.sin(before)])
        axis.plot(*np.stack([points[joint], points[joint] + 0.45 * ray]).T, ":", color=BLACK, lw=1, zorder=3)
        angles = np.linspace(before, before + q[joint], 40)
        arc = points[joint] + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        axis.plot(*arc[:-2].T, color=VERMILLION, lw=1.3, zorder=6)
        axis.annotate("", arc[-1], arc[-4], arrowprops=_arrow(VERMILLION), zorder=6)
        middle = before + q[joint] / 2
        place = points[joint] + (radius + 0.25) * np.array([math.cos(middle), math.sin(middle)])
        sign = "+" if q[joint] > 0 else "\u2212"
        _text(axis, f"$q_{joint + 1}$ = {sign}{abs(math.degrees(q[joint])):.1f}°", place, color=VERMILLION, boxed=True)


def _marks(axis: Axes, run: Run) -> None:
    """Start, direction of motion, and the points a and b."""
    axis.plot(*run.x[0], "s", color=GREEN, ms=8, zorder=7)
    here = run.x[0]
    _text(axis, f"start, end\n({here[0]:g}, {here[1]:g})", here, color=GREEN, shift=(0.22, 0.13))
    for share in (0.11, 0.3, 0.72):
        k = int(share * len(run.x_v))
        axis.annotate("", run.x_v[k + len(run.x_v) // 50], run.x_v[k], arrowprops=_arrow(BLACK), zorder=6)
    for point, name, shift in zip(run.a_and_b, "ab", (0.09, -0.09), strict=True):
        axis.plot(*point, "o", color=VERMILLION, ms=5, zorder=7)
        _text(axis, name, point, color=VERMILLION, shift=(0.08, shift))


def _force(axis: Axes, tip: np.ndarray) -> None:
    axis.annotate("", (tip[0] - 0.36, tip[1]), (tip[0], tip[1]), arrowprops=_arrow(VERMILLION) | {"lw": 2.2}, zorder=8)
    _text(axis, "$F_{ext}$", tip, color=VERMILLION, shift=(-0.28, 0.11), boxed=True)


def _segment(axis: Axes, run: Run, windows: Windows) -> None:
    """The straight segment inside of the wall, stretched, with its depth."""
    axis.apply_aspect()  # else the inset does not yet have its size
    inset = axis.inset_axes(INSET)
    near_wall(inset, run, windows, [Path(run.x_v, "virtual", BLACK, dashed=True)])
    inset.tick_params(labelsize=7.5)
    inset.set_title(stretched(inset), fontsize=8, loc="center", pad=3)
    inset.annotate("", (-run.wall_offset - run.depth, 0), (-run.wall_offset, 0), arrowprops=_arrow(BLUE))
    inset.text(-run.wall_offset + 0.1 * run.depth, 0, f"depth\n{1e3 * run.depth:.3g} mm", fontsize=8, va="center")


def _text(axis: Axes, text: str, place: Sequence[float] | np.ndarray, **look: Any) -> None:
    """Write a text at a place, m, or shifted from it; in a white box if it is asked for."""
    shift, boxed = look.pop("shift", (0, 0)), look.pop("boxed", False)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 2} if boxed else None
    axis.text(place[0] + shift[0], place[1] + shift[1], text, ha="center", va="center", zorder=9, bbox=box, **look)


def _arrow(colour: str) -> dict[str, object]:
    return {"arrowstyle": "-|>", "color": colour, "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
