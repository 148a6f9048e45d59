"""Frames and signs of the arm, drawn: joint angles, axes of the plane, wall, and the force of the tip."""

import math
from collections.abc import Sequence

from adaptimp_fmu import Drawing
from adaptimp_fmu.svg import BLUE, FAINT, GREEN, INK, RUST, SOFT, Picture, Point

_BASE = (300.0, 262.0)  # pixels
_WALL = 96.0  # pixels, where the surface of the wall on the left is
_ANGLES: dict[int, Sequence[float]] = {2: (1.22, 1.34), 3: (0.95, 0.85, 0.72)}
"""Relative joint angles of the drawing, rad."""
_LENGTHS: dict[int, Sequence[float]] = {2: (128.0, 150.0), 3: (95.0, 90.0, 100.0)}


def arm(n: int, walls: int = 1) -> Drawing:
    """Draw an arm of n joints whose tip touches the wall, with one wall or two."""
    joints = _joints(n)
    tip = joints[-1]
    picture = Picture(440, 320, f"Planar arm of {n} joints: angles, axes, wall, and the force of the tip on the wall")
    _axes(picture, joints[0])
    _wall(picture, tip)
    if walls > 1:
        _second_wall(picture)
    heading = 0.0
    for i, (begin, turn) in enumerate(zip(joints, _ANGLES[n], strict=False)):
        reach = 46.0
        ahead = (begin[0] + reach * 1.35 * math.cos(heading), begin[1] - reach * 1.35 * math.sin(heading))
        picture.line([begin, ahead], SOFT, 1.0, dashes="4 4")
        picture.arc(begin, reach, (heading, heading + turn), BLUE)
        middle = heading + turn / 2
        label = (begin[0] + 60 * math.cos(middle), begin[1] - 60 * math.sin(middle) + 5)
        picture.text(label, f"q_{i + 1}", colour=BLUE, anchor="middle")
        heading += turn
    picture.line(joints, INK, 5)
    for joint in joints[:-1]:
        picture.circle(joint, 7)
    picture.circle(tip, 4.5, fill=INK)
    picture.arrow([tip, (tip[0] - 62, tip[1])], RUST, 2.6)
    picture.text((tip[0] - 66, tip[1] - 12), "F_ext", colour=RUST, anchor="middle")
    picture.text((tip[0] + 10, tip[1] - 8), "tip x")
    x, y = joints[0]
    picture.line([(x - 20, y + 9), (x + 20, y + 9)], INK, 3)
    second = " The second wall lies below, with the normal n2." if walls > 1 else ""
    return Drawing(
        picture.svg(),
        "Frames and signs. Each angle counts counter-clockwise, q[1] from the axis x1, the others from the previous"
        " link. The normal n points into the wall, whose surface is at n.x = wall_offset. F_ext is the force of the"
        " tip on the wall; the wall pushes back with -F_ext. Gravity acts along -x2." + second,
    )


def _joints(n: int) -> list[Point]:
    """Joints and tip, pixels."""
    points, heading = [_BASE], 0.0
    for turn, length in zip(_ANGLES[n], _LENGTHS[n], strict=True):
        heading += turn
        x, y = points[-1]
        points.append((x + length * math.cos(heading), y - length * math.sin(heading)))
    shift = _WALL - 6 - points[-1][0]  # so that the tip lies a little way in the wall
    return [(x + shift, y) for x, y in points]


def _axes(picture: Picture, origin: Point) -> None:
    """Draw the axes of the plane, which begin at the base, and the direction of gravity."""
    x, y = origin
    picture.arrow([origin, (x + 150, y)], GREEN, 2)
    picture.arrow([origin, (x, y - 215)], GREEN, 2)
    picture.text((x + 158, y + 5), "x_1", colour=GREEN)
    picture.text((x + 12, y - 208), "x_2", colour=GREEN)
    picture.arrow([(x + 120, y - 150), (x + 120, y - 95)], SOFT, 1.6)
    picture.text((x + 120, y - 158), "gravity", colour=SOFT, anchor="middle", size=13)


def _wall(picture: Picture, tip: Point) -> None:
    """Draw the wall on the left with its normal, below the height of the tip."""
    picture.line([(_WALL, 20), (_WALL, 310)], INK, 2)
    for y in range(40, 310, 18):
        picture.line([(_WALL, y), (_WALL - 16, y + 12)], FAINT, 1.4)
    y = tip[1] + 90
    picture.arrow([(_WALL, y), (_WALL - 58, y)], INK, 2)
    picture.text((_WALL - 34, y - 9), "n", anchor="middle", bold=True)
    picture.text((_WALL + 10, 306), "wall", size=13, colour=SOFT)


def _second_wall(picture: Picture) -> None:
    """Draw the second wall with its normal, below the base."""
    surface = _BASE[1] + 22
    picture.line([(_WALL, surface), (420, surface)], INK, 2)
    for x in range(118, 420, 18):
        picture.line([(x, surface), (x - 12, surface + 14)], FAINT, 1.4)
    picture.arrow([(330, surface), (330, surface + 34)], INK, 2)
    picture.text((340, surface + 30), "n2", bold=True)
