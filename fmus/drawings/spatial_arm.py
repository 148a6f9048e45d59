"""Frames and signs of an arm in space, drawn: joints with their axes, frames of base and tip, wall, and wrench."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from adaptimp_fmu import Drawing
from adaptimp_fmu.svg import BLUE, FAINT, GREEN, INK, PAPER, RUST, SOFT, Picture, Point
from fmus.drawings.view import Labels, View, across, flattened, sampled
from fmus.mechanics.spatial_arm import SpatialArm

_SIZE, _MARGIN = (600.0, 430.0), 40.0  # pixels
_TURNS = [math.radians(turn) for turn in range(-70, 75, 5)]
"""Azimuths from which an arm may be seen, rad."""
_AXIS, _FRAME, _BARREL, _PATCH = 0.20, 0.22, 0.045, 0.30
"""Lengths, in reaches of the drawn arm: of a joint's axis, of an axis of a frame, of half a joint, of half the wall."""


@dataclass(frozen=True)
class Wall:
    """A wall of a drawing: its unit normal, which points into it, shape (3,), and its distance along the normal, m."""

    normal: Sequence[float]
    offset: float


def spatial_arm(arm: SpatialArm, q: Sequence[float], wall: Wall) -> Drawing:
    """Draw an arm at the joint coordinates q, rad or m, shape (n,), seen from where most of it is seen."""
    scene = _Scene.of(arm, np.array(q), wall)
    picture = Picture(*_SIZE, f"{arm.chain.name}: joints and their axes, frames of base and tip, wall, and wrench")
    view = View.fitting(scene.best_turn(), scene.points(), _SIZE, _MARGIN)
    _draw_wall(picture, view, scene)
    labels = Labels(picture, [sampled([view.at(point) for point in line]) for line in scene.lines()])
    foot = [view.at(point) for point in scene.foot()]
    picture.line([*foot, foot[0]], INK, 1.4)
    picture.line([view.at(place) for place in scene.places], INK, 5)
    for i, (place, axis) in enumerate(zip(scene.places[1:-1], scene.axes, strict=True), 1):
        _draw_joint(picture, view, place, scene.length * axis)
        labels.write(f"q_{i}", view.at(place + scene.length * _AXIS * axis), BLUE)
    _draw_frame(picture, view, labels, (np.zeros(3), np.eye(3), scene.length * _FRAME), ["x_1", "x_2", "x_3"])
    tip = scene.places[-1]
    end = view.at(tip + scene.length * 1.75 * _FRAME * scene.normal)
    picture.arrow([view.at(tip), end], RUST, 3)
    labels.write("F_ext on the wall", end, RUST)
    _draw_frame(picture, view, labels, (tip, scene.tip_axes, scene.length * _FRAME), ["1", "2", "3"])
    picture.circle(view.at(tip), 4.5, fill=INK)
    labels.write("tip", view.at(tip), bold=True)
    labels.write("n", view.at(scene.normal_arrow()[1]), bold=True)
    labels.write("wall", view.at(scene.patch()[0]), SOFT)
    slides = " Joints that slide move along their axes." if not all(j.turns for j in arm.chain.joints) else ""
    return Drawing(
        picture.svg(),
        f"Frames and signs of {arm.chain.name}, at the start. Each joint turns about its dashed axis by the right-hand"
        f" rule; q = 0 is where the description of the arm says so.{slides} The axes x1, x2, x3 are those of the base."
        " x[1] to x[3] are the position of the tip in them. x[4] to x[6] are roll, pitch and yaw, which turn the tip"
        " from reference_rpy about the axes of the base. F_ext[1] to F_ext[3] are the force of the tip on the wall,"
        " F_ext[4] to F_ext[6] the moment about the tip, both in the axes of the base; the wall pushes back with"
        " -F_ext. The normal n points into the wall, whose surface is at n.x = wall_offset.",
    )


@dataclass(frozen=True)
class _Scene:
    """What is drawn, m, in the axes of the base.

    Attributes
    ----------
    places
        Foot of the arm, joints and tip, shape (n + 2, 3).
    axes
        Unit vectors of the joints' axes, shape (n, 3).
    tip_axes
        Rotation of the tip, shape (3, 3): its axes as columns.
    normal, mark
        Normal of the wall, and the point of its surface next to the tip, shape (3,).
    length
        Size of the arm.
    """

    places: np.ndarray
    axes: np.ndarray
    tip_axes: np.ndarray
    normal: np.ndarray
    mark: np.ndarray
    length: float

    @staticmethod
    def of(arm: SpatialArm, q: np.ndarray, wall: Wall) -> "_Scene":
        """The scene of an arm."""
        origins = np.array(arm.origins(q)).T
        R, tip = (np.array(value) for value in arm.tip_frame(q))
        J = np.array(arm.jacobian(q))
        axes = [J[3:, i] if joint.turns else J[:3, i] for i, joint in enumerate(arm.chain.joints)]
        places = np.vstack([np.zeros(3), origins, tip.ravel()])
        normal = np.array(wall.normal)
        mark = tip.ravel() + (wall.offset - normal @ tip.ravel()) * normal
        length = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
        return _Scene(places, np.array(axes), R, normal, mark, length)

    def patch(self) -> list[np.ndarray]:
        """Corners of the piece of the wall that is drawn."""
        first, second = across(self.normal)
        half = self.length * _PATCH
        return [self.mark + half * (a * first + b * second) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

    def normal_arrow(self) -> list[np.ndarray]:
        """Ends of the drawn normal, which stands near a corner of the wall."""
        begin = self.mark + 0.72 * (self.patch()[2] - self.mark)
        return [begin, begin + 0.8 * self.length * _FRAME * self.normal]

    def foot(self) -> list[np.ndarray]:
        """Corners of the plate that the arm stands on."""
        half = 0.11 * self.length
        return [half * np.array([a, b, 0.0]) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

    def lines(self) -> list[list[np.ndarray]]:
        """What labels are to leave visible."""
        tip, size = self.places[-1], self.length * _FRAME
        frames = [[origin, origin + size * axis] for origin, axes in ((tip, self.tip_axes.T), (np.zeros(3), np.eye(3)))
                  for axis in axes]  # fmt: skip
        reach = self.length * _AXIS
        joints = [[p - reach * a, p + reach * a] for p, a in zip(self.places[1:-1], self.axes, strict=True)]
        corners, foot = self.patch(), self.foot()
        edges = [[*corners, corners[0]], [*foot, foot[0]]]
        return [
            list(self.places),
            *frames,
            *joints,
            *edges,
            self.normal_arrow(),
            [tip, tip + 1.75 * size * self.normal],
        ]

    def points(self) -> list[np.ndarray]:
        """What is to fit into the picture."""
        return [point for line in self.lines() for point in line]

    def best_turn(self) -> float:
        """The azimuth from which links, axes and the wall are seen best: least of them points at the one who looks."""

        def seen(turn: float) -> float:
            lengths = [math.dist(*(flattened(turn, p) for p in line)) for line in self.lines() if len(line) == 2]
            links = [math.dist(flattened(turn, a), flattened(turn, b)) for a, b in pairwise(self.places)]
            return round(2 * sum(links) + sum(math.sqrt(length * self.length) for length in lengths), 6)

        return max(_TURNS, key=seen)


def _draw_joint(picture: Picture, view: View, place: np.ndarray, axis: np.ndarray) -> None:
    """Draw a joint as a barrel along its axis, which has the length of the arm, and the axis dashed."""
    picture.line([view.at(place - 0.6 * _AXIS * axis), view.at(place + _AXIS * axis)], BLUE, 1.2, dashes="5 4")
    ends = [view.at(place - _BARREL * axis), view.at(place + _BARREL * axis)]
    length = math.dist(*ends)
    if length < 6:
        picture.circle(view.at(place), 7)
        picture.circle(view.at(place), 1.6, fill=INK)
        return
    share = 1.5 / length
    inner = [_between(ends[0], ends[1], share), _between(ends[0], ends[1], 1 - share)]
    picture.line(ends, INK, 14)
    picture.line(inner, PAPER, 11)


def _draw_frame(
    picture: Picture, view: View, labels: Labels, frame: tuple[np.ndarray, np.ndarray, float], names: Sequence[str]
) -> None:
    """Draw the axes of a frame: its origin, m, its axes as columns, and their length, m."""
    origin, axes, length = frame
    for name, axis in zip(names, axes.T, strict=True):
        begin, end = view.at(origin), view.at(origin + length * axis)
        if math.dist(begin, end) > 6:
            picture.arrow([begin, end], GREEN, 1.8)
        labels.write(name, end, GREEN)


def _draw_wall(picture: Picture, view: View, scene: _Scene) -> None:
    """Draw a piece of the wall, hatched, and its normal."""
    corners = scene.patch()
    for i in range(1, 10):
        ends = [corners[0] + (corners[1] - corners[0]) * i / 10, corners[3] + (corners[2] - corners[3]) * i / 10]
        picture.line([view.at(point) for point in ends], FAINT, 1)
    edge = [view.at(corner) for corner in corners]
    picture.line([*edge, edge[0]], SOFT, 1.4)
    begin, end = (view.at(point) for point in scene.normal_arrow())
    picture.line([view.at(scene.places[-1]), view.at(scene.mark)], FAINT, 1.2, dashes="2 4")
    if math.dist(begin, end) > 6:
        picture.arrow([begin, end], INK, 2)


def _between(a: Point, b: Point, share: float) -> Point:
    """A point between two."""
    return a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share
