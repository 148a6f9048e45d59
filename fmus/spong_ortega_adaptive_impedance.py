"""SpongOrtegaAdaptiveImpedance: algorithm 1 of the paper with one fixed inverse of the inertia.

Source: III-C, remark 2; Spong and Ortega 1990.

With the model at p0 = p_start (index 0) and p_hat = p0 - phi_hat:

    F = F_hat + C_0 dx + g_0 + f_0 + H_0 { ddx_v - M^-1 [...] + da } + F_c,  da = -H_0^-1 W_c phi_hat
    dphi_hat/dt = Gamma W_c' H_0^-1 e*,  phi_hat(0) = 0

so that the torque is that of the model at p0 minus Y(q, dq, a_f) phi_hat, Y the joint regressor. Here
the acceleration enters the torque, and a tick's ddq belongs to the previous torque: unfiltered, the
loop diverges once the spectral radius of H(p)^-1 H(phi_hat) reaches 1. Hence in the torque only

    a_f[k] = a_f[k-1] + lambda (ddq[k] - a_f[k-1]),  lambda = Ts / (acc_filter_time + Ts)

while the adaptation uses ddq. H(p) + H(phi_hat) must stay positive definite: choose p0 >= p.
"""

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, Formula, Formulas, SampledModel
from fmus import icons
from fmus.control.adaptation import declare_adaptation
from fmus.control.controller import declare_controller, drawings, require_square
from fmus.control.impedance import resolved_torque, target_acceleration
from fmus.control.noise_rejection import declare_noise_rejection, declare_outputs
from fmus.craig_adaptive_impedance import GAIN, GAIN_UNIT
from fmus.drawings.loop import CONTROLLER
from fmus.mechanics.algebra import solve_spd, solve_square
from fmus.project import publish
from fmus.robots.robot import Robot

FORMULAS = Formulas(
    "Algorithm 1 with one fixed inverse",
    [
        Formula(
            r"F = \hat{F} + C_0 \dot{x} + g_0 + f_0"
            r" + H_0 \left\{ \ddot{x}_v - M^{-1} [\dots] + \delta a \right\} + F_c,"
            r" \quad \delta a = -H_0^{-1} W_c \hat{\varphi}",
            "The model has the parameters p_start (index 0); a correction stands for what differs from them.",
        ),
        Formula(
            r"\frac{d\hat{\varphi}}{dt} = \Gamma\,W_c^{T} H_0^{-1} e^{*}, \quad \hat{p} = p_0 - \hat{\varphi}",
            "The estimates follow the augmented error.",
        ),
    ],
)


def spong_ortega_adaptive_impedance(
    name: str = "SpongOrtegaAdaptiveImpedance", robot: Robot | None = None, *, full: bool = False
) -> SampledModel:
    """Declare the controller of algorithm 1 with the inverse inertia of fixed parameters.

    With `full` the gains M, B, K, Gamma and Psi are symmetric matrices; else they are diagonal.

    Examples
    --------
    >>> from adaptimp_fmu import Role
    >>> from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
    >>> names = [variable.name for variable in spong_ortega_adaptive_impedance().with_role(Role.FIXED_PARAMETER)]
    >>> "acc_filter_time" in names
    True
    """
    controller = declare_controller(
        name,
        "Adaptive impedance control, algorithm 1 with one fixed inverse (after Spong and Ortega)",
        robot,
        full=full,
    )
    require_square(controller, "algorithm 1")
    publish(
        controller.model,
        icons.adaptive_impedance(3),
        CONTROLLER,
        drawings(controller.robot),
        __name__,
        "fmus.craig_adaptive_impedance",
        "fmus.control.noise_rejection",
        "fmus.control.adaptation",
        *controller.modules,
    )
    adaptation = declare_adaptation(controller, GAIN, GAIN_UNIT)
    model, measured, arm = controller.model, controller.measured, controller.arm
    filter_time = model.parameter(
        "acc_filter_time",
        1e-4,
        unit="s",
        limits=NOT_NEGATIVE,
        description="Time constant of the filter on the acceleration that enters the torque",
    )
    q, dq = measured.q, measured.dq
    phi_hat = model.state("phi_hat", ca.SX.zeros(len(arm.parameters), 1))
    previous = model.state("a_f", controller.ddq)
    a_f = previous + model.period / (filter_time + model.period) * (controller.ddq - previous)
    fixed = controller.with_parameters(controller.p_start)
    J, H_0 = arm.jacobian(q), fixed.inertia(q)
    controller.require_invertible("H_0", H_0, "p_start", "give positive masses")
    rejection = declare_noise_rejection(adaptation, ca.mtimes(J, solve_spd(H_0, J.T)))

    demand = target_acceleration(controller.x, controller.dx, controller.virtual, measured.F_hat, controller.impedance)

    def correction(ddq: ca.SX) -> ca.SX:
        return arm.regressor(q, dq, dq, ddq)

    tau_cmd = resolved_torque(measured, fixed, demand + rejection.acceleration())
    tau_cmd = tau_cmd - ca.mtimes(correction(a_f), phi_hat)
    F_c = solve_square(J.T, ca.mtimes(H_0, solve_square(J, rejection.acceleration())))

    p_hat = controller.p_start - phi_hat
    direction = solve_spd(H_0, ca.mtimes(J.T, rejection.weighted))
    gradient = ca.mtimes(correction(controller.ddq).T, direction)
    updated = adaptation.next_estimate(p_hat, gradient, rejection.e_star)
    model.update_slowly(phi_hat, controller.p_start - updated, divisor="update_divisor")
    model.update(previous, a_f)
    model = controller.finish(tau_cmd, p_hat)
    declare_outputs(rejection, adaptation, F_c)
    return model
