"""Planar arms whose task is the tip's position and angle, or position alone, from the motion of each link's end; NumPy.

    H = sum m_i J_i' J_i,   C = sum m_i J_i' dJ_i,   g = sum m_i gravity J_i' (0, 1)

with J_i the Jacobian of the end of link i, where mass i is. For point masses this C is that of Christoffel's symbols.
Nothing here knows the code's equations. All arrays have a sample per row.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tests.property.task_space import TaskSpace


@dataclass(frozen=True)
class Chains(TaskSpace):
    """Arms of n joints: q, dq and lengths l of shape (size, n), gravity and coulomb_velocity of shape (size,).

    Parameters p are of shape (size, 3 n). With `angle` the task has three coordinates, else the position alone.
    """

    q: np.ndarray
    dq: np.ndarray
    l: np.ndarray
    gravity: np.ndarray
    coulomb_velocity: np.ndarray
    angle: bool = True

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.q.shape[1]

    @property
    def rates(self) -> np.ndarray:
        """Rates of the joints, rad/s."""
        return self.dq

    @property
    def size_of_p(self) -> int:
        """Three for each joint."""
        return 3 * self.n

    @cached_property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Jacobians of the links' ends and their rates, shape (size, n, 2, n)."""
        angle, w = np.cumsum(self.q, axis=1), np.cumsum(self.dq, axis=1)
        along = self.l[:, None] * np.stack([-np.sin(angle), np.cos(angle)], axis=1)
        rate = (self.l * w)[:, None] * np.stack([-np.cos(angle), -np.sin(angle)], axis=1)
        J, dJ = (np.zeros((len(self.q), self.n, 2, self.n)) for _ in range(2))
        for i in range(self.n):
            for j in range(i + 1):  # joint j moves end i through links j to i
                J[:, i, :, j] = along[:, :, j : i + 1].sum(axis=2)
                dJ[:, i, :, j] = rate[:, :, j : i + 1].sum(axis=2)
        return J, dJ

    @cached_property
    def x(self) -> np.ndarray:
        """Position m and angle rad of the tip."""
        angle = np.cumsum(self.q, axis=1)
        x = np.column_stack([(self.l * np.cos(angle)).sum(1), (self.l * np.sin(angle)).sum(1), angle[:, -1]])
        return x if self.angle else x[:, :2]

    @cached_property
    def J(self) -> np.ndarray:
        """Jacobian of x, shape (size, 3, n)."""
        return self._with_angle(self.ends[0][:, -1], 1.0)

    @cached_property
    def dJ(self) -> np.ndarray:
        """Rate of the Jacobian."""
        return self._with_angle(self.ends[1][:, -1], 0.0)

    def H(self, p: np.ndarray) -> np.ndarray:
        """Inertia matrix, kg.m2."""
        return np.einsum("ke,keij,keil->kjl", p[:, : self.n], self.ends[0], self.ends[0])

    def C(self, p: np.ndarray) -> np.ndarray:
        """Coriolis matrix, kg.m2/s."""
        return np.einsum("ke,keij,keil->kjl", p[:, : self.n], *self.ends)

    def rest(self, p: np.ndarray) -> np.ndarray:
        """Torque g + f, N.m, shape (size, n)."""
        n = self.n
        g = self.gravity[:, None] * np.einsum("ke,kej->kj", p[:, :n], self.ends[0][:, :, 1])
        slide = np.tanh(self.dq / self.coulomb_velocity[:, None])
        return g + p[:, n : 2 * n] * self.dq + p[:, 2 * n :] * slide

    def _with_angle(self, rows: np.ndarray, of_angle: float) -> np.ndarray:
        """The rows of the position, and below them the row of the angle if it is a coordinate."""
        below = np.full((len(self.q), 1, self.n), of_angle)
        return np.concatenate([rows, below], axis=1) if self.angle else rows
