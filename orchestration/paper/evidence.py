"""Makes the runs that the claims are measured on, each once."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orchestration.paper.calibrations import CHOSEN_CALIBRATION, FIRST
from orchestration.paper.laboratory import SEEDS, Job, Laboratory, Outcome
from orchestration.paper.measure import ESTIMATE, Summary, at_ticks, free_error, norms
from orchestration.paper.numbers import LARGEST_PSI, TRUE_M2
from orchestration.paper.saturation import SATURATION_COLUMNS
from orchestration.paper.scenarios import SCENARIOS, UNSATURATED
from orchestration.paper.settings import limits, torque_limits
from orchestration.results.result import Result

PSI_GRID = tuple(LARGEST_PSI * 10.0 ** ((k - 6.1) / 6) for k in range(7))  # 1/s, a decade that suits both algorithms
GAMMA_GRID_FACTORS = tuple(10.0 ** (k / 3) for k in range(-3, 4))  # of the scenario's gain
K_D_GRID = (30.0, 100.0, 300.0, 1000.0, 3000.0)  # N.s/m
DIVISORS = (1, 10, 100)
PERIODS = (4e-5, 2e-5, 1e-5, 5e-6)  # s
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
        Runs of the scenarios, by name, with all outputs.
    """

    laboratory: Laboratory
    results: Mapping[str, Result]

    @cached_property
    def ideal_force(self) -> np.ndarray:
        """Contact force with the true mass and a perfect sensor, N, shape (n_rows, 2)."""
        return self.laboratory.run(Job("ideal"), FORCE)["plant.F_ext"]

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
        jobs = [Job(f"{name}{suffix}", {"sensor.seed": seed}) for name in ADAPTIVE for seed in SEEDS]
        found = [_required(outcome) for outcome in self.laboratory.summaries(jobs, ideal_force)]
        return {name: found[i * len(SEEDS) :][: len(SEEDS)] for i, name in enumerate(ADAPTIVE)}

    def start_without_adaptation(self, suffix: str = "") -> float:
        """Largest |e| of fig7 before the first contact if m2_hat stays at its wrong start, m.

        Parameters
        ----------
        suffix
            Of the scenario's name, such as ``-first``.
        """
        record = (*FORCE, "controller.e[1]", "controller.e[2]")
        return free_error(self.laboratory.run(Job(f"fig7{suffix}", {GAIN: 0.0, **UNSATURATED}), record))

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
        """Runs of fig5 at the sampling periods `PERIODS`."""
        names = ("controller.e", "controller.e_star", "controller.tau_cmd", *TOUCH)
        record = [f"{n}[{i}]" for n in names for i in (1, 2)]
        jobs = [Job("fig5", self._same_noise(), sample_time=period) for period in PERIODS]
        return self.laboratory.results(jobs, [*record, ESTIMATE])

    @cached_property
    def saturated_finely(self) -> Result:
        """A run of fig6 at the shortest of `PERIODS`, whose limits come from the run of fig5 at this period."""
        torques = at_ticks(self.sampled[-1], "controller.tau_cmd")
        reading = CHOSEN_CALIBRATION.values["torque_reading"]
        allowed = torque_limits(np.abs(torques).max(axis=0), float(norms(torques).max()), reading)
        job = Job("fig6", {**self._same_noise(), **limits(allowed)}, sample_time=PERIODS[-1])
        return self.laboratory.run(job, SATURATION_COLUMNS)

    def _same_noise(self) -> Mapping[str, float]:
        """Start values that give the same noise at every period of `PERIODS`."""
        held = self.scenario_value("fig5", NOISE_PERIOD)
        return {NOISE_PERIOD: max(1, round(held / PERIODS[0])) * PERIODS[0]}

    @cached_property
    def damped_from_wrong(self) -> list[Result]:
        """Runs of fig7 without torque limits at the gains `K_D_GRID`."""
        return self._damped({})

    @cached_property
    def damped_from_true(self) -> list[Result]:
        """Runs of fig7 as `damped_from_wrong`, with the true mass known from the start."""
        return self._damped({"controller.p_start[2]": TRUE_M2})

    @cached_property
    def damped_in_proportion(self) -> list[Result]:
        """Runs of fig7 as `damped_from_wrong`, with a Gamma that grows in proportion to K_d."""
        per_damping = self.scenario_value("fig7", GAIN) / self.scenario_value("fig7", "controller.K_d[1]")
        return self._damped({}, per_damping)

    def _damped(self, changes: Mapping[str, float], per_damping: float | None = None) -> list[Result]:
        record = [f"{n}[{i}]" for n in ("controller.s", "controller.e", "plant.q", *TOUCH) for i in (1, 2)]
        jobs = []
        for damping in K_D_GRID:
            both = {"controller.K_d[1]": damping, "controller.K_d[2]": damping}
            gain = {} if per_damping is None else {GAIN: per_damping * damping}
            jobs.append(Job("fig7", {**both, **gain, **UNSATURATED, **changes}))
        return self.laboratory.results(jobs, [*record, ESTIMATE])

    @staticmethod
    def scenario_value(name: str, path: str) -> float:
        """The start value of a variable in a scenario."""
        return SCENARIOS[name].values[path].number


def _required(outcome: Outcome) -> Summary:
    if isinstance(outcome, Summary):
        return outcome
    raise outcome
