"""Makes the paper's runs at one setting of the open values, and measures them.

Some numbers follow from runs, as the paper says, so the runs form a chain:

1. Fig. 5 without noise gives the peak force, and a share of the peak is the bound of the noise.
2. Conventional control with the true mass and a perfect sensor gives the ideal force.
3. Fig. 5 with noise gives the largest torques, and 75 % of them are the limits.
4. Figs. 6 and 7 have these limits. The variant with a fixed inverse has none.

Figs. 2 and 4 depend on the wall and on the start of the arm alone.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from orchestration.errors import SimulationError
from orchestration.paper import settings
from orchestration.paper.calibrations import Setting
from orchestration.paper.laboratory import Job, Runner
from orchestration.paper.lyapunov import CRAIG_COLUMNS, SlidingGains
from orchestration.paper.measure import (
    ESTIMATE,
    RECORDED,
    Contact,
    NoContactError,
    at_ticks,
    contact,
    largest_norm,
    summarize,
)
from orchestration.paper.saturation import SATURATION_COLUMNS
from orchestration.paper.scenarios import UNSATURATED
from orchestration.paper.studies import measured
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.troubles import errors_of, troubled_jobs
from orchestration.results.result import Result

FORCE = ("plant.F_ext[1]", "plant.F_ext[2]")
TOUCH = (*FORCE, "plant.x[1]", "plant.x[2]")
E = ("controller.e[1]", "controller.e[2]")
REFERENCE = ("controller.x_t[1]", "controller.x_t[2]", "trajectory.x_v[1]", "trajectory.x_v[2]")
SWITCHING = ("controller.beta", "controller.mu", "controller.alpha", "controller.gamma_bound")
SATURATED = ("actuator.saturated[1]", "actuator.saturated[2]")
SILENT = {"sensor.noise_std": 0.0, "sensor.noise_bound": 0.0, "controller.noise_bound": 0.0}
TORQUE_LIMITS = ("torque_limit_1", "torque_limit_2")
LIMITED = ("fig6", "fig7")  # runs with limits of torque
FREE = "fig7-free"
"""Fig. 7 without limits of torque."""
FREE_MOTION = 1.0
"""Time after which the path lies in the wall at every setting, s."""
FIXED_MASS = "fixed-mass"
"""The law of Fig. 7 without adaptation."""
CONVENTIONAL = ("fig2", "fig4")  # runs with a sampling period of their own
Numbers = Mapping[str, float]
Outcome = TypeVar("Outcome")


def row_at(
    laboratory: Runner, setting: Setting, seed: int, limits: Numbers | None = None, *, costly: bool = False
) -> Row:
    """Make the runs of a setting with a seed of the noise, and measure them.

    Parameters
    ----------
    limits
        Start values that limit the torques, if they do not come from Fig. 5 with this seed.
    costly
        Whether to make the runs at lower rates, at other gains K_d, with a sensor that fails or torques that are too
        small, and without C_x s, too, and to follow V_c through Fig. 6.

    Returns
    -------
    Row
        The numbers are those of `orchestration.paper.studies.measured.UNITS`.
    """
    chain = Chain(laboratory, setting, seed, limits=limits)
    chain.conventional()
    if chain.prepare():
        chain.adaptive()
        chain.without_adaptation()
        if costly:
            chain.at_lower_rates()
            chain.at_other_gains()
            chain.in_trouble()
            chain.without_coriolis()
            chain.saturated()
    return Row(chain.numbers, chain.failures)


@dataclass
class Chain:
    """The runs at a setting with one seed, what was measured, and what failed.

    Attributes
    ----------
    bound
        The bound of the noise, N.
    ideal
        F_ext of the ideal run, N, shape (n_rows, 2).
    limits
        Start values that limit the torques.
    """

    laboratory: Runner
    setting: Setting
    seed: int
    numbers: dict[str, float] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)
    bound: float = 0.0
    ideal: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    limits: Numbers | None = None

    def conventional(self) -> None:
        """Make the runs of Figs. 2 and 4; that of Fig. 3 is the run of Fig. 2."""
        true = self._attempt("fig2", self._true_mass)
        wrong = self._attempt("fig4", self._wrong_mass)
        if true is not None and wrong is not None:
            self._take("fig4", measured.force_difference(wrong, true))

    def prepare(self) -> bool:
        """Make the runs without noise; whether they went well."""
        silent = {**self._changes("fig5"), **SILENT}
        peak = self._attempt("silent", lambda: contact(self._run("fig5", silent, TOUCH)).peak)
        if peak is None:
            return False
        self.numbers |= {"peak": peak}
        return self.prepare_with(self.setting["noise_share"] * peak)

    def prepare_with(self, bound: float) -> bool:
        """Take a bound of the noise, N, and make the ideal run; whether it went well."""
        ideal = self._attempt("ideal", lambda: self._run("ideal", settings.place(self.setting), FORCE)["plant.F_ext"])
        if ideal is None:
            return False
        self.bound, self.ideal = bound, ideal
        self.numbers |= {"noise_bound": bound}
        return True

    def adaptive(self) -> None:
        """Make the runs of Figs. 5 to 7 and of the variant with a fixed inverse."""
        self._attempt("fig5", self._fig5)
        if self.limits is not None:
            self._attempt("fig6", lambda: self._summed_up("fig6", "fig6", self._changes("fig6"), SATURATED))
        self._attempt("fig7", lambda: self._summed_up("fig7", "fig7", self._changes("fig7"), SATURATED))
        self._attempt(FREE, self._fig7_without_limits)
        fixed_inverse = self._changes("spong-ortega")
        self._attempt("spong-ortega", lambda: self._summed_up("spong-ortega", "spong-ortega", fixed_inverse))

    def without_adaptation(self) -> None:
        """Make the run of Fig. 7 without adaptation."""
        fixed = {**self._changes("fig7"), "controller.Gamma[2]": 0.0}
        job = Job("fig7", fixed, self.setting["sample_time"], FREE_MOTION)
        self._attempt(
            FIXED_MASS, lambda: self._take(FIXED_MASS, measured.free_motion(self.laboratory.run(job, (*FORCE, *E))))
        )

    def at_lower_rates(self) -> None:
        """Make the runs of Figs. 5 and 7 in which m2_hat is updated at every tenth or hundredth tick only."""
        for name in ("fig5", "fig7"):
            for divisor in measured.DIVISORS:
                changes = {**self._changes(name), "controller.update_divisor": divisor}
                of = measured.at_divisor(name, divisor)
                self._attempt(of, lambda n=name, c=changes, of=of: self._take(of, self._error_in_contact(n, c)))

    def at_other_gains(self) -> None:
        """Make the runs of Fig. 7 without limits at other gains K_d."""
        for start, changes in measured.STARTS.items():
            for gain in measured.K_D_GRID:
                of = measured.at_gain(start, gain)
                self._attempt(of, lambda s=start, c=changes, g=gain, of=of: self._take(of, self._sliding(s, c, g)))

    def in_trouble(self) -> None:
        """Make the runs of both algorithms with a sensor that fails, and with torques far too small."""
        if self.limits is None:
            return
        for algorithm, name in ((1, "fig6"), (2, "fig7")):
            given, period = self._changes(name), self.setting["sample_time"]
            jobs = troubled_jobs(algorithm, given, [*self.limits.values()], (self.seed,), period)
            for trouble, (job,) in jobs.items():
                self._take(measured.in_trouble(algorithm, trouble), measured.trouble(errors_of(self.laboratory, job)))

    def without_coriolis(self) -> None:
        """Make the run of Fig. 7 without the term C_x s."""
        of = measured.NO_CORIOLIS
        self._attempt(of, lambda: self._summed_up(of, of, self._changes("fig7")))

    def saturated(self) -> None:
        """Follow V_c through Fig. 6."""
        if self.limits is not None:
            self._attempt("fig6", self._saturated)

    def _saturated(self) -> None:
        result = self._run("fig6", self._changes("fig6"), SATURATION_COLUMNS)
        self._take("fig6", measured.lyapunov_saturated(result, self.setting, self.bound))

    def _true_mass(self) -> Result:
        result = self._run("fig2", settings.place(self.setting), (*TOUCH, *E, *REFERENCE))
        self._take("fig2", measured.true_mass(result, contact(result), self.setting["wall_offset"]))
        return result

    def _wrong_mass(self) -> Result:
        result = self._run("fig4", settings.place(self.setting), (*TOUCH, *E))
        self._take("fig4", measured.conventional(result, contact(result)))
        return result

    def _fig5(self) -> None:
        more = (*REFERENCE, *CRAIG_COLUMNS, *SWITCHING)
        result, touch = self._summed_up("fig5", "fig5", self._changes("fig5"), more)
        if self.limits is None:
            torque = at_ticks(result, "controller.tau_cmd")
            reading = self.setting["torque_reading"]
            largest = np.abs(torque).max(axis=0)
            self.limits = settings.limits(settings.torque_limits(largest, largest_norm(torque), reading))
        self.numbers |= dict(zip(TORQUE_LIMITS, self.limits.values(), strict=True))
        self._take("fig5", measured.reference(result, touch))
        self._take("fig5", measured.lyapunov_craig(result, touch, self.setting))
        self._take("fig5", measured.switching(result, self.bound))

    def _fig7_without_limits(self) -> None:
        """The run of Fig. 7 itself if no limit was reached there."""
        if any(self.numbers.get(f"fig7.{name}", 1.0) for name in measured.SATURATION):
            self._summed_up(FREE, "fig7", {**self._changes("fig7"), **UNSATURATED})
        else:
            self._take(FREE, {name: self.numbers[f"fig7.{name}"] for name in measured.OF_NOISY})

    def _summed_up(
        self, of: str, scenario: str, changes: Numbers, more: tuple[str, ...] = ()
    ) -> tuple[Result, Contact]:
        """Make a run and take its summary, under a name that may be another than that of the scenario."""
        result = self._run(scenario, changes, tuple(dict.fromkeys((*RECORDED, ESTIMATE, *more))))
        self._take(of, measured.summary(summarize(result, self.ideal)))
        touch = contact(result)
        self._take(of, {"force_peak": touch.peak})
        if more == SATURATED:
            self._take(of, measured.saturation(result, touch))
        return result, touch

    def _error_in_contact(self, scenario: str, changes: Numbers) -> Numbers:
        result = self._run(scenario, changes, (*RECORDED, ESTIMATE))
        return {"e_contact": summarize(result).e_contact}

    def _sliding(self, start: str, changes: Numbers, gain: float) -> Numbers:
        """Bounds of s at a gain K_d."""
        scale = gain / self.setting["K_d"] if start == measured.PROPORTIONAL else 1.0
        gamma = scale * self.setting["Gamma_2"]
        given = {**changes, "controller.K_d[1]": gain, "controller.K_d[2]": gain, "controller.Gamma[2]": gamma}
        result = self._run("fig7", {**self._changes("fig7"), **UNSATURATED, **given}, measured.SLIDING)
        return measured.sliding(result, SlidingGains(self.setting["Psi_2"], gamma, gain, self.bound))

    def _changes(self, name: str) -> dict[str, float]:
        """Start values of an adaptive scenario."""
        if name == "fig7":
            controller = settings.slotine_li(self.setting)
        elif name == "spong-ortega":
            controller = settings.fixed_inverse(self.setting, self.bound)
        else:
            controller = settings.craig(self.setting, self.bound)
        limits = self.limits if name in LIMITED and self.limits is not None else UNSATURATED
        sensor = {**settings.sensor(self.setting, self.bound), "sensor.seed": self.seed}
        return {**settings.place(self.setting), **sensor, **controller, **limits}

    def _run(self, scenario: str, changes: Numbers, record: tuple[str, ...]) -> Result:
        """Make a run of a scenario with changed start values."""
        period = None if scenario in CONVENTIONAL else self.setting["sample_time"]
        return self.laboratory.run(Job(scenario, changes, period), record)

    def _take(self, of: str, numbers: Numbers) -> None:
        self.numbers |= {f"{of}.{name}": value for name, value in numbers.items()}

    def _attempt(self, of: str, work: Callable[[], Outcome]) -> Outcome | None:
        """What a piece of work gives; None, and a sentence, if a run failed or the tip never touched the wall."""
        try:
            return work()
        except (SimulationError, NoContactError) as error:
            self.failures[of] = str(error)
            return None
