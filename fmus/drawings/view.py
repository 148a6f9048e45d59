"""Space on paper: a parallel projection of points, m, to the pixels of a picture, and labels that do not collide."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from adaptimp_fmu.svg import INK, Picture, Point

TILT = math.radians(20.0)
"""From how far above the horizon things are seen."""
CHARACTER, LINE = 7.6, 15.0
"""Size that a character of a label takes, pixels."""
AWAY = (13.0, 19.0, 27.0, 37.0)
"""Distances at which a label may stand from what it names, pixels."""


@dataclass(frozen=True)
class View:
    """A view from the azimuth `turn`, rad, and from `TILT` above, which fits points into a picture.

    Attributes
    ----------
    scale
        Pixels per metre.
    origin
        Where the origin of space is, pixels.
    """

    turn: float
    scale: float
    origin: Point

    @staticmethod
    def fitting(turn: float, points: Sequence[np.ndarray], size: Point, margin: float) -> "View":
        """The view from `turn` in which all points, m, lie in a picture of a size, with a margin, pixels."""
        right, up = flattened(turn, np.array(points))
        scale = min((size[0] - 2 * margin) / np.ptp(right), (size[1] - 2 * margin) / np.ptp(up))
        left = (size[0] - scale * np.ptp(right)) / 2 - scale * right.min()
        top = (size[1] - scale * np.ptp(up)) / 2 + scale * up.max()
        return View(turn, float(scale), (float(left), float(top)))

    def at(self, point: np.ndarray) -> Point:
        """Pixels of a point, m, shape (3,)."""
        right, up = flattened(self.turn, point)
        return float(self.origin[0] + self.scale * right), float(self.origin[1] - self.scale * up)


def flattened(turn: float, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far to the right and up points of space are seen, m, for points of shape (..., 3)."""
    x, y, z = np.moveaxis(points, -1, 0)
    ahead = -x * math.sin(turn) + y * math.cos(turn)
    return x * math.cos(turn) + y * math.sin(turn), z * math.cos(TILT) + ahead * math.sin(TILT)


@dataclass
class Labels:
    """Labels of a picture: each stands beside its point where it hides the fewest lines and no other label.

    Attributes
    ----------
    lines
        Lines to stay clear of, pixels.
    """

    picture: Picture
    lines: Sequence[Sequence[Point]]
    _boxes: list[tuple[float, float, float, float]] = field(default_factory=list)

    def write(self, text: str, beside: Point, colour: str = INK, *, bold: bool = False) -> None:
        """Write a text beside a point."""
        width = CHARACTER * len(text.replace("_", ""))
        boxes = [self._box(beside, angle, away, width) for away in AWAY for angle in range(0, 360, 30)]
        best = min(boxes, key=lambda box: (round(self._cost(box), 6), math.dist(beside, _middle(box))))
        self._boxes.append(best)
        x, y = _middle(best)
        self.picture.text((x, y + 5), text, anchor="middle", colour=colour, size=13, bold=bold)

    def _box(self, beside: Point, angle: int, away: float, width: float) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of a label that begins at a distance from its point, in a direction, deg."""
        cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        x = beside[0] + (away + width / 2 - 6) * cosine
        y = beside[1] - away * sine
        return x - width / 2, y - LINE / 2, x + width / 2, y + LINE / 2

    def _cost(self, box: tuple[float, float, float, float]) -> float:
        """How much a label in a box would hide: labels count most, then the edge of the picture, then lines."""
        left, top, right, bottom = box
        outside = left < 4 or top < 4 or right > self.picture.width - 4 or bottom > self.picture.height - 4
        hidden = sum(left < r and l < right and top < b and t < bottom for l, t, r, b in self._boxes)
        crossed = sum(left - 3 < x < right + 3 and top - 2 < y < bottom + 2 for line in self.lines for x, y in line)
        return 1000.0 * hidden + 500.0 * outside + crossed


def across(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors at right angles to a normal and to each other, along the axes of the base where that can be."""
    near = np.eye(3)[int(np.argmin(np.abs(np.round(normal, 6))))]
    first = np.cross(normal, near)
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def sampled(line: Sequence[Point], spacing: float = 4.0) -> list[Point]:
    """Points along a line through points, at most a spacing apart, pixels."""
    found = []
    for (x0, y0), (x1, y1) in pairwise(line):
        steps = max(1, math.ceil(math.dist((x0, y0), (x1, y1)) / spacing))
        found += [(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps) for i in range(steps + 1)]
    return found


def _middle(box: tuple[float, float, float, float]) -> Point:
    """Middle of a box."""
    return (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
