"""Where the ellipse of section V meets the wall."""

import math

import numpy as np

from orchestration.paper.numbers import SEMI_AXIS, WALL_OFFSET


def wall_points(wall_offset: float = WALL_OFFSET) -> tuple[np.ndarray, np.ndarray]:
    """The points a and b at which the ellipse meets the wall and leaves it, m."""
    height = SEMI_AXIS[1] * math.sqrt(1 - (wall_offset / SEMI_AXIS[0]) ** 2)
    return np.array([-wall_offset, height]), np.array([-wall_offset, -height])
