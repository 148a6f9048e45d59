"""Tries a setting of the open values: makes the runs that the sentences of Section V are about, and measures them.

Some numbers follow from runs, as the paper says, so the runs form a chain:

1. Fig. 5 without noise gives the peak force, and a share of the peak is the bound of the noise.
2. Conventional control with the true mass and a perfect sensor gives the ideal force.
3. Fig. 5 with the first seed gives the largest torques, and 75 % of them are the limits.
4. Figs. 6 and 7 have these limits. The variant with a fixed inverse has none.

Fig. 7 with a fixed mass, without adaptation, shows what adaptation is worth. Figs. 2 to 4 need no noise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from orchestration.paper import settings
from orchestration.paper.calibrations import Setting
from orchestration.paper.laboratory import Job
from orchestration.paper.measure import (
    ESTIMATE,
    RECORDED,
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
SILENT = {"sensor.noise_std": 0.0, "sensor.noise_bound": 0.0, "controller.noise_bound": 0.0}
FIXED_MASS = {"controller.Gamma[2]": 0.0}
FIGURES = ("fig5", "fig6", "fig7")
FIRST_SEED = 1


@dataclass(frozen=True)
class Trial:
    """What was measured at a setting.

    Attributes
    ----------
    runs
        Summaries over the seeds of ``fig5``, ``fig6``, ``fig7`` and ``spong-ortega``.
    fixed_mass
        Summary of Fig. 7 without adaptation.
    noise_bound
        Bound of the sensor's error, N.
    torque_limits
        Limits of the actuators, N.m, shape (2,).
    """

    runs: Mapping[str, Sequence[Summary]]
    fixed_mass: Summary
    noise_bound: float
    torque_limits: np.ndarray

    def alone(self, number: int) -> "Trial":
        """The trial with one of its seeds alone."""
        runs = {name: [summaries[min(number, len(summaries) - 1)]] for name, summaries in self.runs.items()}
        return Trial(runs, self.fixed_mass, self.noise_bound, self.torque_limits)


@dataclass(frozen=True)
class Bench:
    """Makes the runs of a setting."""

    laboratory: Runner
    setting: Setting

    def noise_bound(self) -> float:
        """The bound of the sensor's error, N."""
        result = self._run("fig5", {**settings.craig(self.setting, 0.0), **UNSATURATED, **SILENT}, TOUCH)
        return self.setting["noise_share"] * contact(result).peak

    def ideal_force(self) -> np.ndarray:
        """F_ext of the ideal run, N, shape (n_rows, 2)."""
        return self._run("ideal", {}, FORCE)["plant.F_ext"]

    def torque_limits(self, bound: float, seed: int = FIRST_SEED) -> np.ndarray:
        """Limits of the actuators, N.m, shape (2,), from Fig. 5 with a seed of the noise."""
        torque = at_ticks(self.noisy("fig5", bound, seed, UNSATURATED), "controller.tau_cmd")
        largest = np.abs(torque).max(axis=0)
        return settings.torque_limits(largest, largest_norm(torque), self.setting["torque_reading"])

    def noisy(self, name: str, bound: float, seed: int, changes: Mapping[str, float]) -> Result:
        """A run with noise, with further start values."""
        if name == "fig7":
            gains = settings.slotine_li(self.setting)
        elif name == "spong-ortega":
            gains = settings.fixed_inverse(self.setting, bound)
        else:
            gains = settings.craig(self.setting, bound)
        noise = {**settings.sensor(self.setting, bound), "sensor.seed": float(seed)}
        return self._run(name, {**noise, **gains, **changes}, (*RECORDED, ESTIMATE))

    def trial(self, seeds: Sequence[int], fixed_inverse_seeds: int = 1) -> Trial:
        """Make the runs for some seeds; the variant with a fixed inverse for the first few of them.

        Raises
        ------
        SimulationError
            If a run fails.
        NoContactError
            If the tip never touches the wall in a run.
        """
        bound, ideal = self.noise_bound(), self.ideal_force()
        torque_limits = self.torque_limits(bound)
        limits = settings.limits(torque_limits)
        plan = {"fig5": UNSATURATED, "fig6": limits, "fig7": limits, "spong-ortega": UNSATURATED}
        runs = {
            name: [
                summarize(self.noisy(name, bound, seed, allowed), ideal)
                for seed in (seeds[:fixed_inverse_seeds] if name == "spong-ortega" else seeds)
            ]
            for name, allowed in plan.items()
        }
        fixed = summarize(self.noisy("fig7", bound, FIRST_SEED, {**limits, **FIXED_MASS}), ideal)
        return Trial(runs, fixed, bound, torque_limits)

    def _run(self, name: str, changes: Mapping[str, float], record: tuple[str, ...]) -> Result:
        job = Job(name, {**settings.place(self.setting), **changes}, self.setting["sample_time"])
        return self.laboratory.run(job, record)
