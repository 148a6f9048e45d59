"""SlotineLiAdaptiveImpedance: adaptive impedance control by algorithm 2 of the paper, eqs. (29) to (36).

    s = de + Psi e,  dx_r = dx_t - Psi e,  ddx_r = ddx_t - Psi de
    F = H_hat_x ddx_r + C_hat_x dx_r + g_hat_x + f_hat_x + F_hat - K_d s               (32)
    dp_hat/dt = -Gamma W_s' s                                                          (33)

In joint space, with dq_r = J^-1 dx_r and ddq_r = J^-1 (ddx_r - dJ/dt dq_r), the torque is
Y_r p_hat + J' (F_hat - K_d s) (36) and the direction of (33) is Y_r' J^-1 s. ddx_t is that of the
TIRT, eq. (11), so neither acceleration nor an inverse of the inertia is needed. Friction is taken
at dq, not at dq_r.

With dx_r = dx - s, (32) is H_hat_x ddx_r + C_hat_x dx + g_hat_x + f_hat_x - C_hat_x s + F_hat - K_d s. A Newton-Euler
recursion at the true rate gives the first four terms. Section IV-B says that C_hat_x s may be ignored when s is small
and the motion is slow; SlotineLiAdaptiveImpedanceNoCoriolis does so. With ddq_n = J^-1 (ddx_r - dJ/dt dq) its torque is

    H_hat ddq_n + C_hat dq + g_hat + f_hat + J' (F_hat - K_d s)

and its adaptation remains that of (33) and (34), with dx_r.
"""

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, Formula, Formulas, SampledModel
from fmus import icons
from fmus.control.adaptation import declare_adaptation
from fmus.control.controller import Controller, declare_controller, drawings, require_square
from fmus.control.gains import declare_gain, require_semidefinite
from fmus.control.impedance import target_acceleration
from fmus.control.null_space import declare_null_space
from fmus.control.redundant_reference import JointReference, redundant_reference
from fmus.drawings.loop import CONTROLLER
from fmus.elements import of_axes, of_task
from fmus.mechanics.algebra import solve_square, times
from fmus.project import publish
from fmus.robots.planar_robot import PlanarRobot
from fmus.robots.robot import Robot

GAIN = 4.0  # kg.s2/m2, assumed: of the unknown payload's mass
GAIN_UNIT = "1/N.m"  # of Gamma, beside the units of its two parameters


FORMULAS = Formulas(
    "Algorithm 2",
    [
        Formula(
            r"s = \dot{e} + \Psi e, \quad \dot{x}_r = \dot{x}_t - \Psi e, \quad \ddot{x}_r = \ddot{x}_t - \Psi \dot{e}",
            "The augmented error, and the velocity and acceleration that lead back to the target.",
            "30",
        ),
        Formula(
            r"F = \hat{H}_x \ddot{x}_r + \hat{C}_x \dot{x}_r + \hat{g}_x + \hat{f}_x + \hat{F} - K_d s, \quad"
            r" \tau = J^{T} F",
            "The law needs no acceleration.",
            "32",
        ),
        Formula(r"\frac{d\hat{p}}{dt} = -\Gamma\,W_s^{T} s", "The estimates follow the augmented error.", "33"),
    ],
)


def slotine_li_adaptive_impedance(
    name: str = "SlotineLiAdaptiveImpedance",
    robot: Robot | None = None,
    *,
    full: bool = False,
    coriolis_of_s: bool = True,
) -> SampledModel:
    """Declare the controller of algorithm 2: impedance control with the adaptation of Slotine and Li.

    For an arm with more joints than task coordinates the law is an extension beyond the paper,
    `fmus.control.redundant_reference`.

    Parameters
    ----------
    full
        Whether the gains M, B, K, Gamma, Psi and K_d are symmetric matrices; else they are diagonal.
    coriolis_of_s
        Whether the torque has the term C_hat_x s; section IV-B says that it may be ignored.

    Raises
    ------
    DefinitionError
        If the arm is redundant and the term C_hat_x s is to be left out.

    Examples
    --------
    >>> from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
    >>> slotine_li_adaptive_impedance("Mine", coriolis_of_s=False).description
    'Adaptive impedance control, algorithm 2 (after Slotine and Li), without C_x s'
    """
    robot = robot or PlanarRobot()
    redundant = robot.n > robot.task.size
    text = "Adaptive impedance control, algorithm 2 (after Slotine and Li)"
    text += ", extended beyond the paper to redundant arms" if redundant else ""
    controller = declare_controller(name, text if coriolis_of_s else f"{text}, without C_x s", robot, full=full)
    if not coriolis_of_s:
        require_square(controller, "algorithm 2 without C_x s")
    publish(
        controller.model,
        icons.adaptive_impedance(2),
        CONTROLLER,
        drawings(controller.robot),
        __name__,
        *(["fmus.control.redundant_reference"] if redundant else []),
        "fmus.control.adaptation",
        *controller.modules,
    )
    adaptation = declare_adaptation(controller, GAIN, GAIN_UNIT)
    model, measured, arm = controller.model, controller.measured, controller.arm
    K_d = _declare_K_d(controller)
    q, dq, F_hat = measured.q, measured.dq, measured.F_hat
    p_hat = model.state("p_hat", controller.p_start)
    s = adaptation.filtered_error()
    de = controller.dx - controller.dx_t
    ddx_t = target_acceleration(controller.x_t, controller.dx_t, controller.virtual, F_hat, controller.impedance)
    ddx_r = ddx_t - times(adaptation.Psi, de)
    J = arm.jacobian(q)
    find = _redundant_reference if redundant else _square_reference
    joints = find(controller, (controller.dx - s, ddx_r), s)
    estimate = controller.with_parameters(p_hat)
    if coriolis_of_s:
        inertial = estimate.torque(q, dq, joints.dq_r, joints.ddq_r)
    else:
        inertial = estimate.torque(q, dq, dq, solve_square(J, ddx_r - ca.mtimes(arm.jacobian_rate(q, dq), dq)))
    tau_cmd = inertial + ca.mtimes(J.T, F_hat - times(K_d, s))
    if joints.damping is not None:
        tau_cmd = tau_cmd + joints.damping

    Y_r = arm.regressor(q, dq, joints.dq_r, joints.ddq_r)
    gradient = ca.mtimes(Y_r.T, joints.s_q)
    model.update_slowly(p_hat, adaptation.next_estimate(p_hat, gradient, s), divisor="update_divisor")
    model = controller.finish(tau_cmd, p_hat)
    task = arm.task
    texts = of_task("Augmented error de + Psi e, eq. (30),", task)
    model.output("s", controller.in_base(s), unit=task.each("m/s", "rad/s"), description=texts)
    return model


def _square_reference(controller: Controller, tip: tuple[ca.SX, ca.SX], s: ca.SX) -> JointReference:
    """The joints' reference for that of the tip, dx_r and ddx_r, by the inverse of J."""
    arm, q, dq = controller.arm, controller.measured.q, controller.measured.dq
    J, (dx_r, ddx_r) = arm.jacobian(q), tip
    dq_r = solve_square(J, dx_r)
    return JointReference(
        dq_r, solve_square(J, ddx_r - ca.mtimes(arm.jacobian_rate(q, dq), dq_r)), solve_square(J, s), None
    )


def _redundant_reference(controller: Controller, tip: tuple[ca.SX, ca.SX], s: ca.SX) -> JointReference:
    """The joints' reference for that of the tip, dx_r and ddx_r, with parameters for the null space."""
    del s  # it follows from the reference
    null_space = declare_null_space(controller.model, controller.robot)
    controller.model.require(
        ca.if_else(ca.logic_and(null_space.stiffness > 0, null_space.damping <= 0), -1, 1),
        "null_damping must be positive where null_stiffness is: the posture is approached at the rate null_stiffness /"
        " null_damping; set both, or null_stiffness to 0",
    )
    nominal = controller.with_parameters(controller.p_start)
    controller.require_invertible("H_0", nominal.inertia(controller.measured.q), "p_start", "give positive masses")
    return redundant_reference(controller.measured, nominal, tip, null_space)


def _declare_K_d(controller: Controller) -> ca.SX:
    """Declare the damping gain on s; a full one must be positive semidefinite."""
    task = controller.arm.task
    K_d = declare_gain(
        controller.model,
        "K_d",
        [100.0] * task.positions + [2.25] * task.angles,
        full=controller.full,
        unit="N.s/m" if controller.full else task.each("N.s/m", "N.m.s/rad"),
        limits=NOT_NEGATIVE,
        description=of_axes("Damping gain on s, eq. (32),", task, full=controller.full),
    )
    if controller.full:
        require_semidefinite(
            controller.model, K_d, "K_d must be positive semidefinite, and a zero on its diagonal needs a row of zeros"
        )
    return K_d
