"""What plants and control laws ask of an arm, whatever its geometry and the number of its joints.

An arm of n joints moves a tip, which m task coordinates x describe. Its equations are

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J(q)' F_ext,   dx = J(q) dq

with F_ext the force of the tip on the environment, in the coordinates of x: dx' F_ext is its power. The dynamics are
linear in the parameters p, of shape (r,), which a controller may not know, so that torque = Y p with the regressor Y.

What sensors and contacts give is a wrench: the force, and the moment about the tip, in the axes of the base. In the
plane, and for a task of positions alone, it is F_ext itself. For angles whose rates are no angular velocity it is not.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import casadi as ca

from fmus.mechanics.task import Task


@dataclass(frozen=True)
class ArmParameter:
    """An element of p.

    Attributes
    ----------
    unit
        Its unit, such as ``kg``.
    text
        What it is, such as ``mass at the end of link 1``.
    signed
        Whether it may be negative, as a first moment of mass may.
    place
        Row and column of the element in tables, such as ``body link2`` and ``m``; two empty texts if there is no table.
    """

    unit: str
    text: str
    signed: bool = False
    place: tuple[str, str] = ("", "")


@dataclass(frozen=True)
class Demand:
    """A condition on the configuration: `value`, shape (1,), must be positive, else `sentence` is the error message."""

    value: ca.SX
    sentence: str


class ArmModel(Protocol):
    """Equations of an arm whose known numbers, such as lengths and the gravity, are given already.

    Arguments that the equations share, as columns: joint coordinates q rad and rates dq rad/s, shape (n,); parameters
    p, shape (r,). All results are expressions. They also hold for a p that no real arm has, as an estimate may be.
    """

    @property
    def n(self) -> int:
        """Number of joints."""
        ...

    @property
    def task(self) -> Task:
        """Task coordinates, m in number; an arm with n > m is redundant."""
        ...

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are, r in number."""
        ...

    def forward_kinematics(self, q: ca.SX) -> ca.SX:
        """Task coordinates x, m and rad, shape (m,)."""
        ...

    def jacobian(self, q: ca.SX) -> ca.SX:
        """Jacobian J of the task coordinates, m/rad or without a unit, shape (m, n): dx = J dq."""
        ...

    def jacobian_rate(self, q: ca.SX, dq: ca.SX) -> ca.SX:
        """Time derivative of the Jacobian, m/(rad s) or 1/s, shape (m, n)."""
        ...

    def wrench_force(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Force F of a wrench at the tip, N and N.m, shape (m,), in the coordinates of x."""
        ...

    def wrench_torque(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Torques J' F of the joints, N.m, shape (n,), that hold a wrench at the tip."""
        ...

    def wrench_gain(self, q: ca.SX) -> ca.SX:
        """Largest |F| / |wrench|, shape (1,), with one length L in both: by how much F has larger errors."""
        ...

    def inertia(self, q: ca.SX, p: ca.SX) -> ca.SX:
        """Inertia matrix H, kg m2, shape (n, n)."""
        ...

    def bias(self, q: ca.SX, dq: ca.SX, p: ca.SX) -> ca.SX:
        """Torque C dq + g + f, N.m, shape (n,), which an arm without acceleration needs."""
        ...

    def inverse_dynamics(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX, p: ca.SX) -> ca.SX:
        """Torque H a + C(q, dq) v + g + f(dq), N.m, shape (n,), for an acceleration a rad/s2 and a rate v rad/s.

        C is that of Christoffel's symbols, with which dH/dt - 2 C is skew-symmetric.
        """
        ...

    def regressor(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """Regressor Y, shape (n, r): `inverse_dynamics` is Y p, and has no part without p."""
        ...

    def demands(self, q: ca.SX) -> Sequence[Demand]:
        """Conditions under which J has full rank; a control law checks them before it divides."""
        ...
