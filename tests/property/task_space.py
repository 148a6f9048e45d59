"""Equations of arms in the coordinates of a task, at many states, from those of their joints; NumPy.

    H_x = J^-T H J^-1,   C_x = J^-T (C - H J^-1 dJ) J^-1

All arrays have a sample per row.
"""

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np

from tests.property.samples import EPS


def apply(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Product of a matrix and a vector at each sample."""
    return np.einsum("kij,kj->ki", matrices, vectors)


class TaskSpace(ABC):
    """Arms with as many joints as task coordinates, n = m, or more, at their states.

    Parameters p are of shape (size, r), vectors of the task of shape (size, m).
    """

    @property
    @abstractmethod
    def n(self) -> int:
        """Number of joints."""

    @property
    @abstractmethod
    def rates(self) -> np.ndarray:
        """Rates dq of the joints, shape (size, n)."""

    @property
    @abstractmethod
    def size_of_p(self) -> int:
        """Number r of parameters."""

    @cached_property
    def x(self) -> np.ndarray:
        """Task coordinates, m and rad."""
        raise NotImplementedError

    @cached_property
    def J(self) -> np.ndarray:
        """Jacobian of x, shape (size, m, n)."""
        raise NotImplementedError

    @cached_property
    def dJ(self) -> np.ndarray:
        """Rate of the Jacobian."""
        raise NotImplementedError

    @abstractmethod
    def H(self, p: np.ndarray) -> np.ndarray:
        """Inertia matrix, shape (size, n, n)."""

    @abstractmethod
    def C(self, p: np.ndarray) -> np.ndarray:
        """Coriolis matrix of Christoffel's symbols, shape (size, n, n)."""

    @abstractmethod
    def rest(self, p: np.ndarray) -> np.ndarray:
        """Torque g + f, shape (size, n)."""

    @cached_property
    def wrench_map(self) -> np.ndarray:
        """The force of a wrench in the coordinates of x, as a matrix, shape (size, m, m); in the plane the wrench."""
        m = self.J.shape[1]
        return np.broadcast_to(np.eye(m), (len(self.J), m, m))

    def in_task(self, v: np.ndarray) -> np.ndarray:
        """A vector of the task that an FMU shows, in the axes of the gains."""
        return v

    def in_base(self, v: np.ndarray) -> np.ndarray:
        """A vector of the task as an FMU takes it."""
        return v

    @property
    def dx(self) -> np.ndarray:
        """Velocity of the tip, m/s and rad/s."""
        return apply(self.J, self.rates)

    @cached_property
    def inverse(self) -> np.ndarray:
        """Inverse of J, for n = m."""
        return np.linalg.inv(self.J)

    def acceleration(self, ddq: np.ndarray) -> np.ndarray:
        """Acceleration of the tip, m/s2 and rad/s2."""
        return apply(self.J, ddq) + apply(self.dJ, self.rates)

    def H_x(self, p: np.ndarray) -> np.ndarray:
        """Inertia in task space."""
        return self.inverse.transpose(0, 2, 1) @ self.H(p) @ self.inverse

    def C_x(self, p: np.ndarray) -> np.ndarray:
        """Coriolis matrix in task space."""
        return self.inverse.transpose(0, 2, 1) @ (self.C(p) - self.H(p) @ self.inverse @ self.dJ) @ self.inverse

    def torque(self, p: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """H a + C v + g + f for rates v and accelerations a of the joints, shape (size, n)."""
        return apply(self.H(p), a) + apply(self.C(p), v) + self.rest(p)

    def force(self, p: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """H_x a + C_x v + g_x + f_x, N and N.m."""
        v_q = apply(self.inverse, v)
        a_q = apply(self.inverse, a - apply(self.dJ, v_q))
        return apply(self.inverse.transpose(0, 2, 1), self.torque(p, v_q, a_q))

    def W(self, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Regressor of `force`, shape (size, m, r): its columns are the forces at unit vectors p."""
        return np.stack([self.force(p, v, a) for p in self._units()], axis=2)

    def Y(self, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Regressor of `torque`, shape (size, n, r)."""
        return np.stack([self.torque(p, v, a) for p in self._units()], axis=2)

    def roundings(self, p: np.ndarray) -> np.ndarray:
        """Relative rounding of what is computed here: ten operations, each losing EPS cond(J)^2 cond(H)."""
        return 10 * EPS * np.linalg.cond(self.J) ** 2 * np.linalg.cond(self.H(p))

    def _units(self) -> list[np.ndarray]:
        """Unit vectors of p, each at all samples."""
        return [np.tile(row, (len(self.J), 1)) for row in np.eye(self.size_of_p)]
