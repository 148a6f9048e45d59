"""Draws a run of a planar arm as a moving picture: the arm against the wall, beside the force and the torques.

The file is an animated WebP or GIF. A picture shows all rows at an even pace, and shows the same run as the same bytes.
The lengths of the links are not recorded, so they are those that explain best where the tip is::

    x = l_1 u(q_1) + l_2 u(q_1 + q_2) + ...        u(a) = (cos a, sin a)
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch
from PIL import Image

from adaptimp_fmu.files.whole_file import whole_file
from orchestration.errors import OrchestrationError
from orchestration.paper.figures.overlay import COMMANDED, FORCE, GAP, TIP, Overlay, draw_forces, draw_torques
from orchestration.paper.figures.phases import phases
from orchestration.paper.figures.plane import ROOM
from orchestration.paper.figures.style import thinned
from orchestration.paper.figures.theme import Theme
from orchestration.paper.measure import norms
from orchestration.paper.numbers import WALL_NORMAL
from orchestration.results.picture_file import MOVING
from orchestration.results.result import Result

JOINTS = "plant.q"
PICTURES, SECONDS = 100, 5.0  # of a moving picture, and how long it takes
SIZE, DOTS = (9.0, 4.4), 90  # in, and pixels per inch
USUAL_ARROW, LONGEST_ARROW = 0.35, 0.7  # m in the picture, of the median force of the contact, and of any force
NOT_PLANAR = 1e-6  # m: a planar arm misses its tip by rounding only


@dataclass(frozen=True)
class _Moving:
    """What changes from picture to picture.

    Attributes
    ----------
    arm
        The links.
    trace
        Path of the tip until now.
    force
        Arrow of the contact force, which ends at the tip.
    cursors
        Lines at the present time.
    newton_per_metre
        Scale of the arrow.
    """

    arm: Line2D
    trace: Line2D
    force: FancyArrowPatch
    cursors: Sequence[Line2D]
    newton_per_metre: float

    @property
    def artists(self) -> tuple[Artist, ...]:
        """All of them, the lowest one first."""
        return (self.trace, self.arm, self.force, *self.cursors)


def moving_picture(label: str, result: Result, theme: Theme, path: Path) -> None:
    """Write the run of a planar arm as an animated file.

    Parameters
    ----------
    label
        Name of the run, for the title and for errors.
    path
        File with a suffix of `orchestration.results.picture_file.MOVING`.

    Raises
    ------
    OrchestrationError
        If the run lacks a column, if its arm is not planar, or if the file cannot be written.
    """
    joints = joint_positions(label, result)
    rows = np.linspace(0, len(result.time) - 1, min(PICTURES, len(result.time))).astype(int)
    figure, moving = _still(label, result, joints, theme)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    pictures = []
    for row in rows:
        canvas.restore_region(still)
        _show(moving, result, joints, row)
        pictures.append(Image.frombytes("RGBA", canvas.get_width_height(), canvas.buffer_rgba()).convert("RGB"))
    options = MOVING[path.suffix.lower()] | {"duration": round(1e3 * SECONDS / PICTURES), "loop": 0}
    try:
        with whole_file(path) as file:
            first, *others = pictures
            first.save(file, format=path.suffix[1:].upper(), save_all=True, append_images=others, **options)
    except OSError as reason:
        msg = f"{path}: the moving picture cannot be written: {reason.strerror or reason}; choose another place."
        raise OrchestrationError(msg) from reason


def joint_positions(label: str, result: Result) -> np.ndarray:
    """Return the positions of base, joints and tip, m, shape (n_rows, n_joints + 1, 2).

    Raises
    ------
    OrchestrationError
        If the run lacks the angles of the joints or the position of the tip, or if no lengths of links explain both.
    """
    lacking = [name for name in (JOINTS, TIP, FORCE) if name not in result]
    if lacking:
        msg = (
            f"{label}: a moving picture shows an arm, and needs {', '.join(lacking)}; record all columns of the plant."
        )
        raise OrchestrationError(msg)
    if result[TIP].shape[1:] != (2,) or not np.isfinite(np.hstack([result[JOINTS], result[TIP]])).all():
        found = f"{TIP} has {result[TIP].shape[1]} elements" if result[TIP].shape[1:] != (2,) else "a row is not finite"
        msg = f"{label}: a moving picture shows an arm in the plane, and {found}; choose .png or .svg."
        raise OrchestrationError(msg)
    angles = np.cumsum(result[JOINTS], axis=1)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=2)
    tip = result[TIP]
    equations = directions.transpose(0, 2, 1).reshape(-1, angles.shape[1])
    lengths = np.linalg.lstsq(equations, tip.reshape(-1), rcond=None)[0]
    joints = np.concatenate([np.zeros((len(tip), 1, 2)), np.cumsum(directions * lengths[:, None], axis=1)], axis=1)
    missed = float(np.max(np.abs(joints[:, -1] - tip), initial=0.0))
    if not missed <= NOT_PLANAR:
        msg = (
            f"{label}: no lengths of links lead from {JOINTS} to {TIP}, which is missed by {missed:.3g} m;"
            " a moving picture shows planar arms with rotating joints, so choose .png or .svg."
        )
        raise OrchestrationError(msg)
    return joints


def _still(label: str, result: Result, joints: np.ndarray, theme: Theme) -> tuple[Figure, _Moving]:
    """All that does not move, and the parts that do."""
    figure = Figure(figsize=SIZE, dpi=DOTS)
    grid = figure.add_gridspec(
        2, 2, width_ratios=(1.15, 1), left=0.075, right=0.97, bottom=0.115, top=0.85, wspace=0.2, hspace=0.75
    )
    figure.suptitle(label, x=0.01, y=0.985, ha="left", va="top", fontsize=12)
    plane = figure.add_subplot(grid[:, 0])
    over_time = [figure.add_subplot(grid[row, 1]) for row in (0, 1)]
    drawn = Overlay({label: result}, theme, [phases(result)])
    draw_forces(over_time[0], drawn, "Contact force")
    draw_torques(over_time[1], drawn, "")
    cursors = [axis.axvline(0.0, color=theme.ink, lw=1.0) for axis in over_time]
    forces = norms(result[FORCE])
    usual = float(np.median(forces[forces > 0])) if np.any(forces > 0) else 1.0
    moving = _Moving(*_plane(plane, result, joints, theme), cursors, usual / USUAL_ARROW)
    for artist in moving.artists:
        artist.set_animated(True)
    return figure, moving


def _plane(axis: Axes, result: Result, joints: np.ndarray, theme: Theme) -> tuple[Line2D, Line2D, FancyArrowPatch]:
    """The plane of motion with wall and virtual trajectory; arm, trace and arrow are empty."""
    points = [joints.reshape(-1, 2)]
    if COMMANDED in result:
        points.append(result[COMMANDED])
        axis.plot(*thinned(result[COMMANDED]), "--", color=theme.ink, lw=1.0, label="virtual trajectory")
    whole = np.concatenate(points)
    low, high = whole.min(axis=0) - ROOM, whole.max(axis=0) + ROOM
    if GAP in result:
        offset = float(result[TIP][0] @ np.array(WALL_NORMAL) - result[GAP][0])
        axis.axvspan(-10, -offset, facecolor=theme.wall, lw=0, zorder=0, label="wall")
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="$x_1$ (m)", ylabel="$x_2$ (m)")
    axis.set_aspect("equal", adjustable="box")
    axis.set_title("Arm, to scale")
    (trace,) = axis.plot([], [], color=theme.curves[2], lw=1.6, label="tip")
    (arm,) = axis.plot(
        [], [], "o-", color=theme.curves[0], lw=5, ms=8, mfc=theme.paper, mew=1.8, solid_capstyle="round", zorder=4
    )
    force = FancyArrowPatch(
        (0, 0),
        (0, 0),
        arrowstyle="-|>",
        mutation_scale=14,
        shrinkA=0,
        shrinkB=0,
        color=theme.curves[1],
        lw=2.4,
        zorder=6,
    )
    axis.add_patch(force)
    axis.plot([], [], color=theme.curves[1], lw=2.4, label="force on the wall")
    axis.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4, fontsize=8.5)
    return arm, trace, force


def _show(moving: _Moving, result: Result, joints: np.ndarray, row: int) -> None:
    """Draw the parts that move as they are in a row."""
    tip = result[TIP][row]
    arrow = result[FORCE][row] / moving.newton_per_metre
    arrow *= min(1.0, LONGEST_ARROW / max(float(np.linalg.norm(arrow)), LONGEST_ARROW))
    moving.arm.set_data(*joints[row].T)
    moving.trace.set_data(*thinned(result[TIP][: row + 1]))
    moving.force.set_visible(bool(np.any(arrow)))
    moving.force.set_positions(tip - arrow, tip)
    for cursor in moving.cursors:
        cursor.set_xdata([result.time[row]] * 2)
    for artist in moving.artists:
        if artist.axes is not None:
            artist.axes.draw_artist(artist)
