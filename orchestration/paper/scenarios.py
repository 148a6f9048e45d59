"""The paper's runs: which FMUs each is made of, and its start values with their origins.

Every number is either stated in the paper, with the place, or assumed, with the reason. One set of
assumed values serves all figures of a kind; nothing is tuned per figure. The numbers that are used in
more than one place stand in `orchestration.paper.numbers`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from orchestration.paper import settings
from orchestration.paper.calibrations import CHOSEN_CALIBRATION, FIRST, Calibration
from orchestration.paper.numbers import (
    ADAPTIVE_DAMPING,
    ARM,
    CONVENTIONAL_STEP,
    FAILURES,
    NO_TORQUE_LIMIT,
    PAYLOAD,
    PAYLOAD_THRESHOLD,
    PERIOD,
    SEED,
    SEMI_AXIS,
    SPIKE_FORCE,
    TARGET_INERTIA,
    TARGET_STIFFNESS,
    TRUE_M2,
    TRUE_MASSES,
    WALL_NORMAL,
    WALL_STIFFNESS,
    WRONG_M2,
)
from orchestration.paper.scenario import Scenario, Value
from orchestration.paper.spatial_scenarios import SPATIAL

_FAILS = {"dropout": "drops out", "stuck": "sticks", "spike": "has a spike"}  # what the sensor does, by failure


_CHOSEN = "assumed: chosen by the procedure of docs/calibration.md, the same for Figs. 5 to 7"
_CALIBRATED = "assumed: chosen by the procedure of docs/calibration.md, the same for Figs. 2 to 7"
_WALL = "assumed: vertical and left of the origin, so that the tip meets it on the far side of the ellipse"
_SATURATION = 'assumed: one way to read "75 % of the maximum torque" (V) of Fig. 5; docs/calibration.md names it'
ORIGINS: Mapping[str, str] = {
    # q2 = arccos(1.5^2/2 - 1) and q1 = -q2/2 put the tip at (1.5, 0); dq gives it (0, pi) m/s.
    "plant.q_start": "assumed: section V states the tip's start, (1.5, 0); elbow bent by q2 > 0",
    "plant.dq_start": "assumed: the tip starts with the velocity of the virtual trajectory; section V states its place",
    "plant.wall_offset": _CALIBRATED,
    "plant.D_f": "assumed: section V names a stiffness alone",
    "plant.mu": "assumed: section V names no friction along the wall",
    "trajectory.wall_offset": _CALIBRATED,
    "trajectory.depth": "assumed: K depth is the steady force; chosen by the procedure of docs/calibration.md",
    "sensor.noise_bound": (
        "assumed: 15 % (V) of the peak contact force of Fig. 5 without noise bounds the norm of both components"
    ),
    "sensor.noise_std": "assumed: bound over standard deviation is chosen by the procedure of docs/calibration.md",
    "sensor.noise_period": "assumed: a draw of the noise is held for this time; 0 is one tick (docs/calibration.md)",
    "sensor.contact_gated": "assumed: no noise without contact, as in the figures' free motion",
    "controller.noise_bound": "(21): delta bounds the sensor's error",
    "controller.Psi": _CHOSEN,
    "controller.Gamma": _CHOSEN,
    "controller.K_d": _CHOSEN,
    "controller.gamma_margin": _CHOSEN,
    "controller.gamma_eps": _CHOSEN,
    "controller.acc_filter_time": "assumed: faster than an impact; a much shorter one lets the loop diverge",
    "actuator.tau_max": _SATURATION,
}
"""Origin of each number that depends on a calibration, by variable without its index."""


def _vector(path: str, numbers: tuple[float, ...], origin: str) -> dict[str, Value]:
    return {f"{path}[{i + 1}]": Value(number, origin) for i, number in enumerate(numbers)}


def _both(path: str, number: float, origin: str) -> dict[str, Value]:
    return _vector(path, (number, number), origin)


def _calibrated(numbers: Mapping[str, float]) -> dict[str, Value]:
    """Start values that a calibration gives, with their origins."""
    return {path: Value(number, ORIGINS[path.partition("[")[0]]) for path, number in numbers.items()}


_ARM_AND_WALL = {
    **_vector("plant.m", TRUE_MASSES, "V"),
    **_vector("plant.l", ARM.link_lengths, "V"),
    "plant.gravity": Value(0.0, "assumed: the plane of motion is horizontal"),
    **_vector("plant.wall_normal", WALL_NORMAL, _WALL),
    "plant.K_f": Value(WALL_STIFFNESS, "V"),
    **_vector("trajectory.semi_axis", SEMI_AXIS, "V"),
    "trajectory.period": Value(PERIOD, "V"),
    **_vector("trajectory.wall_normal", WALL_NORMAL, _WALL),
}
_PERFECT_SENSOR = {"sensor.noise_std": Value(0.0, "V"), "sensor.noise_bound": Value(0.0, "V")}
_TARGET = {
    **_both("controller.M", TARGET_INERTIA, "V"),
    **_both("controller.K", TARGET_STIFFNESS, "V"),
    **_vector("controller.l", ARM.link_lengths, "V"),
    "controller.gravity": Value(0.0, "assumed: as in the plant"),
}
_CRITICAL_DAMPING = _both("controller.B", 2.0 * math.sqrt(TARGET_INERTIA * TARGET_STIFFNESS), "V: B = 2 sqrt(M K)")
_DAMPING = _both("controller.B", ADAPTIVE_DAMPING, "V")
_SEED = {"sensor.seed": Value(SEED, "assumed: any; the claims are measured over 30 seeds")}
_MODELS = {
    "trajectory": "VirtualTrajectory",
    "sensor": "ForceSensor",
    "controller": "HoganImpedance",
    "actuator": "Actuator",
    "plant": "Plant",
}
_CONVENTIONAL_SAMPLING = "assumed: 10 kHz; section V does not say how its simulation was sampled"
ADAPTIVE_SAMPLING = (
    "assumed: practically continuous; with 1e-4 s the chatter of F_c in contact drags m2_hat off (docs/calibration.md)"
)
UNSATURATED = {"actuator.tau_max[1]": NO_TORQUE_LIMIT, "actuator.tau_max[2]": NO_TORQUE_LIMIT}
"""Start values that switch the torque limits of a scenario off, N.m."""
CRAIG, SLOTINE_LI = "CraigAdaptiveImpedance", "SlotineLiAdaptiveImpedance"
SPONG_ORTEGA = "SpongOrtegaAdaptiveImpedance"
NO_CORIOLIS = "SlotineLiAdaptiveImpedanceNoCoriolis"
FAILING_SENSOR = "FailingForceSensor"


def _known_masses(m2: float) -> dict[str, Value]:
    return _vector("controller.p_start", (TRUE_MASSES[0], m2, 0.0, 0.0, 0.0, 0.0), "V")


@dataclass(frozen=True)
class _Made:
    """Makes the scenarios at a calibration; their names end in a suffix."""

    calibration: Calibration
    suffix: str = ""

    def conventional(self, name: str, caption: str, m2: float) -> Scenario:
        """A run of Figs. 2 to 4."""
        values = {**self._common(), **_PERFECT_SENSOR, **_CRITICAL_DAMPING, **_known_masses(m2)}
        return Scenario(name + self.suffix, caption, _MODELS, values, CONVENTIONAL_STEP, _CONVENTIONAL_SAMPLING)

    def ideal(self) -> Scenario:
        """The run with which forces are compared."""
        caption = "Conventional control with the true mass, a perfect sensor and the damping of Figs. 5 to 7"
        values = {**self._common(), **_PERFECT_SENSOR, **_DAMPING, **_known_masses(TRUE_M2)}
        return self._sampled("ideal", caption, _MODELS, values)

    def algorithm_1(self, name: str, caption: str, *, saturated: bool) -> Scenario:
        """A run of Figs. 5 and 6."""
        gains = settings.craig(self.calibration.values, self.calibration.noise_bound)
        return self._adaptive(name, caption, CRAIG, {**gains, **(self._limits() if saturated else {})})

    def algorithm_2(self) -> Scenario:
        """The run of Fig. 7."""
        gains = settings.slotine_li(self.calibration.values)
        return self._adaptive("fig7", "Algorithm 2", SLOTINE_LI, {**gains, **self._limits()})

    def fixed_inverse(self) -> Scenario:
        """The variant of algorithm 1."""
        gains = settings.fixed_inverse(self.calibration.values, self.calibration.noise_bound)
        return self._adaptive("spong-ortega", "Algorithm 1 with one fixed inverse", SPONG_ORTEGA, gains)

    def adaptive(self) -> tuple[Scenario, ...]:
        """The runs of Figs. 5 to 7."""
        return (
            self.algorithm_1("fig5", "Algorithm 1 without saturation", saturated=False),
            self.algorithm_1("fig6", "Algorithm 1 with saturation", saturated=True),
            self.algorithm_2(),
        )

    def failing(self) -> tuple[Scenario, ...]:
        """Runs of both algorithms with limited torques in which the force sensor fails in the midst of the contact."""
        _, one, two = self.adaptive()
        return tuple(
            self._with_failure(scenario, f"sensor-{kind}{end}", kind)
            for scenario, end in ((two, ""), (one, "-craig"))
            for kind in FAILURES
        )

    def _with_failure(self, scenario: Scenario, name: str, kind: str) -> Scenario:
        number, duration = FAILURES[kind]
        force = SPIKE_FORCE * np.array(WALL_NORMAL)
        failure = {
            "sensor.failure": Value(number, "assumed: one of the ways in which a sensor fails"),
            "sensor.failure_start": Value(PERIOD / 2, "assumed: the midst of the contact"),
            "sensor.failure_duration": Value(duration, "assumed: a third of the contact, or a short disturbance"),
            **_vector("sensor.failure_force", tuple(force), "assumed: larger than the peak of the contact force"),
        }
        models = {**scenario.models, "sensor": FAILING_SENSOR}
        caption = f"{scenario.caption}; the force sensor {_FAILS[kind]} in the midst of the contact"
        return replace(scenario, name=name, caption=caption, models=models, values={**scenario.values, **failure})

    def with_payload(self) -> tuple[Scenario, ...]:
        """Runs of both algorithms in which half of m2 sits beyond a perfect force sensor at the wrist."""
        one, _, two = self.adaptive()
        threshold = Value(
            PAYLOAD_THRESHOLD, "assumed: above the payload's force in free motion, so that F_c acts in contact alone"
        )
        return (
            self._with_payload(one, {"controller.contact_threshold": threshold}),
            self._with_payload(two, {}),
        )

    def _with_payload(self, scenario: Scenario, further: Mapping[str, Value]) -> Scenario:
        quiet = dict.fromkeys(_PERFECT_SENSOR, Value(0.0, "assumed: none, so that the payload alone acts"))
        payload = {"plant.payload": Value(PAYLOAD, "assumed: half of m2")}
        return replace(
            scenario,
            name=f"{scenario.name}-wrist-payload",
            caption=f"{scenario.caption}; a payload of {PAYLOAD:g} kg beyond a perfect force sensor",
            models={**scenario.models, "plant": "PlantWristPayload"},
            values={**scenario.values, **quiet, **payload, **further},
            sources={"sensor.F_ext": "plant.F_wrist"},
        )

    def _adaptive(self, name: str, caption: str, controller: str, numbers: Mapping[str, float]) -> Scenario:
        noise = settings.sensor(self.calibration.values, self.calibration.noise_bound)
        values = {**self._common(), **_DAMPING, **_known_masses(WRONG_M2), **_SEED, **_calibrated({**noise, **numbers})}
        return self._sampled(name, caption, {**_MODELS, "controller": controller}, values)

    def _sampled(self, name: str, caption: str, models: Mapping[str, str], values: Mapping[str, Value]) -> Scenario:
        step = self.calibration.values["sample_time"]
        return Scenario(name + self.suffix, caption + self._where(), models, values, step, ADAPTIVE_SAMPLING)

    def _common(self) -> dict[str, Value]:
        return {**_ARM_AND_WALL, **_calibrated(settings.place(self.calibration.values)), **_TARGET}

    def _limits(self) -> dict[str, float]:
        return settings.limits(self.calibration.torque_limits)

    def _where(self) -> str:
        return f", at the calibration `{self.calibration.name}`" if self.suffix else ""


def _by_name(*scenarios: Scenario) -> dict[str, Scenario]:
    return {scenario.name: scenario for scenario in scenarios}


_CHOSEN_RUNS, _FIRST_RUNS = _Made(CHOSEN_CALIBRATION), _Made(FIRST, f"-{FIRST.name}")

SCENARIOS = _by_name(
    _CHOSEN_RUNS.conventional("fig2", f"Conventional impedance control with the true m2 = {TRUE_M2:g} kg", TRUE_M2),
    _CHOSEN_RUNS.conventional("fig3", "The TIRT versus the virtual trajectory", TRUE_M2),
    _CHOSEN_RUNS.conventional("fig4", f"Conventional impedance control with m2 = {WRONG_M2:g} kg", WRONG_M2),
    *_CHOSEN_RUNS.adaptive(),
)
"""The paper's figures."""

VARIANTS = _by_name(_CHOSEN_RUNS.fixed_inverse(), _CHOSEN_RUNS.ideal())
"""Runs that the claims need besides the figures."""

AT_FIRST = _by_name(*_FIRST_RUNS.adaptive(), _FIRST_RUNS.fixed_inverse(), _FIRST_RUNS.ideal())
"""The runs of Figs. 5 to 7 at the earlier calibration: ``fig5-first``, ``fig6-first`` and so on."""

WITHOUT_CORIOLIS = _by_name(
    replace(
        SCENARIOS["fig7"],
        name="fig7-no-coriolis",
        caption="Algorithm 2 without the term C_x s",
        models={**SCENARIOS["fig7"].models, "controller": NO_CORIOLIS},
    )
)
"""The run of Fig. 7 without the term C_x s: ``fig7-no-coriolis``."""

WITH_FAILURE = _by_name(*_CHOSEN_RUNS.failing())
"""Runs of both algorithms with a sensor that fails: ``sensor-dropout``, ``sensor-dropout-craig`` and so on."""

WITH_PAYLOAD = _by_name(*_CHOSEN_RUNS.with_payload())
"""Runs of both algorithms with a payload beyond the wrist sensor: ``fig5-wrist-payload``, ``fig7-wrist-payload``."""

PLANAR_SCENARIOS: Mapping[str, Scenario] = {
    **SCENARIOS,
    **VARIANTS,
    **AT_FIRST,
    **WITHOUT_CORIOLIS,
    **WITH_FAILURE,
    **WITH_PAYLOAD,
}
"""The runs of the paper's arm."""

ALL_SCENARIOS: Mapping[str, Scenario] = {**PLANAR_SCENARIOS, **SPATIAL}
"""Every scenario that has a name."""
