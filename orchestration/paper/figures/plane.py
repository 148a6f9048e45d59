"""Panels of the plane of motion: paths of the tip, the wall, the points a and b, and a stretched view near the wall."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from orchestration.paper.figures.run import Run
from orchestration.paper.figures.style import BLACK, GREEN, GREY, VERMILLION, WALL, legend_above, thinned
from orchestration.paper.figures.windows import Windows

INSET = (0.315, 0.27, 0.32, 0.46)  # of the panel, inside of the ellipse: left, bottom, width, height
ROOM = 0.3  # m, left free around the ellipse


@dataclass(frozen=True)
class Path:
    """A path in the plane.

    Attributes
    ----------
    points
        m, shape (n, 2).
    """

    points: np.ndarray
    label: str
    colour: str
    dashed: bool = False

    def draw(self, axis: Axes) -> None:
        """Draw the path."""
        style = "--" if self.dashed else "-"
        axis.plot(*thinned(self.points), style, color=self.colour, label=self.label)


def plane(axis: Axes, run: Run, windows: Windows, paths: Sequence[Path], title: str) -> None:
    """Draw paths in the plane, whole and, stretched, near the wall."""
    whole_plane(axis, run, paths, title)
    axis.apply_aspect()  # else the inset does not yet have its size
    inset = axis.inset_axes(INSET)
    near_wall(inset, run, windows, paths)
    inset.tick_params(labelsize=7.5)
    inset.xaxis.set_major_locator(MaxNLocator(2))
    inset.set_title(stretched(inset), fontsize=8, loc="center", pad=3)
    axis.indicate_inset_zoom(inset, edgecolor=GREY)


def whole_plane(axis: Axes, run: Run, paths: Sequence[Path], title: str) -> None:
    """Draw paths in the plane to scale, and mark the start."""
    wall(axis, run)
    for path in paths:
        path.draw(axis)
    start(axis, run)
    low, high = run.x_v.min(axis=0) - ROOM, run.x_v.max(axis=0) + ROOM
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    axis.set_aspect("equal", adjustable="box", anchor="W")
    _name_axes(axis, title)
    legend_above(axis)


def near_wall(axis: Axes, run: Run, windows: Windows, paths: Sequence[Path]) -> None:
    """Draw paths near the wall, with a scale of its own for each axis."""
    wall(axis, run)
    for path in paths:
        path.draw(axis)
    axis.set_xlim(*windows.near_x)
    axis.set_ylim(*windows.near_y)
    axis.xaxis.set_major_locator(MaxNLocator(3))
    axis.yaxis.set_major_locator(MaxNLocator(5))


def stretched(axis: Axes) -> str:
    """Says by how much the first axis is stretched against the second."""
    box = axis.get_window_extent()
    (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
    factor = (box.width / (right - left)) / (box.height / (high - low))
    return f"$x_1$ stretched {float(f'{factor:.2g}'):g} times"


def wall(axis: Axes, run: Run) -> None:
    """Draw the wall's inside, and the points a and b."""
    axis.axvspan(-10, -run.wall_offset, facecolor=WALL, lw=0, label="wall", zorder=0)
    for point, name, place in zip(run.a_and_b, "ab", ((-10, 3), (-10, -10)), strict=True):
        axis.plot(*point, "o", color=VERMILLION, ms=4, zorder=5)
        axis.annotate(name, (point[0], point[1]), textcoords="offset points", xytext=place, color=VERMILLION)


def start(axis: Axes, run: Run) -> None:
    """Mark where the tip starts, and the direction in which it moves."""
    axis.plot(*run.x[0], "s", color=GREEN, ms=6, zorder=6, label="start")
    here, there = (run.x_v[int(share * len(run.x_v))] for share in (0.10, 0.12))
    axis.annotate("", xy=there, xytext=here, arrowprops={"arrowstyle": "-|>", "color": BLACK, "lw": 1.3})


def _name_axes(axis: Axes, title: str) -> None:
    axis.set_title(title)
    axis.set_xlabel("$x_1$ (m)", labelpad=1)
    axis.set_ylabel("$x_2$ (m)", labelpad=1)
