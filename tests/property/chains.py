"""Planar arms whose task is position and angle of the tip, at many states, from the motion of each link's end; NumPy.

    H = sum m_i J_i' J_i,   C = sum m_i J_i' dJ_i,   g = sum m_i gravity J_i' (0, 1)

with J_i the Jacobian of the end of link i, where mass i is. For point masses this C is that of Christoffel's symbols.
Nothing here knows the code's equations. All arrays have a sample per row.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tests.property.samples import EPS


@dataclass(frozen=True)
class Chains:
    """Arms of n joints: q, dq and lengths l of shape (size, n), gravity and coulomb_velocity of shape (size,).

    Parameters p are of shape (size, 3 n), vectors of the task of shape (size, 3), matrices of shape (size, 3, 3).
    """

    q: np.ndarray
    dq: np.ndarray
    l: np.ndarray
    gravity: np.ndarray
    coulomb_velocity: np.ndarray

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.q.shape[1]

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
        return np.column_stack([(self.l * np.cos(angle)).sum(1), (self.l * np.sin(angle)).sum(1), angle[:, -1]])

    @property
    def dx(self) -> np.ndarray:
        """Velocity of the tip, m/s and rad/s."""
        return np.einsum("kij,kj->ki", self.J, self.dq)

    @cached_property
    def J(self) -> np.ndarray:
        """Jacobian of x, shape (size, 3, n)."""
        return np.concatenate([self.ends[0][:, -1], np.ones((len(self.q), 1, self.n))], axis=1)

    @cached_property
    def dJ(self) -> np.ndarray:
        """Rate of the Jacobian."""
        return np.concatenate([self.ends[1][:, -1], np.zeros((len(self.q), 1, self.n))], axis=1)

    def acceleration(self, ddq: np.ndarray) -> np.ndarray:
        """Acceleration of the tip, m/s2 and rad/s2."""
        return np.einsum("kij,kj->ki", self.J, ddq) + np.einsum("kij,kj->ki", self.dJ, self.dq)

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

    def H_x(self, p: np.ndarray) -> np.ndarray:
        """Inertia in task space."""
        inverse = np.linalg.inv(self.J)
        return inverse.transpose(0, 2, 1) @ self.H(p) @ inverse

    def C_x(self, p: np.ndarray) -> np.ndarray:
        """Coriolis matrix in task space."""
        inverse = np.linalg.inv(self.J)
        return inverse.transpose(0, 2, 1) @ (self.C(p) - self.H(p) @ inverse @ self.dJ) @ inverse

    def force(self, p: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """H_x a + C_x v + g_x + f_x, N and N.m."""
        rest = np.linalg.solve(self.J.transpose(0, 2, 1), self.rest(p)[..., None])[..., 0]
        return np.einsum("kij,kj->ki", self.H_x(p), a) + np.einsum("kij,kj->ki", self.C_x(p), v) + rest

    def W(self, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Regressor of `force`, shape (size, 3, 3 n): its columns are the forces at unit vectors p."""
        unit = np.eye(3 * self.n)
        columns = [self.force(np.tile(row, (len(self.q), 1)), v, a) for row in unit]
        return np.stack(columns, axis=2)

    def rounding(self, p: np.ndarray) -> float:
        """Relative rounding of what is computed here: ten operations, each losing EPS cond(J)^2 cond(H)."""
        return float((10 * EPS * np.linalg.cond(self.J) ** 2 * np.linalg.cond(self.H(p))).max())
