"""Rigid bodies as numbers: masses, centres of mass and moments of inertia, and where one frame stands in another.

Numbers that no body can have are refused when a `Body` is made. A body is made of mass that is nowhere negative, so

    m >= 0,   the principal moments I1, I2, I3 about the centre of mass are >= 0,   I1 + I2 >= I3

for each order of the moments (the triangle inequality). The limits themselves are allowed: a point has no moment of
inertia, and a thin rod has none about its axis.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

ROUNDING = 1e-6
"""Part of the largest principal moment by which the others may miss the conditions: files have six digits or so."""
NOTHING = 1e-15
"""kg m2, a moment that is only the rounding of turned frames: a body without moments keeps none of them exactly."""
SINGULAR = 1e-9
"""cos(pitch) of a frame that is taken for one at the singularity of its angles."""
SYMBOLS = ("m", "mc1", "mc2", "mc3", "I11", "I12", "I22", "I13", "I23", "I33")
"""The ten parameters of a body in the order of Pinocchio; the moments are about the origin of the body's frame."""
LOWER = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
"""Rows and columns of the six moments, in the order of `SYMBOLS`."""


class RobotError(ValueError):
    """A robot that cannot be, or that cannot be read; the message says where, which values, and what to do."""


@dataclass(frozen=True)
class Placement:
    """Where a frame stands in its parent: a point r of the frame is at R r + p of the parent.

    Attributes
    ----------
    rotation
        R, the rows of a rotation matrix, shape (3, 3).
    translation
        p, m, shape (3,).
    """

    rotation: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    translation: tuple[float, ...] = (0.0, 0.0, 0.0)

    @classmethod
    def of(cls, R: np.ndarray, p: np.ndarray) -> "Placement":
        """The placement of arrays R, shape (3, 3), and p, m, shape (3,).

        Elements of R below the rounding error, 4e-16, become 0. A quarter turn then costs no operation.
        """
        R = np.where(np.abs(R) < 2 * np.finfo(float).eps, 0.0, R)
        return cls(tuple(tuple(map(float, row)) for row in R), tuple(map(float, p)))

    @classmethod
    def from_rpy(cls, xyz: Sequence[float] | np.ndarray, rpy: Sequence[float] | np.ndarray) -> "Placement":
        """The placement at xyz, m, that is turned by roll, pitch and yaw, rad, about the axes of the parent."""
        (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
        R = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
        return cls.of(np.array(R), np.asarray(xyz, float))

    @property
    def R(self) -> np.ndarray:
        """Rotation matrix, shape (3, 3)."""
        return np.array(self.rotation)

    @property
    def p(self) -> np.ndarray:
        """Origin in the parent, m, shape (3,)."""
        return np.array(self.translation)

    @property
    def rpy(self) -> tuple[float, float, float]:
        """Roll, pitch and yaw, rad, that make this rotation, also at a pitch of 90 deg; the pitch is within 90 deg.

        At 90 deg roll and yaw turn about one axis. All of this turn is called yaw then.
        """
        R = self.R
        cosine = math.hypot(R[2, 1], R[2, 2])
        roll = math.atan2(R[2, 1], R[2, 2]) if cosine > SINGULAR else 0.0
        # Axis 2 of the frame with its roll taken off is (-sin yaw, cos yaw, 0), whatever the pitch is.
        axis = R[:, 1] * math.cos(roll) - R[:, 2] * math.sin(roll)
        return roll, math.atan2(-R[2, 0], cosine), math.atan2(0.0 - axis[0], axis[1])

    def __matmul__(self, other: "Placement") -> "Placement":
        """Where a frame stands in this frame's parent, if it stands at `other` in this frame."""
        return Placement.of(self.R @ other.R, self.R @ other.p + self.p)


HERE = Placement()
"""The placement of a frame that is its parent."""


@dataclass(frozen=True)
class Body:
    """A rigid body in a frame of its own.

    Attributes
    ----------
    name
        What errors call the body.
    mass
        kg.
    center
        Centre of mass, m, shape (3,).
    inertia
        I11, I12, I22, I13, I23, I33 about the centre of mass, in the axes of the frame, kg m2.
    axial_only
        Whether I33 is all that is known: the body turns about axis 3 of a frame that does not move, and gravity is
        along this axis, so that nothing else matters. The mass is 0 then, which is a convention and not a statement
        about the body.

    Raises
    ------
    RobotError
        If no body can have these numbers.
    """

    name: str
    mass: float
    center: tuple[float, ...] = (0.0, 0.0, 0.0)
    inertia: tuple[float, ...] = (0.0,) * 6
    axial_only: bool = False

    def __post_init__(self) -> None:
        """Refuse numbers that no body can have."""
        if not np.all(np.isfinite([self.mass, *self.center, *self.inertia])):
            msg = f"Body {self.name}: mass, centre and moments of inertia must be finite numbers; correct them."
            raise RobotError(msg)
        if self.mass < 0:
            msg = f"Body {self.name}: the mass is {self.mass:g} kg, but a mass is at least 0 kg; correct it."
            raise RobotError(msg)
        if self.axial_only:
            self._check_axial()
            return
        if self.mass == 0 and any(self.inertia):
            msg = (
                f"Body {self.name}: the mass is 0 kg, but the largest moment of inertia is {max(self.inertia):g} "
                "kg m2; give the body its mass, or no moments."
            )
            raise RobotError(msg)
        self._check_moments()

    @property
    def moments(self) -> np.ndarray:
        """Moments of inertia about the centre of mass, kg m2, shape (3, 3)."""
        return symmetric(self.inertia)

    @property
    def parameters(self) -> np.ndarray:
        """The ten parameters in the order of `SYMBOLS`, kg, kg m and kg m2, shape (10,)."""
        c = np.array(self.center)
        about_origin = self.moments + self.mass * (c @ c * np.eye(3) - np.outer(c, c))
        return np.array([self.mass, *(self.mass * c), *(about_origin[k] for k in LOWER)])

    def placed(self, placement: Placement) -> "Body":
        """The same body in the parent of its frame, which stands there at `placement`."""
        moments = placement.R @ self.moments @ placement.R.T
        center = placement.R @ np.array(self.center) + placement.p
        return Body(self.name, self.mass, tuple(map(float, center)), tuple(float(moments[k]) for k in LOWER))

    def _check_moments(self) -> None:
        """Refuse principal moments that are negative or break the triangle inequality."""
        low, middle, high = np.linalg.eigvalsh(self.moments)
        allowed = ROUNDING * max(high, -low) + NOTHING
        if low < -allowed:
            msg = (
                f"Body {self.name}: the principal moments of inertia about the centre of mass are {low:g}, {middle:g} "
                f"and {high:g} kg m2, but none can be negative; correct the moments, or the signs of the products of "
                "inertia."
            )
            raise RobotError(msg)
        if low + middle < high - allowed:
            msg = (
                f"Body {self.name}: the principal moments of inertia about the centre of mass are {low:g}, {middle:g} "
                f"and {high:g} kg m2, but two of them make at least the third, and {low:g} + {middle:g} = "
                f"{low + middle:g} < {high:g}; correct the moments."
            )
            raise RobotError(msg)

    def _check_axial(self) -> None:
        """Refuse anything but a positive I33 of a body of which nothing else is known."""
        *others, axial = self.inertia
        if self.mass or any(self.center) or any(others) or axial <= 0:
            msg = (
                f"Body {self.name}: with axial_only it has I33 > 0 and nothing else, but I33 is {axial:g} kg m2 and "
                f"the mass is {self.mass:g} kg; give the body all ten numbers, or I33 alone."
            )
            raise RobotError(msg)


def merged(name: str, bodies: Sequence[Body]) -> Body:
    """One rigid body of several, all of which are given in its frame; without bodies it has no mass."""
    mass = sum(body.mass for body in bodies)
    if mass == 0:
        return Body(name, 0.0)
    center = np.sum([body.mass * np.array(body.center) for body in bodies], axis=0) / mass
    moments = np.zeros((3, 3))
    for body in bodies:
        d = np.array(body.center) - center
        moments += body.moments + body.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return Body(name, mass, tuple(map(float, center)), tuple(float(moments[k]) for k in LOWER))


def symmetric(six: Sequence[float]) -> np.ndarray:
    """The symmetric matrix, shape (3, 3), of its six elements in the order of `LOWER`."""
    matrix = np.zeros((3, 3))
    for value, (row, column) in zip(six, LOWER, strict=True):
        matrix[row, column] = matrix[column, row] = value
    return matrix
