"""Hogan's impedance control, in the paper's three forms, eqs. (4) to (7).

The target is M (ddx - ddx_v) + B (dx - dx_v) + K (x - x_v) = -F_ext, eq. (3). For a square,
invertible Jacobian the three forms agree; (5) also serves redundant arms. Where a coordinate of x is an angle, its
force is a moment.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Formula, Formulas
from fmus.control.full_tirt import FullImpedance
from fmus.control.tirt import Impedance
from fmus.mechanics.algebra import solve_mobility, solve_spd, solve_square
from fmus.mechanics.arm import ArmModel

FORMULAS = Formulas(
    "Impedance control",
    [
        Formula(
            r"M (\ddot{x} - \ddot{x}_v) + B (\dot{x} - \dot{x}_v) + K (x - x_v) = -F_{\text{ext}}",
            "The target: the tip is to yield like a mass on a spring and a damper.",
            "3",
        ),
        Formula(
            r"\tau = \hat{H} \ddot{q}^{*} + \hat{C} \dot{q} + \hat{g} + \hat{f} + J^{T} \hat{F}",
            "The torque, from a model of the arm.",
            "6",
        ),
        Formula(
            r"\ddot{q}^{*} = J^{-1} \left\{ \ddot{x}_v - M^{-1} \left[ B (\dot{x} - \dot{x}_v) + K (x - x_v)"
            r" + \hat{F} \right] - \dot{J} \dot{q} \right\}",
            "The acceleration of the joints that the target asks for.",
            "7",
        ),
    ],
)


@dataclass(frozen=True)
class Measured:
    """Measurements of a controller: joint angles rad and rates rad/s, shape (n,), and tip force N, shape (m,)."""

    q: ca.SX
    dq: ca.SX
    F_hat: ca.SX


@dataclass(frozen=True)
class ArmEstimate:
    """A controller's model of the arm: its equations, and an estimate p of its parameters, shape (r,)."""

    arm: ArmModel
    p: ca.SX

    def inertia(self, q: ca.SX) -> ca.SX:
        """H, kg m2, shape (n, n)."""
        return self.arm.inertia(q, self.p)

    def bias(self, q: ca.SX, dq: ca.SX) -> ca.SX:
        """C dq + g + f, N.m, shape (n,)."""
        return self.arm.bias(q, dq, self.p)

    def torque(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """H a + C v + g + f, N.m, shape (n,)."""
        return self.arm.inverse_dynamics(q, dq, v, a, self.p)


def target_acceleration(
    x: ca.SX, dx: ca.SX, virtual: tuple[ca.SX, ca.SX, ca.SX], F: ca.SX, impedance: Impedance | FullImpedance
) -> ca.SX:
    """Tip acceleration that eq. (3) demands, m/s2, shape (m,)."""
    x_v, dx_v, ddx_v = virtual
    return ddx_v - impedance.acceleration(dx - dx_v, x - x_v, F)


def torque_operational(
    measured: Measured, model: ArmEstimate, virtual: tuple[ca.SX, ca.SX, ca.SX], impedance: Impedance | FullImpedance
) -> ca.SX:
    """Tau = J' F with F from eq. (4); square Jacobians only. N.m, shape (n,)."""
    q, dq, F_hat = measured.q, measured.dq, measured.F_hat
    J, dJ = model.arm.jacobian(q), model.arm.jacobian_rate(q, dq)
    x, dx = model.arm.forward_kinematics(q), ca.mtimes(J, dq)
    H = model.inertia(q)
    inverse_transpose = solve_square(J.T, ca.SX.eye(model.arm.n))
    H_x = ca.mtimes([inverse_transpose, H, inverse_transpose.T])
    # C_x dx + g_x + f_x = J^-T (C dq + g + f - H J^-1 dJ dq)
    drift = solve_square(J, ca.mtimes(dJ, dq))
    bias_x = ca.mtimes(inverse_transpose, model.bias(q, dq) - ca.mtimes(H, drift))
    F = F_hat + bias_x + ca.mtimes(H_x, target_acceleration(x, dx, virtual, F_hat, impedance))
    return ca.mtimes(J.T, F)


def torque_mobility(
    measured: Measured, model: ArmEstimate, virtual: tuple[ca.SX, ca.SX, ca.SX], impedance: Impedance | FullImpedance
) -> ca.SX:
    """Eq. (5), with the mobility tensor W = J H^-1 J'; any Jacobian of full row rank. N.m, shape (n,).

    The last joint term is -dJ/dt dq, and W^-1 M^-1 acts on the force.
    """
    q, dq, F_hat = measured.q, measured.dq, measured.F_hat
    J, dJ = model.arm.jacobian(q), model.arm.jacobian_rate(q, dq)
    x, dx = model.arm.forward_kinematics(q), ca.mtimes(J, dq)
    H = model.inertia(q)
    free = solve_spd(H, model.bias(q, dq))
    W = ca.mtimes(J, solve_spd(H, J.T))
    demand = target_acceleration(x, dx, virtual, F_hat, impedance)
    demand = demand + ca.mtimes(J, free) - ca.mtimes(dJ, dq)
    return ca.mtimes(J.T, solve_mobility(W, demand) + F_hat)


def torque_resolved(
    measured: Measured, model: ArmEstimate, virtual: tuple[ca.SX, ca.SX, ca.SX], impedance: Impedance | FullImpedance
) -> ca.SX:
    """Eqs. (6) and (7), with M dJ/dt dq in (7); square Jacobians only. N.m, shape (n,).

    The cheapest of the three: one inverse dynamics at the joint acceleration ddq*.
    """
    x = model.arm.forward_kinematics(measured.q)
    dx = ca.mtimes(model.arm.jacobian(measured.q), measured.dq)
    return resolved_torque(measured, model, target_acceleration(x, dx, virtual, measured.F_hat, impedance))


def resolved_torque(measured: Measured, model: ArmEstimate, demand: ca.SX) -> ca.SX:
    """Eq. (6): the torque for a tip acceleration `demand`, m/s2, shape (m,), and the measured force.

    ddq* = J^-1 (demand - dJ/dt dq); square Jacobians only. N.m, shape (n,).
    """
    q, dq = measured.q, measured.dq
    J, dJ = model.arm.jacobian(q), model.arm.jacobian_rate(q, dq)
    ddq_star = solve_square(J, demand - ca.mtimes(dJ, dq))
    return model.torque(q, dq, dq, ddq_star) + ca.mtimes(J.T, measured.F_hat)


def null_space_damping(measured: Measured, model: ArmEstimate, damping: ca.SX) -> ca.SX:
    """Torque -d_n H (dq - H^-1 J' W^-1 dx), N.m, shape (n,): damps motion that leaves the tip still.

    Eq. (5) leaves the null space of a redundant arm undamped. `damping` d_n in 1/s.
    """
    return -damping * null_space_momentum(measured.q, model, measured.dq)


def null_space_momentum(q: ca.SX, model: ArmEstimate, v: ca.SX) -> ca.SX:
    """Momentum H N v = H v - J' W^-1 J v, kg m2/s, shape (n,), of the part N v of v that leaves the tip still."""
    J, H = model.arm.jacobian(q), model.inertia(q)
    W = ca.mtimes(J, solve_spd(H, J.T))
    of_the_tip = ca.mtimes(J.T, solve_mobility(W, ca.mtimes(J, v)))
    return ca.mtimes(H, v) - of_the_tip
