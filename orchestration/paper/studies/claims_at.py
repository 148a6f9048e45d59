"""Runs Figs. 5 to 7 at one setting of the open values, and tells which claims hold there.

Some numbers follow from runs, as the paper says, so the runs form a chain:

1. Fig. 5 without noise gives the peak force, and a share of the peak is the bound of the noise.
2. Conventional control with the true mass and a perfect sensor gives the ideal force.
3. Fig. 5 with noise gives the largest torques, and 75 % of them are the limits.
4. Figs. 6 and 7 have these limits. The variant with a fixed inverse has none.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import SimulationError
from orchestration.paper import settings
from orchestration.paper.calibrations import Setting
from orchestration.paper.claims import criteria, judged
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.laboratory import Job
from orchestration.paper.measure import (
    ESTIMATE,
    RECORDED,
    NoContactError,
    Summary,
    at_ticks,
    contact,
    largest_norm,
    summarize,
)
from orchestration.paper.scenarios import UNSATURATED
from orchestration.paper.studies.native_runs import Runner
from orchestration.results.result import Result

FORCE = ("plant.F_ext[1]", "plant.F_ext[2]")
TOUCH = (*FORCE, "plant.x[1]", "plant.x[2]")
REFERENCE = ("controller.x_t[1]", "controller.x_t[2]", "trajectory.x_v[1]", "trajectory.x_v[2]")
SILENT = {"sensor.noise_std": 0.0, "sensor.noise_bound": 0.0, "controller.noise_bound": 0.0}
SCENARIOS = ("fig5", "fig6", "fig7", "spong-ortega")
CLEARLY = 1.1  # ratio from which an error is called clearly larger
Changes = Mapping[str, float]


@dataclass(frozen=True)
class Evidence:
    """What the runs at a setting gave.

    Attributes
    ----------
    noise
        Summaries over the seeds by scenario; a scenario of which a run failed is missing.
    torque_limits
        Limits of Fig. 6, N.m, shape (2,); None if Fig. 5 failed.
    reference
        What C13 asks of Fig. 5 with the first seed; empty if the run failed.
    failures
        The sentence of the run that failed, by scenario.
    """

    noise: Mapping[str, Sequence[Summary]] = field(default_factory=dict)
    torque_limits: np.ndarray | None = None
    reference: Mapping[Criterion, float] = field(default_factory=dict)
    failures: Mapping[str, str] = field(default_factory=dict)


def evidence_at(laboratory: Runner, setting: Setting, seeds: Sequence[int]) -> Evidence:
    """Make the runs of a setting for some seeds of the noise; the limits of torque come from the first seed."""
    runs = _Runs(laboratory, setting)
    noise: dict[str, Sequence[Summary]] = {}
    failures: dict[str, str] = {}
    torque_limits, reference = None, {}
    try:
        bound, ideal = runs.noise_bound(), runs.ideal_force()
    except (SimulationError, NoContactError) as error:
        return Evidence(failures={"fig5": str(error)})
    for name in SCENARIOS:
        if name == "fig6" and torque_limits is None:
            continue
        changes = runs.changes(name, bound, torque_limits)
        try:
            results = (runs.run(name, {**changes, "sensor.seed": seed}) for seed in seeds)
            first = next(results)
            noise[name] = [summarize(first, ideal), *(summarize(result, ideal) for result in results)]
        except (SimulationError, NoContactError) as error:
            failures[name] = str(error)
            continue
        if name == "fig5":
            torque_limits = runs.torque_limits(first)
            reference = judged.reference_in_contact(first)
    return Evidence(noise, torque_limits, reference, failures)


@dataclass(frozen=True)
class _Runs:
    """The runs at a setting."""

    laboratory: Runner
    setting: Setting

    def noise_bound(self) -> float:
        """The bound of the sensor's error, N."""
        silent = {**self.changes("fig5", 0.0, None), **SILENT}
        result = self.laboratory.run(Job("fig5", silent, self.setting["sample_time"]), TOUCH)
        return self.setting["noise_share"] * contact(result).peak

    def ideal_force(self) -> np.ndarray:
        """F_ext of the ideal run, N, shape (n_rows, 2)."""
        job = Job("ideal", settings.place(self.setting), self.setting["sample_time"])
        return self.laboratory.run(job, FORCE)["plant.F_ext"]

    def run(self, name: str, changes: Changes) -> Result:
        """A run of a scenario that shows what summaries and C13 need."""
        more = REFERENCE if name == "fig5" else ()
        job = Job(name, changes, self.setting["sample_time"])
        return self.laboratory.run(job, (*RECORDED, ESTIMATE, *more))

    def changes(self, name: str, bound: float, torque_limits: np.ndarray | None) -> Changes:
        """Start values of a scenario at the setting; without limits of torque, there are none."""
        if name == "fig7":
            controller = settings.slotine_li(self.setting)
        elif name == "spong-ortega":
            controller = settings.fixed_inverse(self.setting, bound)
        else:
            controller = settings.craig(self.setting, bound)
        limits = UNSATURATED
        if name in ("fig6", "fig7") and torque_limits is not None:
            limits = settings.limits(torque_limits)
        return {**settings.place(self.setting), **settings.sensor(self.setting, bound), **controller, **limits}

    def torque_limits(self, result: Result) -> np.ndarray:
        """Limits from a run of Fig. 5, N.m, shape (2,), as the setting reads the paper's sentence."""
        torque = at_ticks(result, "controller.tau_cmd")
        largest = np.abs(torque).max(axis=0)
        return settings.torque_limits(largest, largest_norm(torque), self.setting["torque_reading"])


def _clearly_larger(noise: judged.Noise, than: str, name: str) -> bool:
    """Whether medians of both errors in contact are clearly larger in one scenario than in another."""
    return all(
        judged.spread(noise[name], error)[0] >= CLEARLY * judged.spread(noise[than], error)[0]
        for error in (lambda s: s.e_contact, lambda s: s.force_error)
    )


def _accurate(summaries: Sequence[Summary]) -> bool:
    """Whether runs are stable and accurate, as C11 asks."""
    values = (
        (criteria.ACCURATE_FREE, [s.e_free for s in summaries]),
        (criteria.ACCURATE_CONTACT, [s.e_contact for s in summaries]),
        (criteria.M2_IN_CONTACT, [s.m2_in_contact for s in summaries]),
    )
    return judged.met(dict(values))


FIGS, PAIR = judged.FIGURES, ("fig5", "fig7")
_QUESTIONS: Mapping[str, tuple[Sequence[str], Callable[[Evidence], bool]]] = {
    "C4": (FIGS, lambda found: judged.met(judged.approach(found.noise))),
    "C5": (FIGS, lambda found: judged.met(judged.deviation(found.noise))),
    "C6": (FIGS, lambda found: judged.met(judged.recovery(found.noise))),
    "C7": (("fig5", "fig6"), lambda found: judged.met(judged.saturation(found.noise))),
    "C8": (PAIR, lambda found: judged.met(judged.torque(found.noise, np.array(found.torque_limits)))),
    "C9": (("fig7",), lambda found: judged.met(judged.free_motion(found.noise))),
    "C10": (PAIR, lambda found: judged.met(judged.contact_errors(found.noise))),
    "C13": (("fig5",), lambda found: judged.met(found.reference)),
    "C16": (("spong-ortega",), lambda found: judged.met(judged.fixed_inverse(found.noise))),
    "C7 clearly": (("fig5", "fig6"), lambda found: _clearly_larger(found.noise, "fig5", "fig6")),
    "C10 clearly": (PAIR, lambda found: _clearly_larger(found.noise, "fig5", "fig7")),
    "accurate 1": (("fig5",), lambda found: _accurate(found.noise["fig5"])),
    "accurate 2": (("fig7",), lambda found: _accurate(found.noise["fig7"])),
}
QUESTIONS = tuple(_QUESTIONS)
"""What is asked at each setting: claims, whether errors are clearly larger (C7, C10), and whether an algorithm is
stable and accurate (C11)."""


def verdicts(found: Evidence) -> dict[str, bool]:
    """Answer each of `QUESTIONS` at a setting; what needs a run that failed is answered with no."""
    answers = {
        name: all(scenario in found.noise for scenario in needed) and holds(found)
        for name, (needed, holds) in _QUESTIONS.items()
    }
    for claim in ("C7", "C10"):
        answers[f"{claim} clearly"] &= answers[claim]
    return answers
