"""A half-space bounded by a straight wall: where the wall is, and how deep a point lies in it.

The half-space is the set of points with n.x >= wall_offset. The unit normal n points into the wall, and

    gap(x) = n.x - wall_offset

is positive inside the wall and negative in front of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Model
from fmus import start
from fmus.elements import along

NORMAL_TOLERANCE = 1e-9  # by which the normal's length may miss 1


@dataclass(frozen=True)
class HalfSpace:
    """Geometry of a wall, as symbols or numbers.

    Attributes
    ----------
    normal
        Unit vector into the wall, shape (2,) in the plane, (3,) in space.
    offset
        Distance of the surface from the origin along the normal, m.
    """

    normal: ca.SX
    offset: ca.SX

    def gap(self, x: ca.SX) -> ca.SX:
        """Signed depth n.x - offset of a point x, m, shape (1,): positive inside the wall."""
        return ca.dot(self.normal, x) - self.offset

    def along_normal(self, vector: ca.SX) -> ca.SX:
        """Component n.v of a vector along the normal, in the vector's unit, shape (1,)."""
        return ca.dot(self.normal, vector)

    def along_surface(self, vector: ca.SX) -> ca.SX:
        """Component t.v of a vector of the plane along the surface, in the vector's unit, shape (1,)."""
        return ca.dot(self.tangent, vector)

    def in_surface(self, vector: ca.SX) -> ca.SX:
        """The part v - (n.v) n of a vector that lies in the surface, in the vector's unit, of the vector's shape."""
        return vector - self.along_normal(vector) * self.normal

    @property
    def tangent(self) -> ca.SX:
        """Unit vector t along the surface of a wall in the plane, shape (2,): the normal, turned by +90 degrees."""
        return ca.vertcat(-self.normal[1], self.normal[0])


def declare_half_space(
    model: Model, number: int = 1, size: int = 2, place: tuple[Sequence[float], float] | None = None
) -> HalfSpace:
    """Declare where a wall is, and demand that its normal has length 1.

    Parameters
    ----------
    number
        1 for the parameters ``wall_normal`` and ``wall_offset``, 2 for ``wall_normal2`` and ``wall_offset2`` of a
        second wall.
    size
        Number of coordinates of a point: 2 in the plane, 3 in space.
    place
        Start values of normal and offset; by default the paper's, in space parallel to x3.
    """
    end, wall = suffix(number), ordinal(number)
    direction, distance = place or ([*start.WALL_NORMALS[number], *[0.0] * (size - 2)], start.WALL_OFFSETS[number])
    normal = model.parameter(
        f"wall_normal{end}",
        direction,
        description=along(f"Component of the unit normal into the {wall}", size),
    )
    offset = model.parameter(
        f"wall_offset{end}",
        distance,
        unit="m",
        description=f"Distance of the {wall}'s surface from the origin along the normal",
    )
    miss = ca.fabs(ca.norm_2(normal) - 1)
    model.require(NORMAL_TOLERANCE - miss, f"wall_normal{end} must have length 1")
    return HalfSpace(normal, offset)


def suffix(number: int) -> str:
    """What the names of a wall's variables end with: nothing for the first wall, ``2`` for the second."""
    return "" if number == 1 else str(number)


def ordinal(number: int) -> str:
    """What a wall is called in descriptions; the first is just the wall."""
    return {1: "wall", 2: "second wall"}[number]
