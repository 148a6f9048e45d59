"""The virtual trajectory of a tip in space, drawn: an ellipse in its plane, cut at the wall, and the tip's axis."""

import math

import numpy as np

from adaptimp_fmu import Drawing
from adaptimp_fmu.svg import BLUE, FAINT, GREEN, INK, RUST, SOFT, Picture
from fmus.drawings.view import Labels, View, across, sampled
from fmus.mechanics.rigid_body import Placement
from fmus.start import SpatialPath

_SIZE, _MARGIN = (560.0, 380.0), 44.0  # pixels
_POINTS = 120  # of the ellipse
_SURFACE, _DEPTH = 0.55, 0.2
"""Distance from the center at which the wall is drawn at most, and depth, in half widths of the ellipse."""
_TURN = math.radians(-30.0)


def spatial_path(path: SpatialPath) -> Drawing:
    """Draw the virtual trajectory, with a wall that is near enough, and a depth large enough, to be seen."""
    picture = Picture(*_SIZE, "The virtual trajectory in space: an ellipse with a straight segment inside the wall")
    size, normal, center = max(path.semi_axis), np.array(path.wall_normal), np.array(path.center)
    R = Placement.from_rpy((0, 0, 0), path.plane).R
    axes = R[:, 0] * path.semi_axis[0], R[:, 1] * path.semi_axis[1]
    turns = 2 * np.pi * np.arange(_POINTS + 1) / _POINTS
    ellipse = center + np.outer(np.cos(turns), axes[0]) + np.outer(np.sin(turns), axes[1])
    extent = math.hypot(normal @ axes[0], normal @ axes[1])
    surface = min(path.wall_offset - normal @ center, _SURFACE * extent)
    cut = ellipse + np.outer(np.minimum(surface + _DEPTH * extent - (ellipse - center) @ normal, 0), normal)
    mark = center + surface * normal
    patch = [mark + 1.35 * size * (a * one + b * other) for one, other in [across(normal)]
             for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]  # fmt: skip
    frame = ellipse.min(axis=0) - 0.5 * size
    pointing = Placement.from_rpy((0, 0, 0), path.reference).R[:, 2] * 0.35 * size
    view = View.fitting(_TURN, [*ellipse, *patch, frame, *(frame + 0.5 * size * np.eye(3))], _SIZE, _MARGIN)

    corners = [view.at(corner) for corner in patch]
    picture.line([*corners, corners[0]], SOFT, 1.4)
    picture.line([view.at(point) for point in ellipse], FAINT, 1.6, dashes="5 4")
    picture.line([view.at(point) for point in cut], BLUE, 2.8)
    arms = [[frame, frame + 0.5 * size * axis] for axis in np.eye(3)]
    labels = Labels(picture, [sampled([view.at(point) for point in line]) for line in (cut, patch, *arms)])
    for name, axis in zip("ab", axes, strict=True):
        picture.arrow([view.at(center), view.at(center + axis)], SOFT, 1.4)
        labels.write(name, view.at(center + axis / 2), SOFT)
    for i, axis in enumerate(np.eye(3), 1):
        picture.arrow([view.at(frame), view.at(frame + 0.5 * size * axis)], GREEN, 1.8)
        labels.write(f"x_{i}", view.at(frame + 0.5 * size * axis), GREEN)
    for i in range(0, _POINTS, _POINTS // 6):
        picture.arrow([view.at(cut[i]), view.at(cut[i] + pointing)], RUST, 1.4)
    ahead = round(_POINTS / 12)
    picture.arrow([view.at(cut[ahead]), view.at(cut[ahead + 1])], BLUE, 3.4)
    picture.circle(view.at(cut[0]), 5, BLUE, BLUE)
    labels.write("t = 0", view.at(cut[0]), bold=True)
    labels.write("center", view.at(center))
    labels.write("wall", corners[0], SOFT)
    picture.circle(view.at(center), 3, INK, INK)
    return Drawing(
        picture.svg(),
        "The virtual trajectory x_v begins at the distance a from the center and runs towards the end of b, one turn in"
        " the time period; a and b are semi_axis[1] and semi_axis[2]. plane_rpy turns the axes of the base to those of"
        " the ellipse. Along the wall x_v lies at the given depth inside the wall, so that the tip is to press; the"
        " drawing shows the wall nearer and the depth larger. The short arrows are axis 3 of the tip in the reference"
        " orientation.",
    )
