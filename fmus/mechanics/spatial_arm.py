"""Mechanics of a serial arm in space, eq. (1), from the numbers of a `fmus.mechanics.chain.Chain`.

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J(q)' F_ext

Positions, Jacobian and wrench are in the axes of the base, at the tip. The Jacobian is the geometric one: J dq is the
velocity of the tip, m/s, above the angular velocity of its frame, rad/s. F_ext is the wrench (force, N, above moment,
N.m) of the tip on the environment. For roll, pitch and yaw as coordinates see `fmus.mechanics.orientation`.

The parameters p of the dynamics, shape (13 n,), are those of `Chain.p`: ten of each body, then the viscous friction,
the Coulomb friction and the rotor inertia of the joints. The dynamics are linear in them (C. Atkeson, C. An,
J. Hollerbach, "Estimation of inertial parameters of manipulator loads and links", IJRR 5(3), 1986).

Each function is a CasADi `Function`: called with symbols it gives an expression, called with NumPy arrays it gives
numbers. Units are those of turning joints; for prismatic joints read m, m/s, N and kg.
"""

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from adaptimp_fmu import Formula, Formulas
from fmus.mechanics.algebra import solve_spd
from fmus.mechanics.chain import Chain
from fmus.mechanics.recursions import TEN, composite_inertia, joint_frame, newton_euler

FORMULAS = Formulas(
    "Arm in space",
    [
        Formula(
            r"J(q)\,\dot{q} = (v, \; \omega), \quad F_{\text{ext}} = (f, \; m)",
            "Velocity and angular velocity of the tip, and the force and moment with which the tip acts on the"
            " environment, are in the axes of the base. J is the geometric Jacobian, and the moment is about the tip.",
        ),
        Formula(
            r"H(q)\,a + C(q, \dot{q})\,v + g(q) + f(\dot{q}) = Y(q, \dot{q}, v, a)\,p",
            "The torques are linear in the parameters p: ten of each body, and two of friction and the inertia of the"
            " rotor of each joint. Y is the regressor, and v need not be the rate of the joints.",
        ),
        Formula(
            r"\dot{H} - 2 C = -(\dot{H} - 2 C)^{T}",
            "C is that of Christoffel's symbols, on which the proof of algorithm 2 rests.",
        ),
    ],
)
PER_JOINT = TEN + 3
"""Parameters for each joint: ten of its body, viscous and Coulomb friction, rotor inertia."""
SPACE = 3


@dataclass(frozen=True)
class SpatialArm:
    """Equations of a chain of rigid bodies.

    Attributes
    ----------
    chain
        Joints, frames and bodies. Frames are numbers in the equations; masses, inertias and friction are not used.
    """

    chain: Chain

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.chain.n

    @cached_property
    def tip_frame(self) -> ca.Function:
        """Tip frame ``R(q), position(q)``: rotation matrix, shape (3, 3), and position m, shape (3,)."""
        (q,) = self._symbols("q")
        R, position = self._frames(q)[-1]
        return self._function("tip_frame", [q], [R, position], ["q"], ["R", "position"])

    @cached_property
    def origins(self) -> ca.Function:
        """Origins ``places(q)`` of the frames of the joints, m, shape (3, n)."""
        (q,) = self._symbols("q")
        places = [position for _, position in self._frames(q)[:-1]]
        return self._function("origins", [q], [ca.densify(ca.horzcat(*places))], ["q"], ["places"])

    @cached_property
    def jacobian(self) -> ca.Function:
        """Geometric Jacobian ``J(q)`` of the tip, m/rad above rad/rad, shape (6, n)."""
        (q,) = self._symbols("q")
        frames = self._frames(q)
        tip = frames[-1][1]
        columns = []
        for joint, (R, origin) in zip(self.chain.joints, frames[:-1], strict=True):
            z = R @ ca.DM(joint.axis)
            turning = ca.vertcat(ca.cross(z, tip - origin), z)
            columns.append(turning if joint.turns else ca.vertcat(z, ca.SX(SPACE, 1)))
        return self._function("J", [q], [ca.densify(ca.horzcat(*columns))], ["q"], ["J"])

    @cached_property
    def jacobian_rate(self) -> ca.Function:
        """Time derivative ``dJ(q, dq)`` of the geometric Jacobian, shape (6, n)."""
        q, dq = self._symbols("q", "dq")
        J = self.jacobian(q)
        dJ = ca.reshape(ca.jtimes(ca.vec(J), q, dq), *J.shape)
        return self._function("dJ", [q, dq], [ca.densify(dJ)], ["q", "dq"], ["dJ"])

    @cached_property
    def inertia(self) -> ca.Function:
        """Inertia matrix ``H(q, p)``, kg m2, shape (n, n), with the rotors on its diagonal."""
        (q,), p = self._symbols("q"), self._p
        H = composite_inertia(self.chain, q, p) + ca.diag(self.split(p)[3])
        return self._function("H", [q, p], [ca.densify(H)], ["q", "p"], ["H"])

    @cached_property
    def coriolis(self) -> ca.Function:
        """Matrix ``C(q, dq, p)`` of Christoffel's symbols, kg m2/s, shape (n, n): dH/dt - 2 C is skew-symmetric."""
        (q, dq, v), p = self._symbols("q", "dq", "v"), self._p
        torque = newton_euler(self.chain, (q, dq, v), ca.SX(self.n, 1), p, ca.SX(SPACE, 1))
        C = ca.jacobian(torque, v)
        return self._function("C", [q, dq, p], [ca.densify(C)], ["q", "dq", "p"], ["C"])

    @cached_property
    def gravity_torque(self) -> ca.Function:
        """Torque ``g(q, p, gravity)`` of the weight, N.m, shape (n,); gravity in the axes of the base, m/s2, (3,)."""
        (q,), p, gravity = self._symbols("q"), self._p, ca.SX.sym("gravity", SPACE)
        rest = ca.SX(self.n, 1)
        g = newton_euler(self.chain, (q, rest), rest, p, gravity)
        return self._function("g", [q, p, gravity], [ca.densify(g)], ["q", "p", "gravity"], ["g"])

    @cached_property
    def friction_torque(self) -> ca.Function:
        """Torque ``f(dq, p, coulomb_velocity)`` of joint friction, N.m, shape (n,).

        f = viscous dq + coulomb tanh(dq / coulomb_velocity): linear in its coefficients and smooth at rest;
        coulomb_velocity in rad/s.
        """
        (dq,), p, coulomb_velocity = self._symbols("dq"), self._p, ca.SX.sym("coulomb_velocity")
        _, viscous, coulomb, _ = self.split(p)
        f = viscous * dq + coulomb * ca.tanh(dq / coulomb_velocity)
        return self._function("f", [dq, p, coulomb_velocity], [f], ["dq", "p", "coulomb_velocity"], ["f"])

    @cached_property
    def bias(self) -> ca.Function:
        """Torque ``C dq + g + f``, N.m, shape (n,), of (q, dq, p, gravity, coulomb_velocity)."""
        (q, dq), p = self._symbols("q", "dq"), self._p
        gravity, coulomb_velocity = ca.SX.sym("gravity", SPACE), ca.SX.sym("coulomb_velocity")
        tau = newton_euler(self.chain, (q, dq), ca.SX(self.n, 1), p, gravity)
        tau += self.friction_torque(dq, p, coulomb_velocity)
        names = ["q", "dq", "p", "gravity", "coulomb_velocity"]
        return self._function("bias", [q, dq, p, gravity, coulomb_velocity], [tau], names, ["bias"])

    @cached_property
    def inverse_dynamics(self) -> ca.Function:
        """Torque H a + C v + g + f, N.m, shape (n,), at acceleration a and velocity v.

        Arguments: q, dq, v, a (n,), p (13 n,), gravity (3,), coulomb_velocity. C and f are taken at dq, which differs
        from v in Slotine and Li's law; C is that of `coriolis`.
        """
        (q, dq, v, a), p = self._symbols("q", "dq", "v", "a"), self._p
        gravity, coulomb_velocity = ca.SX.sym("gravity", SPACE), ca.SX.sym("coulomb_velocity")
        tau = newton_euler(self.chain, (q, dq, v), a, p, gravity) + self.split(p)[3] * a
        tau += self.friction_torque(dq, p, coulomb_velocity)
        names = ["q", "dq", "v", "a", "p", "gravity", "coulomb_velocity"]
        return self._function("tau", [q, dq, v, a, p, gravity, coulomb_velocity], [tau], names, ["tau"])

    @cached_property
    def regressor(self) -> ca.Function:
        """Joint regressor ``Y``, shape (n, 13 n): `inverse_dynamics` = Y p; same arguments but p."""
        (q, dq, v, a), p = self._symbols("q", "dq", "v", "a"), self._p
        gravity, coulomb_velocity = ca.SX.sym("gravity", SPACE), ca.SX.sym("coulomb_velocity")
        Y = ca.jacobian(self.inverse_dynamics(q, dq, v, a, p, gravity, coulomb_velocity), p)
        names = ["q", "dq", "v", "a", "gravity", "coulomb_velocity"]
        return self._function("Y", [q, dq, v, a, gravity, coulomb_velocity], [ca.densify(Y)], names, ["Y"])

    @cached_property
    def acceleration(self) -> ca.Function:
        """Acceleration ``ddq``, rad/s2, shape (n,), of (q, dq, tau, p, gravity, coulomb_velocity).

        tau, N.m, shape (n,), is the sum of the torques on the joints: the motors' and -J' F_ext.
        """
        (q, dq, tau), p = self._symbols("q", "dq", "tau"), self._p
        gravity, coulomb_velocity = ca.SX.sym("gravity", SPACE), ca.SX.sym("coulomb_velocity")
        ddq = solve_spd(self.inertia(q, p), tau - self.bias(q, dq, p, gravity, coulomb_velocity))
        names = ["q", "dq", "tau", "p", "gravity", "coulomb_velocity"]
        return self._function("ddq", [q, dq, tau, p, gravity, coulomb_velocity], [ddq], names, ["ddq"])

    def split(self, p: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """The parts of p: bodies (10 n,); viscous N.m.s/rad, coulomb N.m and rotor inertia kg m2, each (n,)."""
        n = self.n
        ends = [TEN * n, (TEN + 1) * n, (TEN + 2) * n]
        return p[: ends[0]], p[ends[0] : ends[1]], p[ends[1] : ends[2]], p[ends[2] :]

    @property
    def _p(self) -> ca.SX:
        return ca.SX.sym("p", PER_JOINT * self.n)

    def _symbols(self, *names: str) -> list[ca.SX]:
        return [ca.SX.sym(name, self.n) for name in names]

    def _function(
        self, name: str, arguments: list[ca.SX], results: list[ca.SX], argument_names: list[str], names: list[str]
    ) -> ca.Function:
        """A function whose results share what they have in common."""
        return ca.Function(name, arguments, ca.cse(results), argument_names, names)

    def _frames(self, q: ca.SX) -> list[tuple[ca.SX, ca.SX]]:
        """Rotation and position in the base of the frames of all joints, and of the tip at last."""
        R, position, frames = ca.SX(ca.DM.eye(SPACE)), ca.SX(SPACE, 1), []
        for i, joint in enumerate(self.chain.joints):
            R_i, p_i = joint_frame(joint, q[i])
            R, position = R @ R_i, position + R @ p_i
            frames.append((R, position))
        tip = self.chain.tip
        frames.append((R @ ca.sparsify(ca.DM(tip.R)), position + R @ ca.sparsify(ca.DM(tip.p))))
        return [(ca.densify(R), ca.densify(position)) for R, position in frames]
