"""Start values of the paper's runs at a setting of the open values, by ``component.variable``.

The scenarios take their numbers from here, and so do studies that vary the open values.
"""

import numpy as np

from orchestration.paper.calibrations import LARGEST, NORM, Setting
from orchestration.paper.numbers import ARM, TORQUE_SHARE

Numbers = dict[str, float]


def place(setting: Setting) -> Numbers:
    """Where the wall is and what it is like, how deep the path lies in it, and how the arm starts."""
    elbow, moving = setting["elbow"], setting["starts_moving"]
    return {
        **_vector("plant.q_start", [elbow * angle for angle in ARM.q]),
        # The arm starts as one stiff body that turns about its base, so both elbows have the same rates.
        **_vector("plant.dq_start", [moving * rate for rate in ARM.dq]),
        "plant.wall_offset": setting["wall_offset"],
        "plant.D_f": setting["D_f"],
        "plant.mu": setting["mu"],
        "trajectory.wall_offset": setting["wall_offset"],
        "trajectory.depth": setting["depth"],
    }


def sensor(setting: Setting, bound: float) -> Numbers:
    """The noise of the force sensor, whose bound is given in N."""
    return {
        "sensor.noise_bound": bound,
        "sensor.noise_std": bound / setting["noise_ratio"],
        "sensor.noise_period": noise_period(setting),
        "sensor.contact_gated": setting["contact_gated"],
    }


def noise_period(setting: Setting) -> float:
    """Time for which a draw of the noise is held, s, in whole ticks; 0 if there is a draw for every tick."""
    ticks = max(1, round(setting["noise_hold"] / setting["sample_time"]))
    return 0.0 if ticks == 1 else ticks * setting["sample_time"]


def craig(setting: Setting, bound: float) -> Numbers:
    """Gains of algorithm 1, which knows the bound of the noise, N."""
    return {
        **_vector("controller.Psi", [setting["Psi_1"]] * 2),
        "controller.Gamma[2]": setting["Gamma_1"],
        "controller.noise_bound": bound,
        "controller.gamma_margin": setting["gamma_margin"],
        "controller.gamma_eps": setting["gamma_eps"],
    }


def fixed_inverse(setting: Setting, bound: float) -> Numbers:
    """Gains of the variant of algorithm 1 with a fixed inverse."""
    return {**craig(setting, bound), "controller.acc_filter_time": setting["acc_filter_time"]}


def slotine_li(setting: Setting) -> Numbers:
    """Gains of algorithm 2."""
    return {
        **_vector("controller.Psi", [setting["Psi_2"]] * 2),
        "controller.Gamma[2]": setting["Gamma_2"],
        **_vector("controller.K_d", [setting["K_d"]] * 2),
    }


def limits(torque_limits: np.ndarray | tuple[float, float]) -> Numbers:
    """Limits of the actuators, N.m, shape (2,)."""
    return _vector("actuator.tau_max", [float(limit) for limit in torque_limits])


def torque_limits(largest: np.ndarray, norm: float, reading: float) -> np.ndarray:
    """Limits of the joints, N.m, shape (2,): 75 % of the largest torque, as a reading of this sentence has it.

    Parameters
    ----------
    largest
        Largest absolute torque of each joint, N.m, shape (2,).
    norm
        Largest Euclidean norm of both torques at one instant, N.m.
    reading
        ``EACH_JOINT``, ``LARGEST`` or ``NORM`` of `orchestration.paper.calibrations`.
    """
    if reading == NORM:
        return TORQUE_SHARE * np.full_like(largest, norm)
    return TORQUE_SHARE * (np.full_like(largest, largest.max()) if reading == LARGEST else largest)


def _vector(path: str, numbers: list[float]) -> Numbers:
    return {f"{path}[{i}]": number for i, number in enumerate(numbers, start=1)}
