"""The paper's runs with the PUMA 560: the tool meets a table, slides along it and leaves, with an unknown payload.

Each run is to the PUMA what one of Figs. 2 to 7 is to the paper's arm (`orchestration.paper.cases`):

- ``puma`` is Fig. 7: algorithm 2 with noise and limited torques. It is the run whose controller a user exchanges.
- ``puma-ideal`` is Figs. 2 and 3, and the run with which forces are compared.
- ``puma-hogan`` is Fig. 4, ``puma-craig`` Fig. 5, ``puma-craig-saturated`` Fig. 6, and ``puma-spong-ortega`` the
  variant of algorithm 1 with one fixed inverse.

The numbers, and the rules by which they were found, stand in `orchestration.paper.spatial_numbers`.
"""

from collections.abc import Mapping, Sequence

from orchestration.paper.numbers import PERIOD, SEED, WALL_STIFFNESS
from orchestration.paper.scenario import Scenario, Value
from orchestration.paper.spatial_numbers import (
    ACC_FILTER_TIME,
    ANGULAR_INERTIA,
    BELIEVED_PAYLOAD,
    DAMPING_RATE,
    DEPTH,
    DQ_START,
    ELLIPSE,
    ELLIPSE_CENTER,
    FIRST_OF_PAYLOAD,
    GAMMA_1,
    GAMMA_2,
    GAMMA_EPS,
    GAMMA_MARGIN,
    INERTIA,
    K_D,
    LENGTH,
    NOISE_BOUND,
    NOISE_HOLD,
    PAYLOAD_CENTER,
    PAYLOAD_INERTIA,
    PSI_1,
    PSI_2,
    Q_START,
    STEP,
    STIFFNESS_RATE,
    TABLE_NORMAL,
    TABLE_OFFSET,
    TEN,
    TILT,
    TORQUE_LIMITS,
    TRUE_PAYLOAD,
    by_coordinate,
    payload_gains,
    payload_parameters,
)

END = "Puma560"
HOGAN = f"HoganImpedance{END}"
CRAIG, SLOTINE_LI = f"CraigAdaptiveImpedance{END}", f"SlotineLiAdaptiveImpedance{END}"
SPONG_ORTEGA = f"SpongOrtegaAdaptiveImpedance{END}"
RATIO = 4.0  # bound over standard deviation of the noise
_TABLE = "assumed: a table below the arm, which cuts off the share of the ellipse that the paper's wall does"
_RATE = "assumed: M times the paper's {0} (V), so that time constants are the paper's"
_SPEED = "assumed: the estimate of the mass settles as fast as with the calibration section-v in the plane"
_CALIBRATED = "assumed: as in the calibration section-v"
_SAMPLING = "assumed: practically continuous; with 1e-4 s F_c chatters, and torques are up to 1.8 times as large"


def _vector(path: str, numbers: Sequence[float], origin: str, first: int = 1) -> dict[str, Value]:
    return {f"{path}[{i}]": Value(number, origin) for i, number in enumerate(numbers, first)}


_SIX = by_coordinate(INERTIA, ANGULAR_INERTIA)
_PLACE = {
    **_vector("plant.q_start", Q_START, "assumed: the tip starts on the ellipse, the tool points down, elbow up"),
    **_vector("plant.dq_start", DQ_START, "assumed: the tip starts with the velocity of the virtual trajectory"),
    "plant.payload_mass": Value(TRUE_PAYLOAD, "V: m2"),
    **_vector("plant.payload_center", PAYLOAD_CENTER, "assumed: the payload is held beside the tip"),
    **_vector("plant.payload_inertia", PAYLOAD_INERTIA, "assumed: a body of 1 kg and 0.15 m"),
    **_vector("plant.wall_normal", TABLE_NORMAL, _TABLE),
    "plant.wall_offset": Value(TABLE_OFFSET, _TABLE),
    "plant.K_f": Value(WALL_STIFFNESS, "V"),
    "plant.D_f": Value(0.0, "assumed: section V names a stiffness alone"),
    "plant.mu": Value(0.0, "assumed: section V names no friction along the wall"),
    **_vector("trajectory.semi_axis", ELLIPSE, "assumed: an upright ellipse within the reach of the arm"),
    **_vector("trajectory.center", ELLIPSE_CENTER, "assumed: far from singular postures of the arm"),
    "trajectory.period": Value(PERIOD, "V"),
    **_vector("trajectory.wall_normal", TABLE_NORMAL, _TABLE),
    "trajectory.wall_offset": Value(TABLE_OFFSET, _TABLE),
    "trajectory.depth": Value(DEPTH, "assumed: K depth is the steady force, 60 N in the paper's runs"),
    **_vector("trajectory.tilt", TILT, "assumed: the tool turns about all axes, so that six coordinates move"),
}
_TARGET = {
    **_vector("controller.M", _SIX, "assumed: close to the inertia that the arm shows at its tip; an angle counts L"),
    **_vector("controller.B", [DAMPING_RATE * M for M in _SIX], _RATE.format("B/M")),
    **_vector("controller.K", [STIFFNESS_RATE * M for M in _SIX], _RATE.format("K/M")),
}
_QUIET = {f"sensor.noise_{name}": Value(0.0, "V") for name in ("std", "bound")}
_NOISE = {
    "sensor.noise_bound": Value(NOISE_BOUND, "assumed: 15 % (V) of the peak force of puma-craig bounds the norm"),
    "sensor.noise_std": Value(NOISE_BOUND / RATIO, _CALIBRATED),
    "sensor.noise_period": Value(NOISE_HOLD, "assumed: a draw of the noise is held for two ticks"),
    "sensor.contact_gated": Value(1.0, _CALIBRATED),
    "sensor.seed": Value(SEED, "assumed: any; the claims are measured over 30 seeds"),
}
_L = {"controller.L": Value(LENGTH, "assumed: the length of the tool turns angles into lengths (decision 19)")}
_LIMITS = _vector("actuator.tau_max", TORQUE_LIMITS, "assumed: 75 % (V) of each joint's largest torque in puma-craig")


def _payload(numbers: Sequence[float], origin: str) -> dict[str, Value]:
    return _vector("controller.p_start", numbers, origin, FIRST_OF_PAYLOAD)


_KNOWN = _payload(payload_parameters(), "the payload of the plant")
_BELIEVED = _payload(
    (BELIEVED_PAYLOAD, *([0.0] * (TEN - 1))), "V: m2 = 2.5 kg; assumed: nothing is known of where this mass is"
)


def _gains(psi: float, gamma: float) -> dict[str, Value]:
    return {
        **_L,
        **_vector("controller.Psi", by_coordinate(psi, psi), _CALIBRATED),
        **_vector("controller.Gamma", payload_gains(gamma), _SPEED, FIRST_OF_PAYLOAD),
    }


_ALGORITHM_1 = {
    **_gains(PSI_1, GAMMA_1),
    "controller.noise_bound": Value(NOISE_BOUND, "(21): delta bounds the sensor's error"),
    "controller.gamma_margin": Value(GAMMA_MARGIN, _CALIBRATED),
    "controller.gamma_eps": Value(GAMMA_EPS, _CALIBRATED),
}
_FIXED_INVERSE = {**_ALGORITHM_1, "controller.acc_filter_time": Value(ACC_FILTER_TIME, _CALIBRATED)}
_ALGORITHM_2 = {
    **_gains(PSI_2, GAMMA_2),
    **_vector("controller.K_d", by_coordinate(K_D, K_D * LENGTH**2), "assumed: K_d/M as in the calibration section-v"),
}


def _run(name: str, caption: str, controller: str, *values: Mapping[str, Value]) -> Scenario:
    models = {
        "trajectory": f"VirtualTrajectory{END}",
        "sensor": f"ForceSensor{END}",
        "controller": controller,
        "actuator": f"Actuator{END}",
        "plant": f"Plant{END}",
    }
    together = {path: value for group in (_PLACE, _TARGET, *values) for path, value in group.items()}
    return Scenario(name, caption, models, together, STEP, _SAMPLING)


SPATIAL: Mapping[str, Scenario] = {
    scenario.name: scenario
    for scenario in (
        _run(
            "puma",
            "PUMA 560 with an unknown payload on a table: algorithm 2",
            SLOTINE_LI, _NOISE, _BELIEVED, _ALGORITHM_2, _LIMITS,
        ),
        _run(
            "puma-ideal",
            "PUMA 560, conventional control with the true payload and a perfect sensor",
            HOGAN, _QUIET, _KNOWN,
        ),
        _run("puma-hogan", "PUMA 560, conventional control with a wrong payload", HOGAN, _QUIET, _BELIEVED),
        _run(
            "puma-craig",
            "PUMA 560, algorithm 1 without saturation",
            CRAIG, _NOISE, _BELIEVED, _ALGORITHM_1,
        ),
        _run(
            "puma-craig-saturated",
            "PUMA 560, algorithm 1 with saturation",
            CRAIG, _NOISE, _BELIEVED, _ALGORITHM_1, _LIMITS,
        ),
        _run(
            "puma-spong-ortega",
            "PUMA 560, algorithm 1 with one fixed inverse",
            SPONG_ORTEGA, _NOISE, _BELIEVED, _FIXED_INVERSE,
        ),
    )
}  # fmt: skip
"""The runs of the PUMA 560: ``puma``, ``puma-ideal`` and so on."""
