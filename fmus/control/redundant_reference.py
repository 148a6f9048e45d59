"""Algorithm 2 for redundant arms, n > m: an extension beyond the paper, which derives it with the inverse of J.

The reference rate of the tip is dx_r = dx_t - Psi e, as in (30). Among the joint rates that give the tip this rate, the
one nearest to a rate dq_0 is taken. Distances are those of the kinetic energy of the arm with its starting parameters,
whose inertia is H_0 = H(q, p_start):

    dq_r = dq_0 + H_0^-1 J' W_0^-1 (dx_r - J dq_0),   W_0 = J H_0^-1 J'

ddq_r is its exact time derivative. With s_q = dq - dq_r, and with Y_r at dq_r and ddq_r as in (36),

    tau = Y_r p_hat + J' (F_hat - K_d s) - null_damping D s_q,   D = H_0 - J' W_0^-1 J
    dp_hat/dt = -Gamma Y_r' s_q

J s_q = s, so that for n = m these are (30) to (36). D is positive semidefinite, and J H_0^-1 D = 0.

What holds. With (1) the error obeys H ds_q/dt + C s_q = Y_r phi + J' (F_hat - F_ext - K_d s) - null_damping D s_q.
V = (s_q' H s_q + phi' Gamma^-1 phi) / 2 has the derivative

    dV/dt = -s' K_d s - null_damping s_q' D s_q + s' (F_hat - F_ext)

because dH/dt - 2 C is skew-symmetric. This is (35) with one more term, which is not positive. Without errors of the
force s goes to zero, as in the paper, and so does the part of s_q that the tip does not see. H_0 has no estimate in it,
so that dq_r does not jump when p_hat does, and a wrong p_start takes nothing from the proof.

Posture. dq_0 = -(null_stiffness / null_damping) (q - posture). Once s_q is zero, the null space moves towards the
posture at this rate. On the way there its stiffness is null_stiffness, and its damping is
null_damping + null_stiffness / null_damping.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Formula, Formulas
from fmus.control.impedance import ArmEstimate, Measured, null_space_momentum
from fmus.control.null_space import NullSpace
from fmus.mechanics.algebra import solve_mobility, solve_spd

FORMULAS = Formulas(
    "Algorithm 2 beyond the paper, for redundant arms",
    [
        Formula(
            r"\dot{q}_r = \dot{q}_0 + H_0^{-1} J^{T} W_0^{-1} (\dot{x}_r - J \dot{q}_0), \quad"
            r" \dot{q}_0 = -\frac{k_n}{d_n} (q - q_{\text{posture}}), \quad W_0 = J H_0^{-1} J^{T}",
            "The rates of the joints that give the tip its reference rate and are nearest to the posture's; H_0 is the"
            " inertia at p_start, d_n the null_damping and k_n the null_stiffness.",
        ),
        Formula(
            r"\tau = Y_r \hat{p} + J^{T} (\hat{F} - K_d s) - d_n (H_0 - J^{T} W_0^{-1} J) s_q, \quad"
            r" s_q = \dot{q} - \dot{q}_r",
            "The law with a damping of what the tip does not see.",
        ),
        Formula(r"\frac{d\hat{p}}{dt} = -\Gamma\,Y_r^{T} s_q", "The estimates follow the error of the joints' rates."),
    ],
)


@dataclass(frozen=True)
class JointReference:
    """Reference of the joints, shape (n,) each.

    Attributes
    ----------
    dq_r, ddq_r
        Rates, rad/s, and accelerations, rad/s2, that give the tip its reference.
    s_q
        Error dq - dq_r of the rates, rad/s.
    damping
        Torque -null_damping D s_q, N.m; None for n = m, where D is 0.
    """

    dq_r: ca.SX
    ddq_r: ca.SX
    s_q: ca.SX
    damping: ca.SX | None


def redundant_reference(
    measured: Measured, nominal: ArmEstimate, tip: tuple[ca.SX, ca.SX], null_space: NullSpace
) -> JointReference:
    """The reference of the joints for a reference of the tip.

    Parameters
    ----------
    measured
        Its q and dq are symbols, along which the derivative is taken.
    nominal
        The arm with the parameters p_start.
    tip
        Rate dx_r, m/s, and acceleration ddx_r, m/s2, of the tip's reference, shape (m,).
    """
    q, dq = measured.q, measured.dq
    pull = ca.if_else(null_space.damping > 0, null_space.stiffness / null_space.damping, 0)
    dq_0, ddq_0 = -pull * (q - null_space.posture), -pull * dq
    dq_r, ddq_r = nearest_rate(measured, nominal, tip, (dq_0, ddq_0))
    s_q = dq - dq_r
    return JointReference(dq_r, ddq_r, s_q, -null_space.damping * null_space_momentum(q, nominal, s_q))


def nearest_rate(
    measured: Measured, nominal: ArmEstimate, tip: tuple[ca.SX, ca.SX], wanted: tuple[ca.SX, ca.SX]
) -> tuple[ca.SX, ca.SX]:
    """dq_r above and its time derivative, rad/s and rad/s2, shape (n,), for dq_0 and its derivative `wanted`.

    dq_r = dq_0 + d, where H_0 d = J' y and J d = dx_r - J dq_0. The derivative of these two equations is one system
    with the same matrices, so that nothing is factorised twice.
    """
    q, dq = measured.q, measured.dq
    (dx_r, ddx_r), (dq_0, ddq_0) = tip, wanted
    J, dJ, H = nominal.arm.jacobian(q), nominal.arm.jacobian_rate(q, dq), nominal.inertia(q)
    spread = solve_spd(H, J.T)
    W = ca.mtimes(J, spread)
    y = solve_mobility(W, dx_r - ca.mtimes(J, dq_0))
    d = ca.mtimes(spread, y)
    dq_r = dq_0 + d
    # H dd/dt = J' dy/dt + rest,  J dd/dt = ddx_r - dJ dq_r - J ddq_0
    rest = ca.mtimes(dJ.T, y) - _inertia_rate_times(H, d, q, dq)
    free = solve_spd(H, rest)
    dy = solve_mobility(W, ddx_r - ca.mtimes(dJ, dq_r) - ca.mtimes(J, ddq_0 + free))
    return dq_r, ddq_0 + free + ca.mtimes(spread, dy)


def _inertia_rate_times(H: ca.SX, v: ca.SX, q: ca.SX, dq: ca.SX) -> ca.SX:
    """Product (dH/dt) v, shape (n,), with v held."""
    held = ca.SX.sym("v", v.numel())
    return ca.substitute(ca.jtimes(ca.mtimes(H, held), q, dq), held, v)
