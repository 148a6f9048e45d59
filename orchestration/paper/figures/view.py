"""A view of a path in space along one axis of the base, and of the wall in this view."""

import json
from dataclasses import dataclass

import numpy as np

from orchestration.paper.spatial_numbers import POSITIONS
from orchestration.results.result import Result

GAP, TIP = "plant.gap", "plant.x"
ACROSS = 1e-9  # a normal whose part along the line of sight is larger is not seen as an edge


@dataclass(frozen=True)
class View:
    """What is seen along an axis of the base.

    Attributes
    ----------
    axes
        Numbers of the axes to the right and upwards, from 0 on.
    normal, offset
        The wall is where ``normal`` times a point, shape (2,), exceeds ``offset``, m; None if no edge is seen.
    """

    axes: tuple[int, int]
    normal: np.ndarray | None = None
    offset: float = 0.0

    @staticmethod
    def of(tip: np.ndarray, wall: "tuple[np.ndarray, float] | None") -> "View":
        """Return the view along the axis along which a tip moves least; m, shape (n, 3) or more columns."""
        finite = tip[np.isfinite(tip).all(axis=1), :POSITIONS]
        least = int(np.ptp(finite, axis=0).argmin()) if len(finite) else 0
        right, up = (axis for axis in range(POSITIONS) if axis != least)
        if wall is None or abs(wall[0][least]) > ACROSS:
            return View((right, up))
        return View((right, up), wall[0][[right, up]], wall[1])

    def seen(self, points: np.ndarray) -> np.ndarray:
        """Points in the view, m, shape (n, 2)."""
        return points[:, list(self.axes)]

    def wall(self, low: np.ndarray, high: np.ndarray) -> list[tuple[float, float]]:
        """Corners of the part of a rectangle that the wall fills, m; none if there is none."""
        if self.normal is None:
            return []
        rectangle = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
        corners: list[tuple[float, float]] = []
        for begin, end in zip(rectangle, rectangle[1:] + rectangle[:1], strict=True):
            depths = [float(self.normal @ point - self.offset) for point in (begin, end)]
            if depths[0] >= 0:
                corners.append(begin)
            if depths[0] * depths[1] < 0:
                share = depths[0] / (depths[0] - depths[1])
                corners.append((begin[0] + share * (end[0] - begin[0]), begin[1] + share * (end[1] - begin[1])))
        return corners


def wall_of(result: Result) -> tuple[np.ndarray, float] | None:
    """Normal and distance of the wall of a run in space, m; None if the run does not tell."""
    start = json.loads(result.metadata.get("start", "{}")).get("plant", {})
    names = [f"wall_normal[{i}]" for i in range(1, POSITIONS + 1)]
    if GAP not in result or not all(name in start for name in names):
        return None
    normal = np.array([float(start[name]) for name in names])
    return normal, float(result[TIP][0, :POSITIONS] @ normal - result[GAP][0])
