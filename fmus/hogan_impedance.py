"""HoganImpedance: conventional impedance control, eqs. (4) to (7), with fixed parameters.

For the square Jacobian of two joints the resolved form (6), (7) is evaluated, the cheapest of the
three; for more joints form (5), which leaves the null space undamped unless `null_damping` is set:

    tau -= null_damping H (dq - H^-1 J' W^-1 dx)

The measured force is compensated and shaped; acceleration is not used.
"""

from adaptimp_fmu import NOT_NEGATIVE, SampledModel
from fmus import icons
from fmus.control.controller import EQUATIONS, declare_controller
from fmus.control.impedance import null_space_damping, torque_mobility, torque_resolved
from fmus.project import publish


def hogan_impedance(n: int = 2, name: str = "HoganImpedance") -> SampledModel:
    """Declare a conventional impedance controller of an arm with n joints; p_hat stays at p_start."""
    controller = declare_controller(name, "Conventional impedance control with fixed dynamic parameters", n)
    publish(controller.model, icons.impedance(n), __name__, *EQUATIONS)
    arm_model = controller.arm_model(controller.p_start)
    task_size = controller.arm.task_size
    law = torque_resolved if n == task_size else torque_mobility
    tau_cmd = law(controller.measured, arm_model, controller.virtual, controller.impedance)
    if n > task_size:
        damping = controller.model.parameter(
            "null_damping",
            0.0,
            unit="1/s",
            limits=NOT_NEGATIVE,
            tunable=True,
            description="Damping rate of joint motion that leaves the tip still; 0 = the paper's law",
        )
        tau_cmd = tau_cmd + null_space_damping(controller.measured, arm_model, damping)
    return controller.finish(tau_cmd, controller.p_start)
