"""Actuator: joint torques that follow their command within limits of torque and rate, with a lag.

    target = clip(tau_cmd, -tau_max, tau_max)
    lagged = tau[k-1] + (1 - exp(-Ts / time_constant)) (target - tau[k-1])
    tau[k] = tau[k-1] + clip(lagged - tau[k-1], -tau_rate_max Ts, tau_rate_max Ts)

Lag and rate limit are off by default: tau is the target. The first tick starts at its target.
"""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, SampledModel, Type
from fmus import icons
from fmus.drawings.characteristics import saturation
from fmus.drawings.loop import ACTUATOR
from fmus.mechanics.joints import NONE, Joints
from fmus.project import group_signals, publish

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


def actuator(joints: Joints | int = 2, name: str = "Actuator") -> SampledModel:
    """Declare the model of the actuators of an arm's joints, which have no lag by default.

    Parameters
    ----------
    joints
        Whose actuators they are: their limits are the start values of `tau_max`. A number of joints stands for joints
        that turn and have no limits.

    Examples
    --------
    >>> from fmus.actuator import actuator
    >>> actuator(3, "Actuator3R").input_symbols[0].shape
    (3, 1)
    """
    joints = Joints.numbered(joints) if isinstance(joints, int) else joints
    units = joints.each("N.m", "N")
    model = SampledModel(name, "Joint actuators with torque limits")
    publish(model, icons.saturation(joints.n), ACTUATOR, [saturation()], __name__, "fmus")
    commanded = joints.texts("Commanded torque", "Commanded force")
    tau_cmd = model.input("tau_cmd", [0.0] * joints.n, unit=units, description=commanded)
    tau_max, rate_max = _declare_limits(model, joints)
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
    too_fast = ca.logic_and(rate_max < NONE, ca.fabs(lagged - previous) > most)
    tau = ca.if_else(too_fast, limited, lagged)
    model.update(previous, tau)
    model.output("tau", tau, unit=units, description=joints.texts("Torque", "Force"))
    model.output(
        "saturated",
        ca.logic_or(ca.fabs(tau_cmd) > tau_max, too_fast),
        type=Type.BOOLEAN,
        description=joints.texts(
            "Whether the command exceeds the torque or the rate limit",
            "Whether the command exceeds the force or the rate limit",
        ),
    )
    group_signals(model)
    return model


def _declare_limits(model: SampledModel, joints: Joints) -> tuple[ca.SX, ca.SX]:
    """Declare the largest torques and their largest rates, shape (n,) each."""
    tau_max = model.parameter(
        "tau_max",
        joints.efforts,
        unit=joints.each("N.m", "N"),
        limits=POSITIVE,
        tunable=True,
        description=_or_none(joints.texts("Largest absolute torque", "Largest absolute force")),
    )
    rate_max = model.parameter(
        "tau_rate_max",
        [NONE] * joints.n,
        unit=joints.each("N.m/s", "N/s"),
        limits=POSITIVE,
        description=_or_none(
            joints.texts("Largest absolute rate of the torque", "Largest absolute rate of the force"),
        ),
    )
    return tau_max, rate_max


def _or_none(texts: Sequence[str]) -> list[str]:
    """Texts of limits, which may be none."""
    return [f"{text}; 1e9 = no limit" for text in texts]
