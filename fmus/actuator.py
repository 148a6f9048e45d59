"""Actuator: holds the commanded torque within symmetric limits.

tau = min(max(tau_cmd, -tau_max), tau_max)
"""

import casadi as ca

from adaptimp_fmu import POSITIVE, SampledModel, Type, present
from fmus import icons

OFF = 1e9  # N.m, a limit that is none


def actuator(n: int = 2, name: str = "Actuator") -> SampledModel:
    """Actuators of n joints; ideal by default."""
    model = SampledModel(name, "Joint actuators with torque limits")
    present(model, icons.saturation(n), __name__, "fmus")
    tau_cmd = model.input("tau_cmd", [0.0] * n, unit="N.m", description="Commanded joint torque")
    tau_max = model.parameter(
        "tau_max",
        [OFF] * n,
        unit="N.m",
        limits=POSITIVE,
        tunable=True,
        description="Largest absolute joint torque; 1e9 = no limit",
    )
    model.output(
        "tau",
        ca.fmin(ca.fmax(tau_cmd, -tau_max), tau_max),
        unit="N.m",
        description="Joint torque",
    )
    model.output(
        "saturated",
        ca.fabs(tau_cmd) > tau_max,
        type=Type.BOOLEAN,
        description="Whether the commanded torque exceeds the limit",
    )
    return model
