"""Actuator: joint torques that follow their command within limits of torque and rate, with a lag.

    target = clip(tau_cmd, -tau_max, tau_max)
    lagged = tau[k-1] + (1 - exp(-Ts / time_constant)) (target - tau[k-1])
    tau[k] = tau[k-1] + clip(lagged - tau[k-1], -tau_rate_max Ts, tau_rate_max Ts)

Lag and rate limit are off by default: tau is the target. The first tick starts at its target.
"""

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, SampledModel, Type
from fmus import icons
from fmus.drawings.characteristics import saturation
from fmus.drawings.loop import ACTUATOR
from fmus.elements import of_joints
from fmus.project import group_signals, publish

OFF = 1e9  # N.m or N.m/s, a limit that is none


FORMULAS = Formulas(
    "Torque at tick k",
    [
        Formula(
            r"\bar{\tau} = \max(-\tau_{\text{max}}, \; \min(\tau_{\text{max}}, \; \tau_{\text{cmd}}))",
            "The target is the command within the limits of the torque.",
        ),
        Formula(
            r"\tau_k = \tau_{k-1} + \mathrm{sat}_{\dot{\tau}_{\text{max}} T_s}"
            r"\left( (1 - e^{-T_s / T})(\bar{\tau} - \tau_{k-1}) \right)",
            "A lag with the time constant T and a limit of the rate follow; sat limits the change per tick.",
        ),
    ],
)


def actuator(n: int = 2, name: str = "Actuator") -> SampledModel:
    """Declare the model of the actuators of n joints; they are ideal by default."""
    model = SampledModel(name, "Joint actuators with torque limits")
    publish(model, icons.saturation(n), ACTUATOR, [saturation()], __name__, "fmus")
    tau_cmd = model.input("tau_cmd", [0.0] * n, unit="N.m", description=of_joints("Commanded torque", n))
    tau_max = model.parameter(
        "tau_max",
        [OFF] * n,
        unit="N.m",
        limits=POSITIVE,
        tunable=True,
        description=[f"{text}; 1e9 = no limit" for text in of_joints("Largest absolute torque", n)],
    )
    rate_max = model.parameter(
        "tau_rate_max",
        [OFF] * n,
        unit="N.m/s",
        limits=POSITIVE,
        description=[f"{text}; 1e9 = no limit" for text in of_joints("Largest absolute rate of the torque", n)],
    )
    time_constant = model.parameter(
        "time_constant",
        0.0,
        unit="s",
        limits=NOT_NEGATIVE,
        description="Time constant of the first-order lag of the torque; 0 = no lag",
    )
    target = ca.fmin(ca.fmax(tau_cmd, -tau_max), tau_max)
    previous = model.state("tau", target)
    share = 1 - ca.exp(-model.period / time_constant)
    lagged = ca.if_else(time_constant > 0, previous + share * (target - previous), target)
    most = rate_max * model.period
    limited = previous + ca.fmin(ca.fmax(lagged - previous, -most), most)
    too_fast = ca.logic_and(rate_max < OFF, ca.fabs(lagged - previous) > most)
    tau = ca.if_else(too_fast, limited, lagged)
    model.update(previous, tau)
    model.output("tau", tau, unit="N.m", description=of_joints("Torque", n))
    model.output(
        "saturated",
        ca.logic_or(ca.fabs(tau_cmd) > tau_max, too_fast),
        type=Type.BOOLEAN,
        description=of_joints("Whether the command exceeds the torque or the rate limit", n),
    )
    group_signals(model)
    return model
