"""Makes the runs that the claims are measured on, each once."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orchestration.paper.calibrations import CHOSEN_CALIBRATION, FIRST
from orchestration.paper.cases import IDEAL, PLANAR_CASE, Case
from orchestration.paper.laboratory import SEEDS, Job, Laboratory, Outcome
from orchestration.paper.lyapunov import Parameter
from orchestration.paper.measure import Summary, at_ticks, free_error, norms
from orchestration.paper.numbers import LARGEST_PSI
from orchestration.paper.saturation import SATURATION_COLUMNS
from orchestration.paper.scenarios import UNSATURATED
from orchestration.paper.settings import limits, torque_limits
from orchestration.results.result import Result

PSI_GRID = tuple(LARGEST_PSI * 10.0 ** ((k - 6.1) / 6) for k in range(7))  # 1/s, a decade that suits both algorithms
GAMMA_GRID_FACTORS = tuple(10.0 ** (k / 3) for k in range(-3, 4))  # of the scenario's gain
K_D_GRID = PLANAR_CASE.dampings  # N.s/m
DIVISORS = (1, 10, 100)
PERIODS = PLANAR_CASE.periods  # s
TOUCH = ("plant.F_ext", "plant.x")  # what `contact` needs
FORCE = ("plant.F_ext[1]", "plant.F_ext[2]")
ADAPTIVE = ("fig5", "fig6", "fig7", "spong-ortega")
GAIN, NOISE_PERIOD = "controller.Gamma[2]", "sensor.noise_period"


@dataclass(frozen=True)
class Evidence:
    """The runs that claims are measured on: those of the figures, and further ones that are made when first asked for.

    Attributes
    ----------
    results
        Runs of the figures, ``fig2`` to ``fig7``, with all outputs.
    case
        The arm.
    """

    laboratory: Laboratory
    results: Mapping[str, Result]
    case: Case = PLANAR_CASE

    @cached_property
    def ideal_force(self) -> np.ndarray:
        """Contact force with the true mass and a perfect sensor, N, shape (n_rows, m)."""
        return self.laboratory.run(Job(self.case.runs[IDEAL]), self.case.columns("plant.F_ext"))["plant.F_ext"]

    @cached_property
    def noise(self) -> Mapping[str, list[Summary]]:
        """Summaries of the adaptive scenarios over the noise seeds `SEEDS`.

        Raises
        ------
        SimulationError
            If a run fails: then the figures' settings are no good.
        """
        return self._over_seeds("", self.ideal_force)

    @cached_property
    def noise_at_first(self) -> Mapping[str, list[Summary]]:
        """Summaries as in `noise`, at the earlier calibration.

        Raises
        ------
        SimulationError
            If a run fails.
        """
        suffix = f"-{FIRST.name}"
        return self._over_seeds(suffix, self.laboratory.run(Job(f"ideal{suffix}"), FORCE)["plant.F_ext"])

    @cached_property
    def no_coriolis(self) -> list[Summary]:
        """Summaries of algorithm 2 without the term C_x s over the noise seeds `SEEDS`.

        Raises
        ------
        SimulationError
            If a run fails.
        """
        jobs = [Job("fig7-no-coriolis", {"sensor.seed": seed}) for seed in SEEDS]
        return [_required(outcome) for outcome in self.laboratory.summaries(jobs, self.ideal_force)]

    @cached_property
    def saturated_at_first(self) -> Result:
        """The run of fig6 at the earlier calibration."""
        return self.laboratory.run(Job(f"fig6-{FIRST.name}"), SATURATION_COLUMNS)

    def _over_seeds(self, suffix: str, ideal_force: np.ndarray) -> Mapping[str, list[Summary]]:
        """Summaries by the name of a figure, whose scenarios have a suffix."""
        names = [f"{self.case.runs[name]}{suffix}" for name in ADAPTIVE]
        jobs = [Job(name, {"sensor.seed": seed}) for name in names for seed in SEEDS]
        found = [_required(outcome) for outcome in self.laboratory.summaries(jobs, ideal_force)]
        return {name: found[i * len(SEEDS) :][: len(SEEDS)] for i, name in enumerate(ADAPTIVE)}

    def start_without_adaptation(self, suffix: str = "") -> float:
        """Largest |e| of fig7 before the first contact if m2_hat stays at its wrong start, m.

        Parameters
        ----------
        suffix
            Of the scenario's name, such as ``-first``.
        """
        record = self.case.columns("plant.F_ext", "controller.e")
        changes = {**self.case.gains("fig7", 0.0), **self.case.unsaturated}
        return free_error(self.laboratory.run(Job(f"{self.case.runs['fig7']}{suffix}", changes), record))

    @cached_property
    def sensitivity(self) -> Mapping[str, list[tuple[float, float, Summary | None]]]:
        """Summaries of both algorithms over Psi and a factor on Gamma; None instead of a summary if a run failed."""
        grid = [(psi, factor) for psi in PSI_GRID for factor in GAMMA_GRID_FACTORS]
        table = {}
        for name in ("fig5", "fig7"):
            nominal = self.scenario_value(name, GAIN)
            jobs = [
                Job(
                    name,
                    {
                        "controller.Psi[1]": psi,
                        "controller.Psi[2]": psi,
                        GAIN: factor * nominal,
                        **UNSATURATED,
                    },
                )
                for psi, factor in grid
            ]
            outcomes = self.laboratory.summaries(jobs, self.ideal_force)
            table[name] = [
                (psi, factor, outcome if isinstance(outcome, Summary) else None)
                for (psi, factor), outcome in zip(grid, outcomes, strict=True)
            ]
        return table

    @cached_property
    def divisors(self) -> Mapping[str, list[Summary]]:
        """Summaries of both algorithms at the update divisors `DIVISORS`."""
        return {
            name: [
                _required(s)
                for s in self.laboratory.summaries(
                    [Job(name, {"controller.update_divisor": n}) for n in DIVISORS], self.ideal_force
                )
            ]
            for name in ("fig5", "fig7")
        }

    @cached_property
    def sampled(self) -> list[Result]:
        """Runs of fig5 at the sampling periods of the case."""
        case = self.case
        record = [*case.columns("controller.e", "controller.e_star", *TOUCH), *case.by_joint("controller.tau_cmd")]
        jobs = [Job(case.runs["fig5"], self._same_noise(), sample_time=period) for period in case.periods]
        return self.laboratory.results(jobs, [*record, *case.estimates])

    @cached_property
    def saturated_finely(self) -> Result:
        """A run of fig6 at the shortest of `PERIODS`, whose limits come from the run of fig5 at this period."""
        torques = at_ticks(self.sampled[-1], "controller.tau_cmd")
        reading = CHOSEN_CALIBRATION.values["torque_reading"]
        allowed = torque_limits(np.abs(torques).max(axis=0), float(norms(torques).max()), reading)
        job = Job("fig6", {**self._same_noise(), **limits(allowed)}, sample_time=PERIODS[-1])
        return self.laboratory.run(job, SATURATION_COLUMNS)

    def _same_noise(self) -> Mapping[str, float]:
        """Start values that give the same noise at every period of the case."""
        held = self.scenario_value("fig5", NOISE_PERIOD)
        longest = self.case.periods[0]
        return {NOISE_PERIOD: max(1, round(held / longest)) * longest}

    @cached_property
    def damped_from_wrong(self) -> list[Result]:
        """Runs of fig7 without torque limits at the gains K_d of the case."""
        return self._damped({})

    @cached_property
    def damped_from_true(self) -> list[Result]:
        """Runs of fig7 as `damped_from_wrong`, with the true parameters known from the start."""
        return self._damped({f"controller.p_start[{number}]": value for number, value in self.case.true.items()})

    @cached_property
    def damped_in_proportion(self) -> list[Result]:
        """Runs of fig7 as `damped_from_wrong`, with a Gamma that grows in proportion to K_d."""
        return self._damped({}, in_proportion=True)

    def _damped(self, changes: Mapping[str, float], *, in_proportion: bool = False) -> list[Result]:
        case, own = self.case, self.scenario_value("fig7", "controller.K_d[1]")
        record = [*case.columns("controller.s", "controller.e", *TOUCH), *case.by_joint("plant.q"), *case.estimates]
        jobs = []
        for K_d in case.dampings:
            gains = case.gains("fig7", K_d / own) if in_proportion else {}
            jobs.append(Job(case.runs["fig7"], {**case.damping(K_d), **gains, **case.unsaturated, **changes}))
        return self.laboratory.results(jobs, record)

    def scenario_value(self, figure: str, path: str) -> float:
        """The start value of a variable in the run of a figure."""
        return self.case.scenario(figure).values[path].number

    def parameters(self, figure: str, factor: float = 1.0) -> list[Parameter]:
        """The parameters that are adapted in the run of a figure, with Gamma times a factor."""
        gains = self.case.gains(figure, factor).values()
        return [Parameter(*one) for one in zip(self.case.estimates, self.case.true.values(), gains, strict=True)]


def _required(outcome: Outcome) -> Summary:
    if isinstance(outcome, Summary):
        return outcome
    raise outcome
