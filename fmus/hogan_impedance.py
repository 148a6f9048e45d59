"""HoganImpedance: conventional impedance control, eqs. (4) to (7), with fixed parameters.

For a square Jacobian, as many joints as task coordinates, the resolved form (6), (7) is evaluated, the cheapest of the
three. HoganImpedanceMobility evaluates form (5), which the paper names for Figs. 2 and 4. More joints need form (5),
which leaves the null space undamped unless `null_damping` is set:

    tau -= null_damping H (dq - H^-1 J' W^-1 dx)

The measured force is compensated and shaped; acceleration is not used.
"""

from adaptimp_fmu import NOT_NEGATIVE, Formula, Formulas, SampledModel
from fmus import icons
from fmus.control.controller import declare_controller, drawings
from fmus.control.impedance import null_space_damping, torque_mobility, torque_resolved
from fmus.control.null_space import declare_null_space
from fmus.drawings.loop import CONTROLLER
from fmus.project import publish
from fmus.robots.planar_robot import PlanarRobot
from fmus.robots.robot import Robot

RESOLVED, MOBILITY = "resolved", "mobility"
"""Forms of the law: (6) and (7), for square Jacobians only, and (5)."""


FORMULAS = Formulas(
    "Null space and mobility",
    [
        Formula(r"W = J H^{-1} J^{T}", "Form (5) of the law uses the mobility of the tip.", "5"),
        Formula(
            r"\tau \leftarrow \tau - d_n H (\dot{q} - H^{-1} J^{T} W^{-1} \dot{x})",
            "Motion that leaves the tip still is damped by d_n, the null_damping, where there are over two joints.",
        ),
    ],
)


def hogan_impedance(
    robot: Robot | None = None, name: str = "HoganImpedance", *, form: str = RESOLVED, full: bool = False
) -> SampledModel:
    """Declare a conventional impedance controller of a robot, by default the paper's; p_hat stays at p_start.

    Parameters
    ----------
    form
        `RESOLVED` or `MOBILITY`. A redundant robot has form (5), whatever is given.
    full
        Whether the gains M, B and K are symmetric matrices; else they are diagonal.

    Examples
    --------
    >>> from fmus.hogan_impedance import MOBILITY, hogan_impedance
    >>> hogan_impedance(form=MOBILITY).description
    'Conventional impedance control with fixed dynamic parameters, form (5)'
    """
    robot = robot or PlanarRobot()
    redundant = robot.n > robot.task.size
    text = "Conventional impedance control with fixed dynamic parameters"
    by_choice = form == MOBILITY and not redundant
    controller = declare_controller(name, f"{text}, form (5)" if by_choice else text, robot, full=full)
    in_null_space = ["fmus.control.null_space"] if redundant and robot.task.in_space else []
    modules = (*in_null_space, *controller.modules)
    publish(controller.model, icons.impedance(robot.n), CONTROLLER, drawings(robot), __name__, *modules)
    estimate = controller.with_parameters(controller.p_start)
    if not redundant and not by_choice:
        law = torque_resolved
    else:
        law = torque_mobility
        controller.require_invertible("H", estimate.inertia(controller.measured.q), "p_start", "give positive masses")
    tau_cmd = law(controller.measured, estimate, controller.virtual, controller.impedance)
    if in_null_space:
        null_space = declare_null_space(controller.model, robot)
        tau_cmd = tau_cmd + null_space.torque(controller.measured, estimate)
    elif redundant:
        damping = controller.model.parameter(
            "null_damping",
            0.0,
            unit="1/s",
            limits=NOT_NEGATIVE,
            tunable=True,
            description="Damping rate of joint motion that leaves the tip still; 0 = the paper's law",
        )
        tau_cmd = tau_cmd + null_space_damping(controller.measured, estimate, damping)
    return controller.finish(tau_cmd, controller.p_start)
