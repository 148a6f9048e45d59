"""A task in space whose axes are not those of the base: the same arm, in coordinates that are turned.

Gains of the laws are diagonal, along the axes of the task. A frame R_c that is turned from the base gives them other
axes. With T = diag(R_c, R_c) the coordinates, the Jacobian and the forces in that frame are

    x_c = T' x,   J_c = T' J,   F_c = T' F

This is a change of coordinates of the task, dx_c = J_c dq and dx_c' F_c = dx' F, so that every equation of the paper
holds word for word. A stiffness K along the axes of the frame is the matrix T K T' in the axes of the base. The angles
phi turn in the same way: near phi = 0, where they are small rotations about the axes of the base, their turned values
are small rotations about the axes of the frame. Roll, pitch and yaw, 1, 2 and 3, are then about axes 1, 2 and 3.

Norms with one length L are the same in both coordinates.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmus.mechanics.arm import ArmModel, ArmParameter, Demand
from fmus.mechanics.task import Task


@dataclass(frozen=True)
class TurnedTask:
    """An arm in turned coordinates of its task; see `fmus.mechanics.arm.ArmModel`.

    Attributes
    ----------
    arm
        The arm, whose task is position and orientation in space.
    R
        Axes of the frame in those of the base, shape (3, 3).
    """

    arm: ArmModel
    R: ca.SX

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.arm.n

    @property
    def task(self) -> Task:
        """Task coordinates: as many as before the turn."""
        return self.arm.task

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are."""
        return self.arm.parameters

    def in_task(self, v: ca.SX) -> ca.SX:
        """Turn coordinates or a force, T' v, of the shape of v, (6, k): from the axes of the base to the frame."""
        return _blocks(self.R.T, v)

    def in_base(self, v: ca.SX) -> ca.SX:
        """Turn coordinates or a force back, T v, of the shape of v, (6, k)."""
        return _blocks(self.R, v)

    def forward_kinematics(self, q: ca.SX) -> ca.SX:
        """Turned coordinates x_c, m and rad, shape (6,)."""
        return self.in_task(self.arm.forward_kinematics(q))

    def jacobian(self, q: ca.SX) -> ca.SX:
        """Jacobian J_c of the turned coordinates, shape (6, n)."""
        return self.in_task(self.arm.jacobian(q))

    def jacobian_rate(self, q: ca.SX, dq: ca.SX) -> ca.SX:
        """Time derivative of J_c, shape (6, n): the frame does not move."""
        return self.in_task(self.arm.jacobian_rate(q, dq))

    def wrench_force(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Force F_c, N and N.m, shape (6,), of a wrench at the tip in the axes of the base."""
        return self.in_task(self.arm.wrench_force(q, wrench))

    def wrench_torque(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Torques of the joints, N.m, shape (n,), that hold a wrench at the tip in the axes of the base."""
        return self.arm.wrench_torque(q, wrench)

    def wrench_gain(self, q: ca.SX) -> ca.SX:
        """Largest |F_c| / |wrench|, shape (1,)."""
        return self.arm.wrench_gain(q)

    def inertia(self, q: ca.SX, p: ca.SX) -> ca.SX:
        """Inertia matrix H, kg m2, shape (n, n)."""
        return self.arm.inertia(q, p)

    def bias(self, q: ca.SX, dq: ca.SX, p: ca.SX) -> ca.SX:
        """Torque C dq + g + f, N.m, shape (n,)."""
        return self.arm.bias(q, dq, p)

    def inverse_dynamics(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX, p: ca.SX) -> ca.SX:
        """Torque H a + C v + g + f, N.m, shape (n,)."""
        return self.arm.inverse_dynamics(q, dq, v, a, p)

    def regressor(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """Regressor Y, shape (n, r)."""
        return self.arm.regressor(q, dq, v, a)

    def demands(self, q: ca.SX) -> Sequence[Demand]:
        """Demands of the arm: a turn of the task makes nothing singular."""
        return self.arm.demands(q)


def _blocks(R: ca.SX, v: ca.SX) -> ca.SX:
    """The product diag(R, R) v of a rotation, shape (3, 3), and v, shape (6, k)."""
    return ca.vertcat(ca.mtimes(R, v[:3, :]), ca.mtimes(R, v[3:, :]))
