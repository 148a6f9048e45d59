"""Mechanics of a serial planar arm with point masses at the ends of its links, eq. (1).

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J(q)' F_ext

Everything follows from the forward kinematics by symbolic differentiation, for any number of
joints n. Angles are relative: the absolute angle of link i is q[1] + ... + q[i], counted from the
x1 axis, counter-clockwise. Gravity acts along -x2. F_ext is the force of the tip on the
environment. Task coordinates are the position of the tip, and for some arms also the absolute angle of the last
link; F_ext then ends with a moment.

Each function is a CasADi `Function`: called with symbols it gives an expression, called with
NumPy arrays it gives numbers.

The uncertain parameters are p = (m, viscous, coulomb), shape (3 n,); the dynamics are linear in
them, so the regressor is a Jacobian (paper, III-C; Craig, "Introduction to Robotics", ch. 6).
"""

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from adaptimp_fmu import Formula, Formulas
from fmus.mechanics.task import Task

DIMENSION = 2
"""Number of coordinates of a point of the plane."""


FORMULAS = Formulas(
    "Kinematics",
    [
        Formula(
            r"x = \sum_{i=1}^{n} l_i \left( \cos\varphi_i, \; \sin\varphi_i \right)^{T}, \quad"
            r" \varphi_i = q_1 + \dots + q_i",
            "The tip is where the chain of the links ends.",
        ),
        Formula(
            r"\dot{x} = J(q)\,\dot{q}, \quad \ddot{x} = J(q)\,\ddot{q} + \dot{J}(q, \dot{q})\,\dot{q}",
            "The Jacobian leads from the joints to the tip.",
        ),
        Formula(
            r"H a + C v + g + f = Y(q, \dot{q}, v, a)\,p",
            "The dynamics are linear in the parameters p: masses, viscous and Coulomb friction.",
        ),
    ],
)


@dataclass(frozen=True)
class PlanarArm:
    """Equations of an arm with `n` joints.

    Attributes
    ----------
    n
        Number of joints, at least 1.
    pose
        Whether the task coordinates are position and angle of the tip; else they are its position.
    """

    n: int = 2
    pose: bool = False

    @property
    def task(self) -> Task:
        """Task coordinates: the position of the tip in the plane, and its angle if there is one."""
        return Task(DIMENSION, 1 if self.pose else 0)

    @cached_property
    def forward_kinematics(self) -> ca.Function:
        """Task coordinates ``x(q, l)``, m and rad, shape (m,), of joint angles (n,) rad and link lengths (n,) m."""
        q, l = self._symbols("q", "l")
        end = self._link_ends(q, l)[-1]
        x = ca.vertcat(end, ca.sum1(q)) if self.pose else end
        return ca.Function("x", [q, l], [x], ["q", "l"], ["x"])

    @cached_property
    def jacobian(self) -> ca.Function:
        """Tip Jacobian ``J(q, l)``, m/rad, of an angle without a unit, shape (m, n): dx = J dq."""
        q, l = self._symbols("q", "l")
        J = ca.jacobian(self.forward_kinematics(q, l), q)
        return ca.Function("J", [q, l], [J], ["q", "l"], ["J"])

    @cached_property
    def jacobian_rate(self) -> ca.Function:
        """Time derivative of the tip Jacobian ``dJ(q, dq, l)``, m/(rad s) or 1/s, shape (m, n)."""
        q, dq, l = self._symbols("q", "dq", "l")
        dJ = _time_derivative(self.jacobian(q, l), q, dq)
        return ca.Function("dJ", [q, dq, l], [dJ], ["q", "dq", "l"], ["dJ"])

    @cached_property
    def inertia(self) -> ca.Function:
        """Inertia matrix ``H(q, m, l)``, kg m2, shape (n, n): the Hessian of the kinetic energy.

        The end of link i moves at sum_{j <= i} l_j w_j n_j, with w_j the absolute rate and n_j the
        normal of link j. Squared through the angles between links, half of the terms of the
        squared coordinates, which cancel, do not appear.
        """
        q, dq, m, l = self._symbols("q", "dq", "m", "l")
        rates = [ca.sum1(dq[: i + 1]) for i in range(self.n)]
        energy = ca.SX(0)
        for i in range(self.n):
            for j in range(i + 1):
                for k in range(i + 1):
                    energy += 0.5 * m[i] * l[j] * l[k] * rates[j] * rates[k] * self._cosine(q, j, k)
        H = ca.hessian(energy, dq)[0]
        return ca.Function("H", [q, m, l], [H], ["q", "m", "l"], ["H"])

    @cached_property
    def coriolis(self) -> ca.Function:
        """Matrix ``C(q, dq, m, l)`` of Christoffel symbols, kg m2/s, shape (n, n).

        C_ij = sum_k (dH_ij/dq_k + dH_ik/dq_j - dH_jk/dq_i) dq_k / 2, so dH/dt - 2 C is skew.
        """
        q, dq, m, l = self._symbols("q", "dq", "m", "l")
        H = self.inertia(q, m, l)
        dH = [ca.reshape(ca.jacobian(ca.vec(H), q[k]), self.n, self.n) for k in range(self.n)]
        C = ca.SX.zeros(self.n, self.n)
        for i in range(self.n):
            for j in range(self.n):
                for k in range(self.n):
                    C[i, j] += 0.5 * (dH[k][i, j] + dH[j][i, k] - dH[i][j, k]) * dq[k]
        return ca.Function("C", [q, dq, m, l], [C], ["q", "dq", "m", "l"], ["C"])

    @cached_property
    def gravity_torque(self) -> ca.Function:
        """Torque ``g(q, m, l, gravity)``, N.m, shape (n,): gradient of the potential energy."""
        q, m, l = self._symbols("q", "m", "l")
        gravity = ca.SX.sym("gravity")
        heights = ca.vertcat(*(end[1] for end in self._link_ends(q, l)))
        g = ca.gradient(gravity * ca.dot(m, heights), q)
        return ca.Function("g", [q, m, l, gravity], [g], ["q", "m", "l", "gravity"], ["g"])

    @cached_property
    def friction_torque(self) -> ca.Function:
        """Torque ``f(dq, viscous, coulomb, coulomb_velocity)``, N.m, shape (n,).

        f = viscous dq + coulomb tanh(dq / coulomb_velocity): linear in its coefficients and
        smooth at rest; coulomb_velocity in rad/s.
        """
        dq, viscous, coulomb = self._symbols("dq", "viscous", "coulomb")
        coulomb_velocity = ca.SX.sym("coulomb_velocity")
        f = viscous * dq + coulomb * ca.tanh(dq / coulomb_velocity)
        arguments = [dq, viscous, coulomb, coulomb_velocity]
        return ca.Function("f", arguments, [f], ["dq", "viscous", "coulomb", "coulomb_velocity"], ["f"])

    @cached_property
    def inverse_dynamics(self) -> ca.Function:
        """Torque H a + C v + g + f, N.m, shape (n,), at acceleration a and velocity v.

        Arguments: q, dq, v, a (n,), p (3 n,), l (n,), gravity, coulomb_velocity. C and f are taken
        at dq, which differs from v in Slotine and Li's law.
        """
        q, dq, v, a, l = self._symbols("q", "dq", "v", "a", "l")
        p = ca.SX.sym("p", 3 * self.n)
        gravity, coulomb_velocity = ca.SX.sym("gravity"), ca.SX.sym("coulomb_velocity")
        m, viscous, coulomb = self.split(p)
        tau = (
            ca.mtimes(self.inertia(q, m, l), a)
            + ca.mtimes(self.coriolis(q, dq, m, l), v)
            + self.gravity_torque(q, m, l, gravity)
            + self.friction_torque(dq, viscous, coulomb, coulomb_velocity)
        )
        names = ["q", "dq", "v", "a", "p", "l", "gravity", "coulomb_velocity"]
        arguments = [q, dq, v, a, p, l, gravity, coulomb_velocity]
        return ca.Function("tau", arguments, [tau], names, ["tau"])

    @cached_property
    def regressor(self) -> ca.Function:
        """Joint regressor ``Y``, shape (n, 3 n): `inverse_dynamics` = Y p; same arguments but p."""
        q, dq, v, a, l = self._symbols("q", "dq", "v", "a", "l")
        p = ca.SX.sym("p", 3 * self.n)
        gravity, coulomb_velocity = ca.SX.sym("gravity"), ca.SX.sym("coulomb_velocity")
        Y = ca.jacobian(self.inverse_dynamics(q, dq, v, a, p, l, gravity, coulomb_velocity), p)
        names = ["q", "dq", "v", "a", "l", "gravity", "coulomb_velocity"]
        return ca.Function("Y", [q, dq, v, a, l, gravity, coulomb_velocity], [Y], names, ["Y"])

    def split(self, p: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """The parts of p, each of shape (n,): m kg, viscous N.m.s/rad, coulomb N.m."""
        n = self.n
        return p[:n], p[n : 2 * n], p[2 * n :]

    def _symbols(self, *names: str) -> list[ca.SX]:
        return [ca.SX.sym(name, self.n) for name in names]

    def _cosine(self, q: ca.SX, j: int, k: int) -> ca.SX:
        """Cosine of the angle between links j and k."""
        direction = ca.SX([1, 0])
        for i in range(min(j, k), max(j, k)):
            direction = _rotated(direction, q[i + 1])
        return direction[0]

    def _link_ends(self, q: ca.SX, l: ca.SX) -> list[ca.SX]:
        """Positions of the ends of the links, which are where the masses sit."""
        ends, end, direction = [], ca.SX.zeros(DIMENSION, 1), ca.SX([1, 0])
        for i in range(self.n):
            direction = _rotated(direction, q[i])
            end = end + l[i] * direction
            ends.append(end)
        return ends


def _rotated(vector: ca.SX, angle: ca.SX) -> ca.SX:
    """A vector of the plane, turned by an angle."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(c * vector[0] - s * vector[1], s * vector[0] + c * vector[1])


def _time_derivative(matrix: ca.SX, q: ca.SX, dq: ca.SX) -> ca.SX:
    """Derivative of a matrix-valued function of q along dq."""
    return ca.reshape(ca.jtimes(ca.vec(matrix), q, dq), *matrix.shape)
