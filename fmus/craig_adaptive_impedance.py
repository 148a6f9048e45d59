"""CraigAdaptiveImpedance: adaptive impedance control by algorithm 1 of the paper, eqs. (8) to (25).

    tau = H_hat ddq* + C_hat dq + g_hat + f_hat + J' (F_hat + F_c)                     (8)
    ddq* = J^-1 { ddx_v - M^-1 [B (dx - dx_v) + K (x - x_v) + F_hat] - dJ/dt dq }      (9)
    dp_hat/dt = -Gamma W_c' H_hat_x^-1 e*                                              (19)

With W_c = J^-T Y(q, dq, ddq), the direction of (19) is Y' H_hat^-1 J' e*: no inverse of J. F_c is
that of `fmus.control.noise_rejection`; since F_c = H_hat_x (-(gamma/2) e*), it enters as an acceleration of
the tip. The measured acceleration ddq is used in the adaptation only.

A singular H_hat, as of an estimate m2_hat = 0, is an error. While a mass is estimated negative, as too large a Gamma
can make it for some milliseconds, H_hat has an inverse but is not positive definite: the law goes on, and the paper's
theory does not say where to. Projection with p_min > 0 excludes both.
"""

import casadi as ca

from adaptimp_fmu import Formula, Formulas, SampledModel
from fmus import icons
from fmus.control.adaptation import declare_adaptation
from fmus.control.controller import declare_controller, drawings, require_square
from fmus.control.impedance import resolved_torque, target_acceleration
from fmus.control.noise_rejection import declare_noise_rejection, declare_outputs
from fmus.drawings.loop import CONTROLLER
from fmus.mechanics.algebra import solve_spd, solve_square
from fmus.project import publish
from fmus.robots.robot import Robot

GAIN = 5.0  # kg2.s2/m2, assumed: of the unknown payload's mass
GAIN_UNIT = "s2/m2"  # of Gamma, beside the units of its two parameters


FORMULAS = Formulas(
    "Algorithm 1 as Craig has it",
    [
        Formula(
            r"\tau = \hat{H} \ddot{q}^{*} + \hat{C} \dot{q} + \hat{g} + \hat{f} + J^{T} (\hat{F} + F_c)",
            "The law of impedance control with estimates in the place of the arm's parameters.",
            "8",
        ),
        Formula(
            r"\frac{d\hat{p}}{dt} = -\Gamma\,W_c^{T} \hat{H}_x^{-1} e^{*}",
            "The estimates follow the augmented error.",
            "19",
        ),
    ],
)


def craig_adaptive_impedance(
    name: str = "CraigAdaptiveImpedance", robot: Robot | None = None, *, full: bool = False
) -> SampledModel:
    """Declare the controller of algorithm 1: impedance control with the adaptation of Craig, Hsu and Sastry.

    With `full` the gains M, B, K, Gamma and Psi are symmetric matrices; else they are diagonal.

    Examples
    --------
    >>> from adaptimp_fmu import Role
    >>> from fmus.craig_adaptive_impedance import craig_adaptive_impedance
    >>> model = craig_adaptive_impedance()
    >>> [variable.name for variable in model.with_role(Role.TUNABLE_PARAMETER)][:4]
    ['M[1]', 'M[2]', 'B[1]', 'B[2]']
    """
    controller = declare_controller(name, "Adaptive impedance control, algorithm 1 (after Craig)", robot, full=full)
    require_square(controller, "algorithm 1")
    publish(
        controller.model,
        icons.adaptive_impedance(1),
        CONTROLLER,
        drawings(controller.robot),
        __name__,
        "fmus.control.noise_rejection",
        "fmus.control.adaptation",
        *controller.modules,
    )
    adaptation = declare_adaptation(controller, GAIN, GAIN_UNIT)
    measured, arm = controller.measured, controller.arm
    q, dq = measured.q, measured.dq
    p_hat = controller.model.state("p_hat", controller.p_start)
    estimate = controller.with_parameters(p_hat)
    J, H = arm.jacobian(q), estimate.inertia(q)
    controller.require_invertible(
        "H_hat", H, "p_hat", "start from positive masses, and keep them so by projection with p_min > 0"
    )
    rejection = declare_noise_rejection(adaptation, ca.mtimes(J, solve_spd(H, J.T)))

    demand = target_acceleration(controller.x, controller.dx, controller.virtual, measured.F_hat, controller.impedance)
    tau_cmd = resolved_torque(measured, estimate, demand + rejection.acceleration())
    inertia_times = ca.mtimes(H, solve_square(J, rejection.acceleration()))
    F_c = solve_square(J.T, inertia_times)

    Y = arm.regressor(q, dq, dq, controller.ddq)
    gradient = ca.mtimes(Y.T, solve_spd(H, ca.mtimes(J.T, rejection.weighted)))
    updated = adaptation.next_estimate(p_hat, gradient, rejection.e_star)
    controller.model.update_slowly(p_hat, updated, divisor="update_divisor")
    model = controller.finish(tau_cmd, p_hat)
    declare_outputs(rejection, adaptation, F_c)
    return model
