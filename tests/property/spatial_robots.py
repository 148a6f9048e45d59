"""Robots in space of the tests: the PUMA 560, and arms from URDF files of the package example-robot-data."""

from functools import cache

import numpy as np

from fmus.mechanics.rigid_body import Body
from fmus.robots.puma560 import PUMA
from fmus.robots.spatial_robot import SpatialRobot
from fmus.start import SpatialPath
from tests.property.robots import chain

PAYLOAD = Body("payload", 0.8, (0.01, -0.02, 0.05), (2e-3, 0.0, 2e-3, 0.0, 0.0, 1e-3))
DOWN = (np.pi, 0.0, 0.0)
"""Roll, pitch and yaw of a tip that points down."""
# An upright ellipse in front of the base, which the table cuts.
PLACES = {
    "Panda": ((0.45, 0.0, 0.3), (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785)),
    "UR5": ((0.45, 0.15, 0.3), (0.0, -1.6, 1.7, -1.7, -1.571, 0.0)),
}
"""Centre of the ellipse, m, and joint coordinates near those of the start, rad."""


@cache
def robot(name: str) -> SpatialRobot:
    """An arm by its name: PUMA, UR5 with six joints, Panda with seven."""
    if name == "PUMA":
        return PUMA
    center, near = PLACES[name]
    path = SpatialPath(
        center=center,
        plane=(np.pi, -np.pi / 2, 0.0),
        semi_axis=(0.1, 0.15),
        reference=DOWN,
        wall_normal=(0.0, 0.0, -1.0),
        wall_offset=-center[2] + 0.06,
    )
    return SpatialRobot(chain(name), near, path, PAYLOAD)
