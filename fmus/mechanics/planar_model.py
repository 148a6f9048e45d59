"""Equations of the planar arm with its lengths and the gravity given, as control laws and plants ask for them.

The parameters p = (m, viscous, coulomb) are the point masses at the ends of the links, and the friction of the joints.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmus.mechanics.algebra import gram_determinant
from fmus.mechanics.arm import ArmParameter, Demand
from fmus.mechanics.planar_arm import PlanarArm
from fmus.mechanics.task import Task

# The smallest det(J J') / (l1 + ... + ln)^4 at which the arm is not taken for singular: with two
# equal links, sin(q2) = 4e-6.
SINGULARITY = 1e-12


@dataclass(frozen=True)
class PlanarArmModel:
    """Equations of a planar arm whose lengths and gravity are given; see `fmus.mechanics.arm.ArmModel`.

    Attributes
    ----------
    l
        Link lengths, m, shape (n,).
    gravity, coulomb_velocity
        m/s2, and rad/s over which Coulomb friction changes sign.
    """

    arm: PlanarArm
    l: ca.SX
    gravity: ca.SX
    coulomb_velocity: ca.SX

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.arm.n

    @property
    def task(self) -> Task:
        """Task coordinates of the tip."""
        return self.arm.task

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are, shape (3 n,)."""
        return planar_parameters(self.n)

    def forward_kinematics(self, q: ca.SX) -> ca.SX:
        """Task coordinates x, m and rad, shape (m,)."""
        return self.arm.forward_kinematics(q, self.l)

    def jacobian(self, q: ca.SX) -> ca.SX:
        """Jacobian J, shape (m, n): dx = J dq."""
        return self.arm.jacobian(q, self.l)

    def jacobian_rate(self, q: ca.SX, dq: ca.SX) -> ca.SX:
        """Time derivative of the Jacobian, shape (m, n)."""
        return self.arm.jacobian_rate(q, dq, self.l)

    def wrench_force(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """The wrench itself, N and N.m, shape (m,): in the plane the rate of an angle is the angular velocity."""
        del q
        return wrench

    def wrench_torque(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Torques J' F of the joints, N.m, shape (n,), that hold a wrench at the tip."""
        return ca.mtimes(self.jacobian(q).T, wrench)

    def wrench_gain(self, q: ca.SX) -> ca.SX:
        """Largest |F| / |wrench|: 1."""
        del q
        return ca.SX(1)

    def inertia(self, q: ca.SX, p: ca.SX) -> ca.SX:
        """Inertia matrix H, kg m2, shape (n, n)."""
        return self.arm.inertia(q, self.arm.split(p)[0], self.l)

    def bias(self, q: ca.SX, dq: ca.SX, p: ca.SX) -> ca.SX:
        """Torque C dq + g + f, N.m, shape (n,)."""
        return self.inverse_dynamics(q, dq, dq, ca.SX.zeros(self.n, 1), p)

    def inverse_dynamics(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX, p: ca.SX) -> ca.SX:
        """Torque H a + C v + g + f, N.m, shape (n,)."""
        return self.arm.inverse_dynamics(q, dq, v, a, p, self.l, self.gravity, self.coulomb_velocity)

    def regressor(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """Regressor Y, shape (n, 3 n)."""
        return self.arm.regressor(q, dq, v, a, self.l, self.gravity, self.coulomb_velocity)

    def demands(self, q: ca.SX) -> Sequence[Demand]:
        """Demand that the arm is not singular."""
        reach = ca.sum1(self.l)
        manipulability = gram_determinant(self.jacobian(q)) / reach**4
        sentence = "The arm is singular: q is stretched or folded, det(J J') / (sum of l)^4 must exceed 1e-12"
        return [Demand(manipulability - SINGULARITY, sentence)]


class PlanarPlantModel(PlanarArmModel):
    """Equations of a planar arm as a plant, where friction that is off costs nothing."""

    def bias(self, q: ca.SX, dq: ca.SX, p: ca.SX) -> ca.SX:
        """Torque C dq + g + f, N.m, shape (n,); without Coulomb friction a joint's tanh is that of 0."""
        arm = self.arm
        m, viscous, coulomb = arm.split(p)
        none = ca.SX.zeros(arm.n, 1)
        rubbing = ca.if_else(coulomb > 0, dq, 0)
        friction = arm.friction_torque(dq, viscous, none, self.coulomb_velocity) + arm.friction_torque(
            rubbing, none, coulomb, self.coulomb_velocity
        )
        return ca.mtimes(arm.coriolis(q, dq, m, self.l), dq) + arm.gravity_torque(q, m, self.l, self.gravity) + friction


def planar_parameters(n: int) -> Sequence[ArmParameter]:
    """What the elements of p = (m, viscous, coulomb) of a planar arm are, shape (3 n,)."""
    kinds = (
        ("kg", "mass at the end of link"),
        ("N.m.s/rad", "viscous friction of joint"),
        ("N.m", "Coulomb friction of joint"),
    )
    return [ArmParameter(unit, f"{text} {i + 1}") for unit, text in kinds for i in range(n)]
