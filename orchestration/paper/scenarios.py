"""The paper's runs: which FMUs each is made of, and its start values with their origins.

Every number is either stated in the paper, with the place, or assumed, with the reason. One set of
assumed values serves all figures of a kind; nothing is tuned per figure. The numbers that are used in
more than one place stand in `orchestration.paper.numbers`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from orchestration.fmi.description import SAMPLE_TIME
from orchestration.paper.numbers import (
    ADAPTIVE_DAMPING,
    ADAPTIVE_STEP,
    ARM,
    CONVENTIONAL_STEP,
    DEPTH,
    GAMMA_CRAIG,
    GAMMA_EPS,
    GAMMA_MARGIN,
    GAMMA_SLOTINE_LI,
    K_D,
    NO_TORQUE_LIMIT,
    NOISE_BOUND,
    PERIOD,
    PSI,
    SEED,
    SEMI_AXIS,
    TARGET_INERTIA,
    TARGET_STIFFNESS,
    TORQUE_LIMITS,
    TRUE_M2,
    TRUE_MASSES,
    WALL_NORMAL,
    WALL_OFFSET,
    WALL_STIFFNESS,
    WRONG_M2,
)
from orchestration.system.system import System


@dataclass(frozen=True)
class Value:
    """A start value and where it comes from.

    Attributes
    ----------
    number
        In the unit of the variable.
    origin
        ``"V"`` for a number stated in section V, else ``"assumed: "`` and the reason.
    """

    number: float
    origin: str

    @property
    def assumed(self) -> bool:
        """Whether the paper leaves the number open."""
        return self.origin.startswith("assumed")


@dataclass(frozen=True)
class Scenario:
    """A run that the paper shows or claims something about.

    Attributes
    ----------
    models
        Component name to model identifier, in the order of stepping.
    values
        Start values by ``component.variable``.
    step
        Communication step and sampling period, s.
    sampling
        ``"assumed: "`` and the reason for the sampling period.
    """

    name: str
    caption: str
    models: Mapping[str, str]
    values: Mapping[str, Value]
    step: float
    sampling: str
    stop_time: float = PERIOD  # s, V: one turn of the ellipse

    def system(self, fmus: Mapping[str, Path]) -> System:
        """The system that is run, with the reasons for its assumed values, from FMU files by model identifier."""
        files = {component: fmus[identifier] for component, identifier in self.models.items()}
        system = System.connected_by_name(self.name, files, step=self.step, stop_time=self.stop_time)
        numbers = {path: value.number for path, value in self.values.items()}
        assumptions = {path: value.origin for path, value in self.values.items() if value.assumed}
        sampled = [component.name for component in system.components if component.sample_time is not None]
        assumptions |= {f"{name}.{SAMPLE_TIME}": self.sampling for name in sampled}
        return replace(system.set(numbers).with_sample_time(self.step), assumptions=assumptions)


def _vector(path: str, numbers: tuple[float, ...], origin: str) -> dict[str, Value]:
    return {f"{path}[{i + 1}]": Value(number, origin) for i, number in enumerate(numbers)}


def _both(path: str, number: float, origin: str) -> dict[str, Value]:
    return _vector(path, (number, number), origin)


_WALL_REASON = (
    "assumed: vertical and left of the origin, so that the tip meets it on the far side of the ellipse;"
    " -1.4 m works too"
)
_ARM_AND_WALL = {
    **_vector("plant.m", TRUE_MASSES, "V"),
    **_vector("plant.l", ARM.link_lengths, "V"),
    # q2 = arccos(1.5^2/2 - 1) and q1 = -q2/2 put the tip at (1.5, 0); dq gives it (0, pi) m/s.
    **_vector(
        "plant.q_start",
        ARM.q,
        "assumed: section V states the tip's start, (1.5, 0); elbow bent by q2 > 0",
    ),
    **_vector("plant.dq_start", ARM.dq, "V"),
    "plant.gravity": Value(0.0, "assumed: the plane of motion is horizontal"),
    **_vector("plant.wall_normal", WALL_NORMAL, _WALL_REASON),
    "plant.wall_offset": Value(WALL_OFFSET, _WALL_REASON),
    "plant.K_f": Value(WALL_STIFFNESS, "V"),
    "plant.D_f": Value(0.0, "V: a stiffness alone"),
    "plant.mu": Value(0.0, "V: no friction along the wall"),
    **_vector("trajectory.semi_axis", SEMI_AXIS, "V"),
    "trajectory.period": Value(PERIOD, "V"),
    **_vector("trajectory.wall_normal", WALL_NORMAL, _WALL_REASON),
    "trajectory.wall_offset": Value(WALL_OFFSET, _WALL_REASON),
    "trajectory.depth": Value(
        DEPTH, "assumed: K depth = 40 N of steady force; the paper draws a small straight segment"
    ),
}
_PERFECT_SENSOR = {"sensor.noise_std": Value(0.0, "V"), "sensor.noise_bound": Value(0.0, "V")}
_TARGET = {
    **_both("controller.M", TARGET_INERTIA, "V"),
    **_both("controller.K", TARGET_STIFFNESS, "V"),
    **_vector("controller.l", ARM.link_lengths, "V"),
    "controller.gravity": Value(0.0, "assumed: as in the plant"),
}
_CRITICAL_DAMPING = _both("controller.B", 2.0 * math.sqrt(TARGET_INERTIA * TARGET_STIFFNESS), "V: B = 2 sqrt(M K)")
_MODELS = {
    "trajectory": "VirtualTrajectory",
    "sensor": "ForceSensor",
    "controller": "HoganImpedance",
    "actuator": "Actuator",
    "plant": "Plant",
}
_CONVENTIONAL_SAMPLING = "assumed: 10 kHz; section V does not say how its simulation was sampled"


_CONVENTIONAL = {**_ARM_AND_WALL, **_PERFECT_SENSOR, **_TARGET, **_CRITICAL_DAMPING}

ADAPTIVE_SAMPLING = (
    "assumed: practically continuous; with 1e-4 s the chatter of F_c in contact drags m2_hat off by about 40 %"
    " (docs/calibration.md)"
)
_CHOSEN = "assumed: chosen by the procedure of docs/calibration.md, the same for Figs. 5 to 7"
_ADAPTIVE = {
    **_ARM_AND_WALL,
    **_TARGET,
    **_both("controller.B", ADAPTIVE_DAMPING, "V"),
    **_both("controller.Psi", PSI, _CHOSEN),
    "sensor.noise_bound": Value(NOISE_BOUND, "V: 15 % of the peak contact force; of Fig. 5 without noise"),
    "sensor.noise_std": Value(NOISE_BOUND / 3, "assumed: the maximum of a normal noise at three sigma"),
    "sensor.contact_gated": Value(1, "assumed: no noise without contact, as in the figures' free motion"),
    "sensor.seed": Value(SEED, "assumed: any; the claims are measured over 30 seeds"),
}
_CRAIG = {
    "controller.Gamma[2]": Value(GAMMA_CRAIG, _CHOSEN),
    "controller.noise_bound": Value(NOISE_BOUND, "(21): delta bounds the sensor's error"),
    "controller.gamma_margin": Value(GAMMA_MARGIN, _CHOSEN),
    "controller.gamma_eps": Value(GAMMA_EPS, _CHOSEN),
}
_SATURATION = _vector("actuator.tau_max", TORQUE_LIMITS, "V: 75 % of the largest torque of Fig. 5")
UNSATURATED = {"actuator.tau_max[1]": NO_TORQUE_LIMIT, "actuator.tau_max[2]": NO_TORQUE_LIMIT}
"""Start values that switch the torque limits of a scenario off, N.m."""


def _known_masses(m2: float) -> dict[str, Value]:
    return _vector("controller.p_start", (TRUE_MASSES[0], m2, 0.0, 0.0, 0.0, 0.0), "V")


def _conventional(name: str, caption: str, m2: float) -> Scenario:
    values = {**_CONVENTIONAL, **_known_masses(m2)}
    return Scenario(name, caption, _MODELS, values, CONVENTIONAL_STEP, _CONVENTIONAL_SAMPLING)


def _adaptive(name: str, caption: str, controller: str, values: Mapping[str, Value]) -> Scenario:
    models = {**_MODELS, "controller": controller}
    numbers = {**_ADAPTIVE, **_known_masses(WRONG_M2), **values}
    return Scenario(name, caption, models, numbers, ADAPTIVE_STEP, ADAPTIVE_SAMPLING)


CRAIG, SLOTINE_LI = "CraigAdaptiveImpedance", "SlotineLiAdaptiveImpedance"
SPONG_ORTEGA = "SpongOrtegaAdaptiveImpedance"

SCENARIOS = {
    scenario.name: scenario
    for scenario in (
        _conventional("fig2", f"Conventional impedance control with the true m2 = {TRUE_M2:g} kg", TRUE_M2),
        _conventional("fig3", "The TIRT versus the virtual trajectory", TRUE_M2),
        _conventional("fig4", f"Conventional impedance control with m2 = {WRONG_M2:g} kg", WRONG_M2),
        _adaptive("fig5", "Algorithm 1 without saturation", CRAIG, _CRAIG),
        _adaptive("fig6", "Algorithm 1 with saturation", CRAIG, {**_CRAIG, **_SATURATION}),
        _adaptive(
            "fig7",
            "Algorithm 2",
            SLOTINE_LI,
            {
                "controller.Gamma[2]": Value(GAMMA_SLOTINE_LI, _CHOSEN),
                **_both("controller.K_d", K_D, _CHOSEN),
                **_SATURATION,
            },
        ),
    )
}
"""The paper's figures."""

VARIANTS = {
    scenario.name: scenario
    for scenario in (
        _adaptive("spong-ortega", "Algorithm 1 with one fixed inverse", SPONG_ORTEGA, _CRAIG),
        Scenario(
            "ideal",
            "Conventional control with the true mass, a perfect sensor and the damping of Figs. 5 to 7",
            _MODELS,
            {
                **_ARM_AND_WALL,
                **_PERFECT_SENSOR,
                **_TARGET,
                **_both("controller.B", ADAPTIVE_DAMPING, "V"),
                **_known_masses(TRUE_M2),
            },
            ADAPTIVE_STEP,
            ADAPTIVE_SAMPLING,
        ),
    )
}
"""Runs that the claims need besides the figures."""
