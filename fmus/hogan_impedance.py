"""HoganImpedance: conventional impedance control, eqs. (4) to (7), with fixed parameters.

For the square Jacobian of two joints the resolved form (6), (7) is evaluated, the cheapest of the
three. The measured force is compensated and shaped; acceleration is not used.
"""

from adaptimp_fmu import SampledModel
from fmus.controller import declare_controller
from fmus.impedance import torque_resolved


def hogan_impedance() -> SampledModel:
    """Conventional impedance control; p_hat stays at p_start."""
    controller = declare_controller(
        "HoganImpedance", "Conventional impedance control with fixed dynamic parameters"
    )
    tau_cmd = torque_resolved(
        controller.measured,
        controller.arm_model(controller.p_start),
        controller.virtual,
        controller.impedance,
    )
    return controller.finish(tau_cmd, controller.p_start)
