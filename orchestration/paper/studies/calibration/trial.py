"""Tries a setting of the open values: makes the runs that the sentences of Section V are about, and measures them.

Some numbers follow from runs, as the paper says, so the runs form a chain:

1. Fig. 5 without noise gives the peak force, and a share of the peak is the bound of the noise.
2. Conventional control with the true mass and a perfect sensor gives the ideal force.
3. Fig. 5 with the first seed gives the largest torques, and 75 % of them are the limits.
4. Figs. 6 and 7 have these limits. The variant with a fixed inverse has none.

Fig. 7 with a fixed mass, without adaptation, shows what adaptation is worth. Figs. 2 to 4 need no noise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from orchestration.paper import settings
from orchestration.paper.calibrations import Setting
from orchestration.paper.laboratory import Job, Runner
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
from orchestration.paper.studies.runs_at import FORCE, SILENT, TOUCH
from orchestration.results.result import Result

WITHOUT_ADAPTATION = {"controller.Gamma[2]": 0.0}
FIGURES = ("fig5", "fig6", "fig7")
FIRST_SEED = 1
STATE = ("plant.q[1]", "plant.q[2]", "plant.dq[1]", "plant.dq[2]")
RECORDED_HERE = (*RECORDED, ESTIMATE, *STATE)
BEFORE, AFTER = 0.01, 0.12  # s of a window before the first and after the last touch; C6 asks for 0.1 s


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

    def noisy(
        self,
        name: str,
        bound: float,
        seed: int,
        changes: Mapping[str, float],
        *,
        span: tuple[float, float] | None = None,
    ) -> Result:
        """A run with noise, with further start values."""
        if name == "fig7":
            gains = settings.slotine_li(self.setting)
        elif name == "spong-ortega":
            gains = settings.fixed_inverse(self.setting, bound)
        else:
            gains = settings.craig(self.setting, bound)
        noise = {**settings.sensor(self.setting, bound), "sensor.seed": float(seed)}
        return self._run(name, {**noise, **gains, **changes}, RECORDED_HERE, span)

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
        fixed = summarize(self.noisy("fig7", bound, FIRST_SEED, {**limits, **WITHOUT_ADAPTATION}), ideal)
        return Trial(runs, fixed, bound, torque_limits)

    def sketch(self, seeds: Sequence[int]) -> Trial:
        """As `trial`, at a fraction of its cost: with noise, only the time around the contact is run.

        Until the tip touches the wall, all seeds are alike. So the runs of a figure begin shortly before the touch,
        where its run with the first seed is then. They draw other errors than runs from the start do.
        """
        bound, ideal = self.noise_bound(), self.ideal_force()
        torque_limits = self.torque_limits(bound)
        limits = settings.limits(torque_limits)
        craig, slotine_li = (
            Window.of(self.noisy(name, bound, FIRST_SEED, UNSATURATED), ideal) for name in ("fig5", "fig7")
        )
        runs = {
            name: [
                window.summary(self.noisy(name, bound, seed, {**allowed, **window.state}, span=window.span))
                for seed in seeds
            ]
            for name, window, allowed in (
                ("fig5", craig, UNSATURATED),
                ("fig6", craig, limits),
                ("fig7", slotine_li, limits),
            )
        }
        runs["spong-ortega"] = [summarize(self.noisy("spong-ortega", bound, FIRST_SEED, UNSATURATED), ideal)]
        fixed = summarize(self.noisy("fig7", bound, FIRST_SEED, {**limits, **WITHOUT_ADAPTATION}), ideal)
        return Trial(runs, fixed, bound, torque_limits)

    def _run(
        self, name: str, changes: Mapping[str, float], record: tuple[str, ...], span: tuple[float, float] | None = None
    ) -> Result:
        begin, end = span or (0.0, None)
        job = Job(name, {**settings.place(self.setting), **changes}, self.setting["sample_time"], end, begin)
        return self.laboratory.run(job, record)


@dataclass(frozen=True)
class Window:
    """The time around the contact of a run.

    Attributes
    ----------
    span
        Begin and end, s.
    state
        Start values at the begin.
    ideal
        F_ext of the ideal run in the window, N, shape (n_rows, 2).
    free
        The summary of the whole run, with the largest torques before the window.
    """

    span: tuple[float, float]
    state: Mapping[str, float]
    ideal: np.ndarray
    free: Summary

    @classmethod
    def of(cls, result: Result, ideal: np.ndarray) -> "Window":
        """The window of a run from its start."""
        touch = contact(result)
        begin, end = (round(1e3 * t) / 1e3 for t in (touch.first - BEFORE, touch.last + AFTER))
        first, last = (int(np.argmin(np.abs(result.time - t))) for t in (begin, end))
        ticks = result.tick_times(ESTIMATE) < result.time[first]
        state = {f"{name[:-3]}_start{name[-3:]}": float(result[name][first]) for name in STATE}
        state["controller.p_start[2]"] = float(result.at_ticks(ESTIMATE)[np.count_nonzero(ticks)])
        torque = np.abs(at_ticks(result, "controller.tau_cmd")[ticks]).max(axis=0)
        free = replace(summarize(result, ideal), torque=torque)
        return cls((begin, end), state, ideal[first : last + 1], free)

    def summary(self, result: Result) -> Summary:
        """The summary of a run of the window, with that of the whole run outside of it."""
        found, free = summarize(result, self.ideal), self.free
        return replace(
            found,
            m2_settled=free.m2_settled,
            m2_at_contact=free.m2_at_contact,
            e_start=free.e_start,
            e_free=free.e_free,
            e_max=max(found.e_max, free.e_start),
            torque=np.maximum(found.torque, free.torque),
            end=free.end,
        )
