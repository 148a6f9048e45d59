"""Start values that bring each FMU's equations to life: contact, noise, limits, friction.

An FMU that is not listed is tested with its defaults.
"""

import numpy as np

from tests.conformance.binary import OK, Binary, Instance, kind
from tests.conformance.container import CONTAINER, PARTS

H = 1e-4  # s, one tick of every FMU
# Steps in ticks: within one, across several, and off the grid.
STEPS = (1.0, 0.5, 0.7, 2.0, 3.3, 0.25)
WHOLE_STEPS = (1.0, 2.0, 1.0, 3.0, 5.0)  # a container steps by whole ticks only
# The tip starts 1 cm inside a wall at x1 <= 1.51 m; with 1e5 N/m it leaves it within about 5 ms.
_PLANT = {
    "wall_offset": -1.51,
    "D_f": 0.5,
    "mu": 0.3,
    "friction_velocity": 1.0,
    "gravity": 9.81,
    "coulomb_velocity": 1.0,
    **{f"viscous[{i}]": 0.2 * i for i in (1, 2, 3)},
    **{f"coulomb[{i}]": 0.1 * i for i in (1, 2, 3)},
}
_CONTROLLER = {
    "gravity": 9.81,
    "coulomb_velocity": 1.0,
    "F_hat[1]": 5.0,
    "F_hat[2]": -3.0,
    **{f"p_start[{i}]": 0.2 * i for i in range(3, 10)},
    "null_damping": 1.0,
    "noise_bound": 1e4,  # so large that F_c acts even far from the target
    "gamma_eps": 0.1,
}
_ACTUATOR = {  # commands just past their limits
    **{f"tau_max[{i}]": float(i) for i in (1, 2, 3)},
    "tau_cmd[1]": 1.02,
    "tau_cmd[2]": -2.02,
    "tau_cmd[3]": -3.01,
}

# The contact point starts 1 cm inside a table at x3 = 0.11 m, while joint 2 is beyond its stop and the payload swings.
_SPATIAL_PLANT = {
    "wall_offset": -0.11,
    "D_f": 0.5,
    "mu": 0.3,
    "friction_velocity": 1.0,
    "coulomb_velocity": 1.0,
    "contact_point[1]": 0.01,
    "contact_point[3]": 0.02,
    **{f"p[{i}]": 0.1 * (i - 60) for i in range(61, 73)},  # friction
}
_SPATIAL_CONTROLLER = {
    "coulomb_velocity": 1.0,
    **{f"F_hat[{i + 1}]": force for i, force in enumerate((5.0, -3.0, 8.0, 0.2, -0.1, 0.3))},
    **{f"p_start[{i}]": 0.1 * (i - 60) for i in range(61, 73)},
    "p_start[79]": 0.8,
    "p_start[80]": 0.01,
    "task_rpy[1]": 0.3,
    "noise_bound": 1e4,
    "gamma_eps": 0.1,
}
_SPATIAL_SENSOR = {
    "noise_std": 1.0,
    "noise_bound": 3.0,
    "seed": 7,
    **{f"F_ext[{i + 1}]": force for i, force in enumerate((2.0, -1.0, 5.0, 0.1, 0.2, -0.1))},
    "sensor_position[3]": -0.1,
    "sensor_rpy[2]": 0.3,
    "filter_time": 1e-3,
    "tool_mass": 0.5,
    "tool_center[3]": 0.03,
}

# Of a scene, an FMU uses what it has.
SCENES: dict[str, dict[str, float]] = {
    "Plant": _PLANT,
    "Plant3R": _PLANT,
    "ForceSensor": {"noise_std": 1.0, "noise_bound": 3.0, "seed": 7, "F_ext[1]": 2.0, "F_ext[2]": -1.0},
    "Actuator": _ACTUATOR,
    "Actuator3R": _ACTUATOR,
    "VirtualTrajectory": {"wall_offset": -1.51, "period": 0.02},
    "HoganImpedance": _CONTROLLER,
    "HoganImpedance3R": _CONTROLLER,
    "CraigAdaptiveImpedance": _CONTROLLER,
    "SlotineLiAdaptiveImpedance": _CONTROLLER,
    "SpongOrtegaAdaptiveImpedance": _CONTROLLER,
    "PlantPuma560": _SPATIAL_PLANT,
    "ForceSensorPuma560": _SPATIAL_SENSOR,
    "ActuatorPuma560": {f"tau_cmd[{i + 1}]": 1.02 * (-1) ** i for i in range(6)}
    | {f"tau_max[{i + 1}]": 1.0 for i in range(6)},
    "VirtualTrajectoryPuma560": {"wall_offset": -0.09, "period": 0.02, "tilt[1]": 0.2, "tilt[3]": -0.1},
    **{
        f"{law}ImpedancePuma560": _SPATIAL_CONTROLLER
        for law in ("Hogan", "CraigAdaptive", "SlotineLiAdaptive", "SpongOrtegaAdaptive")
    },
}
SCENES[CONTAINER] = {f"{part}.{name}": v for part, model in PARTS.items() for name, v in SCENES[model].items()}


def lengths_of(binary: Binary) -> tuple[float, ...]:
    """Lengths of steps that an FMU takes, in ticks."""
    return WHOLE_STEPS if binary.name == CONTAINER else STEPS


def scene(binary: Binary) -> dict[str, float]:
    """Start values of an FMU's scene."""
    return {name: v for name, v in SCENES.get(binary.name, {}).items() if name in binary.variables}


def random_inputs(binary: Binary, rng: np.random.Generator) -> dict[str, float]:
    """Inputs near their scene's start: 1 % and 0.01 off, Booleans by a coin."""
    starts = binary.starts("input") | {n: v for n, v in scene(binary).items() if n in binary.names("input")}
    return {
        name: float(rng.integers(2))
        if kind(binary.variables[name]) == "Boolean"
        else value * (1 + 0.01 * rng.standard_normal()) + 0.01 * rng.standard_normal()
        for name, value in starts.items()
    }


def run(instance: Instance, seed: int, steps: int = 60) -> np.ndarray:
    """Outputs after each of some steps of random lengths with random inputs, shape (steps, n)."""
    rng = np.random.default_rng(seed)
    rows, lengths = [], lengths_of(instance.binary)
    for _ in range(steps):
        assert instance.set(random_inputs(instance.binary, rng)) == OK
        assert instance.step(H * rng.choice(lengths)) == OK, instance.last
        rows.append(instance.outputs())
    return np.array(rows)
