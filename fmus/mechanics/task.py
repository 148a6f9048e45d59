"""Coordinates of a task: positions of the tip, m, and after them its angles, rad; and lengths of vectors of both.

A vector x = (p, phi) of positions and angles has no length of its own, since metres and radians do not add up. With a
length L, which turns radians into metres, a motion v and a force F have the norms

    |v| = | (v_p, L v_phi) |,   |F| = | (F_p, F_phi / L) |

so that |v' F| <= |v| |F| still holds. Where x is a position alone there is no L, and both are Euclidean norms.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

SPACE = 3
"""Dimensions of space."""


@dataclass(frozen=True)
class Task:
    """Number of positions and of angles among the task coordinates x, which begin with the positions.

    Attributes
    ----------
    positions
        Number of coordinates in m: 2 in the plane, 3 in space.
    angles
        Number of coordinates in rad, which may be 0.
    """

    positions: int = 2
    angles: int = 0

    @property
    def size(self) -> int:
        """Number m of task coordinates."""
        return self.positions + self.angles

    @property
    def in_space(self) -> bool:
        """Whether x is the position and the orientation of a tip in space."""
        return (self.positions, self.angles) == (SPACE, SPACE)

    def each(self, position: str, angle: str) -> Sequence[str]:
        """A text for each coordinate, such as the unit of a velocity: one for positions, another one for angles."""
        return [position] * self.positions + [angle] * self.angles


@dataclass(frozen=True)
class Metric:
    """Lengths of vectors of a task.

    Attributes
    ----------
    task
        What the coordinates are.
    L
        Length that turns radians into metres, m/rad, shape (1,); None for a task without angles.
    """

    task: Task = Task()
    L: ca.SX | None = None

    def motion(self, v: ca.SX) -> ca.SX:
        """A motion in metres alone: (v_p, L v_phi), of the shape of v, (m, k)."""
        return v if self.L is None else v * self._scales(self.L, v.shape[1])

    def force(self, F: ca.SX) -> ca.SX:
        """A force in newtons alone: (F_p, F_phi / L), of the shape of F, (m, k)."""
        return F if self.L is None else F / self._scales(self.L, F.shape[1])

    def of_newtons(self, f: ca.SX) -> ca.SX:
        """The force F whose `force` is f, N: (f_p, L f_phi), of the shape of f, (m, k)."""
        return f if self.L is None else f * self._scales(self.L, f.shape[1])

    def mobility(self, W: ca.SX) -> ca.SX:
        """A mobility tensor in 1/kg alone, shape (m, m): what gives `motion` for `force`."""
        return W if self.L is None else self.motion(self.motion(W).T).T

    def _scales(self, L: ca.SX, columns: int) -> ca.SX:
        """The factors 1 and L of the coordinates, shape (m, columns)."""
        column = ca.vertcat(ca.SX.ones(self.task.positions, 1), L * ca.SX.ones(self.task.angles, 1))
        return ca.repmat(column, 1, columns)
