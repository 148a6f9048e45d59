"""The interfaces of the FMUs as data: names, shapes, units and start values.

Only FMUs that exist are tested; a start of None is not fixed by the design.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple


class Signal(NamedTuple):
    """A variable: its unit ("" = none) and the starts of its elements; one float for a scalar."""

    unit: str | None
    start: float | tuple[float | None, ...] | None = None

    @property
    def starts(self) -> tuple[float | None, ...]:
        """Starts by element."""
        return self.start if isinstance(self.start, tuple) else (self.start,)

    def elements(self, name: str) -> list[str]:
        """Scalar names."""
        return [f"{name}[{i + 1}]" for i in range(len(self.starts))] if isinstance(self.start, tuple) else [name]


@dataclass(frozen=True)
class Interface:
    """What an FMU shows: inputs are complete, outputs too unless open, `parameters` are the main ones."""

    inputs: dict[str, Signal]
    outputs: dict[str, Signal]
    parameters: dict[str, Signal]
    tunable: frozenset[str] = frozenset()
    open_outputs: bool = False
    sampled: bool = True


NONE2 = (None, None)
NONE6 = (None,) * 6
SAMPLE_TIME = {"sample_time": Signal("s", 1e-4)}
TUNABLE = frozenset(
    {
        "M",
        "B",
        "K",
        "Gamma",
        "Psi",
        "K_d",
        "noise_std",
        "noise_bound",
        "gamma_margin",
        "gamma_eps",
        "tau_max",
        "null_damping",
    }
)
WALL = {"wall_normal": Signal("", (-1.0, 0.0)), "wall_offset": Signal("m", 1.45)}

MEASUREMENTS = {
    "q": Signal("rad", (-0.7227342478, 1.4454684956)),
    "dq": Signal("rad/s", (2.0943951024, 0.0)),
    "ddq": Signal("rad/s2", NONE2),
    "F_hat": Signal("N", (0.0, 0.0)),
    "x_v": Signal("m", (1.5, 0.0)),
    "dx_v": Signal("m/s", (0.0, math.pi)),
    "ddx_v": Signal("m/s2", (-1.5 * math.pi**2, 0.0)),
}
SATURATED = {"saturated": Signal("", (0.0, 0.0))}
CONTROLLER_OUTPUTS = {
    "tau_cmd": Signal("N.m", NONE2),
    "x_t": Signal("m", NONE2),
    "dx_t": Signal("m/s", NONE2),
    "e": Signal("m", NONE2),
    "p_hat": Signal(None, NONE6),
}
CONTROLLER_PARAMETERS = SAMPLE_TIME | {
    "M": Signal("kg", (2.0, 2.0)),
    "B": Signal("N.s/m", (340.0, 340.0)),
    "K": Signal("N/m", (4000.0, 4000.0)),
    "l": Signal("m", (1.0, 1.0)),
    "gravity": Signal("m/s2", 0.0),
    "coulomb_velocity": Signal("rad/s", 1e-2),
    "p_start": Signal(None, (2.0, 1.0, 0.0, 0.0, 0.0, 0.0)),
}
ADAPTIVE_PARAMETERS = CONTROLLER_PARAMETERS | {
    "Gamma": Signal(None, NONE6),
    "Psi": Signal(None, NONE2),
    "p_min": Signal(None, NONE6),
    "p_max": Signal(None, NONE6),
    "projection": Signal(""),
    "dead_zone": Signal("m/s"),
    "freeze_when_saturated": Signal(""),
    "update_divisor": Signal(""),
}
ROBUST_PARAMETERS = {
    "noise_bound": Signal("N"),
    "contact_threshold": Signal("N"),
    "gamma_margin": Signal(None),
    "gamma_eps": Signal("m/s", 1e-4),
}


def _adaptive(**more: Signal) -> Interface:
    return Interface(
        MEASUREMENTS | SATURATED,
        CONTROLLER_OUTPUTS,
        ADAPTIVE_PARAMETERS | more,
        TUNABLE,
        open_outputs=True,
    )


INTERFACES = {
    "Plant": Interface(
        {"tau": Signal("N.m", (0.0, 0.0))},
        {
            "q": Signal("rad", NONE2),
            "dq": Signal("rad/s", NONE2),
            "ddq": Signal("rad/s2", NONE2),
            "x": Signal("m", NONE2),
            "dx": Signal("m/s", NONE2),
            "F_ext": Signal("N", NONE2),
            "gap": Signal("m"),
            "penetration": Signal("m"),
        },
        WALL
        | {
            "q_start": Signal("rad", (-0.7227342478, 1.4454684956)),
            "dq_start": Signal("rad/s", (2.0943951024, 0.0)),
            "m": Signal("kg", (2.0, 1.0)),
            "l": Signal("m", (1.0, 1.0)),
            "viscous": Signal("N.m.s/rad", (0.0, 0.0)),
            "coulomb": Signal("N.m", (0.0, 0.0)),
            "coulomb_velocity": Signal("rad/s", 1e-2),
            "gravity": Signal("m/s2", 0.0),
            "K_f": Signal("N/m", 1e5),
            "D_f": Signal("s/m", 0.0),
            "mu": Signal("", 0.0),
            "friction_velocity": Signal("m/s", 1e-2),
            "dt_max": Signal("s", 1e-4),
        },
        sampled=False,
    ),
    "ForceSensor": Interface(
        {"F_ext": Signal("N", (0.0, 0.0))},
        {"F_hat": Signal("N", NONE2)},
        SAMPLE_TIME
        | {
            "noise_std": Signal("N", 0.0),
            "noise_bound": Signal("N", 0.0),
            "contact_gated": Signal("", 1.0),
            "seed": Signal(""),
            "noise_period": Signal("s", 0.0),
            "bias": Signal("N", (0.0, 0.0)),
            "resolution": Signal("N", 0.0),
            "range": Signal("N", 1e9),
        },
        TUNABLE,
    ),
    "Actuator": Interface(
        {"tau_cmd": Signal("N.m", (0.0, 0.0))},
        {"tau": Signal("N.m", NONE2), "saturated": Signal("", NONE2)},
        SAMPLE_TIME
        | {
            "tau_max": Signal("N.m", (1e9, 1e9)),
            "tau_rate_max": Signal("N.m/s", (1e9, 1e9)),
            "time_constant": Signal("s", 0.0),
        },
        TUNABLE,
    ),
    "VirtualTrajectory": Interface(
        {},
        {"x_v": Signal("m", NONE2), "dx_v": Signal("m/s", NONE2), "ddx_v": Signal("m/s2", NONE2)},
        SAMPLE_TIME
        | WALL
        | {"semi_axis": Signal("m", (1.5, 1.0)), "period": Signal("s", 2.0), "depth": Signal("m", 0.01)},
    ),
    "HoganImpedance": Interface(MEASUREMENTS, CONTROLLER_OUTPUTS, CONTROLLER_PARAMETERS, TUNABLE),
    "CraigAdaptiveImpedance": _adaptive(**ROBUST_PARAMETERS),
    "SlotineLiAdaptiveImpedance": _adaptive(K_d=Signal(None, NONE2)),
    "SpongOrtegaAdaptiveImpedance": _adaptive(**ROBUST_PARAMETERS, acc_filter_time=Signal("s", 1e-4)),
}

# The redundant arm: what belongs to a joint has three elements, p nine; starts are its own.
_JOINT = {
    "q",
    "dq",
    "ddq",
    "tau",
    "tau_cmd",
    "saturated",
    "q_start",
    "dq_start",
    "m",
    "l",
    "viscous",
    "coulomb",
}


def _redundant(interface: Interface, **more: Signal) -> Interface:
    def widened(signals: dict[str, Signal]) -> dict[str, Signal]:
        length = {"p_start": 9, "p_hat": 9, "tau_max": 3, "tau_rate_max": 3} | dict.fromkeys(_JOINT, 3)
        return {
            name: Signal(signal.unit, (None,) * length[name]) if name in length else signal
            for name, signal in signals.items()
        }

    return replace(
        interface,
        inputs=widened(interface.inputs),
        outputs=widened(interface.outputs),
        parameters=widened(interface.parameters) | more,
    )


INTERFACES |= {
    "Plant3R": _redundant(INTERFACES["Plant"]),
    "Actuator3R": _redundant(INTERFACES["Actuator"]),
    "HoganImpedance3R": _redundant(INTERFACES["HoganImpedance"], null_damping=Signal("1/s", 0.0)),
}
