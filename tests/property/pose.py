"""A two-joint arm at a state, in tip space, from the closed forms of tests/reference/arm.py; NumPy.

H_x = J^-T H J^-1, C_x = J^-T (C - H J^-1 dJ) J^-1, and the regressor column by column: the dynamics are
linear in p, so column i is the force at the i-th unit vector p.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tests.property.samples import EPS
from tests.reference import arm as closed


@dataclass(frozen=True)
class Pose:
    """A two-joint arm at q, dq; arrays of shape (2,), p of shape (6,)."""

    arm: closed.Arm
    q: np.ndarray
    dq: np.ndarray

    @cached_property
    def J(self) -> np.ndarray:
        """m/rad, shape (2, 2)."""
        return closed.jacobian(self.arm, self.q)

    @cached_property
    def dJ(self) -> np.ndarray:
        """m/(rad s), shape (2, 2)."""
        return closed.jacobian_rate(self.arm, self.q, self.dq)

    @property
    def x(self) -> np.ndarray:
        """Tip position, m."""
        return np.array(closed.tip_position(self.arm, self.q))

    @property
    def dx(self) -> np.ndarray:
        """Tip velocity, m/s."""
        return self.J @ self.dq

    def acceleration(self, ddq: np.ndarray) -> np.ndarray:
        """Tip acceleration, m/s2."""
        return self.J @ ddq + self.dJ @ self.dq

    def H_x(self, p: np.ndarray) -> np.ndarray:
        """Inertia in tip space, kg, shape (2, 2)."""
        inverse = np.linalg.inv(self.J)
        return inverse.T @ closed.inertia(self.arm, p, self.q) @ inverse

    def C_x(self, p: np.ndarray) -> np.ndarray:
        """Coriolis matrix in tip space, kg/s, shape (2, 2)."""
        inverse, C = np.linalg.inv(self.J), closed.coriolis(self.arm, p, self.q, self.dq)
        return inverse.T @ (C - closed.inertia(self.arm, p, self.q) @ inverse @ self.dJ) @ inverse

    def bias_x(self, p: np.ndarray) -> np.ndarray:
        """g_x + f_x, N; friction at dq."""
        g, f = closed.gravity_torque(self.arm, p, self.q), closed.friction_torque(self.arm, p, self.dq)
        return np.linalg.solve(self.J.T, np.array(g) + np.array(f))

    def force(self, p: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """H_x a + C_x v + g_x + f_x, N."""
        return self.H_x(p) @ a + self.C_x(p) @ v + self.bias_x(p)

    def W(self, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Regressor of `force`, shape (2, 6): (13) at v = dx, a = ddx; (34) at dx_r, ddx_r."""
        return np.column_stack([self.force(unit, v, a) for unit in np.eye(6)])

    def rounding(self, p: np.ndarray) -> float:
        """Relative rounding of what is computed here: ten operations, each losing EPS cond(J)^2 cond(H)."""
        return 10 * EPS * np.linalg.cond(self.J) ** 2 * np.linalg.cond(closed.inertia(self.arm, p, self.q))
