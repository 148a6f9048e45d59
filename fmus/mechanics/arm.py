"""What plants and controllers ask of an arm, whatever its geometry.

An arm moves a tip, described by task coordinates x, with joint coordinates q. Its equations are

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J(q)' F_ext,   dx = J(q) dq

with F_ext the force of the tip on the environment. The dynamics are linear in the uncertain parameters
p = (m, viscous, coulomb), of shape (3 n,), so that torque = Y p with the regressor Y.
"""

from functools import cached_property
from typing import Protocol

import casadi as ca


class Arm(Protocol):
    """An arm of n joints.

    Each equation is a CasADi function, of symbols as well as of numbers, and is derived once, when it is first used.

    Arguments that the equations share: joint angles q rad, rates dq rad/s, link lengths l m, link masses
    m kg, each of shape (n,); gravity m/s2; coulomb_velocity rad/s, over which Coulomb friction changes sign.
    """

    @property
    def n(self) -> int:
        """Number of joints."""
        ...

    @property
    def task_size(self) -> int:
        """Number k of task coordinates; an arm with n > k is redundant."""
        ...

    forward_kinematics: cached_property[ca.Function]
    """Tip position ``x(q, l)``, m, shape (k,)."""

    jacobian: cached_property[ca.Function]
    """Tip Jacobian ``J(q, l)``, m/rad, shape (k, n)."""

    jacobian_rate: cached_property[ca.Function]
    """Time derivative ``dJ(q, dq, l)`` of the tip Jacobian, m/(rad s), shape (k, n)."""

    inertia: cached_property[ca.Function]
    """Inertia matrix ``H(q, m, l)``, kg m2, shape (n, n)."""

    coriolis: cached_property[ca.Function]
    """Matrix ``C(q, dq, m, l)`` of the Coriolis and centrifugal torque C dq, kg m2/s, shape (n, n)."""

    gravity_torque: cached_property[ca.Function]
    """Torque ``g(q, m, l, gravity)`` of the weight, N.m, shape (n,)."""

    friction_torque: cached_property[ca.Function]
    """Torque ``f(dq, viscous, coulomb, coulomb_velocity)`` of joint friction, N.m, shape (n,)."""

    inverse_dynamics: cached_property[ca.Function]
    """Torque ``H a + C v + g + f``, N.m, shape (n,), of (q, dq, v, a, p, l, gravity, coulomb_velocity)."""

    regressor: cached_property[ca.Function]
    """Regressor ``Y``, shape (n, 3 n), of (q, dq, v, a, l, gravity, coulomb_velocity)."""

    def split(self, p: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """The parts of p, each of shape (n,): m kg, viscous N.m.s/rad, coulomb N.m."""
        ...
