"""Makes the runs that the claims are measured on, each once."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orchestration.paper.laboratory import SEEDS, Job, Laboratory, Outcome
from orchestration.paper.measure import ESTIMATE, Summary
from orchestration.paper.numbers import TRUE_M2
from orchestration.paper.scenarios import SCENARIOS, UNSATURATED
from orchestration.results.result import Result

PSI_GRID = tuple(100.0 * 10.0 ** (k / 3) for k in range(-3, 4))  # 1/s, two decades
GAMMA_GRID_FACTORS = tuple(10.0 ** (k / 3) for k in range(-3, 4))  # of the scenario's gain
K_D_GRID = (30.0, 100.0, 300.0, 1000.0, 3000.0)  # N.s/m
DIVISORS = (1, 10, 100)
PERIODS = (4e-5, 2e-5, 1e-5)  # s
TOUCH = ("plant.F_ext", "plant.x")  # what `contact` needs


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
        record = ("plant.F_ext[1]", "plant.F_ext[2]")
        return self.laboratory.run(Job("ideal"), record)["plant.F_ext"]

    @cached_property
    def noise(self) -> Mapping[str, list[Summary]]:
        """Summaries of the adaptive scenarios over the noise seeds `SEEDS`.

        Raises
        ------
        SimulationError
            If a run fails: then the figures' settings are no good.
        """
        outcomes = {}
        for name in ("fig5", "fig6", "fig7", "spong-ortega"):
            jobs = [Job(name, {"sensor.seed": seed}) for seed in SEEDS]
            outcomes[name] = [_required(s) for s in self.laboratory.summaries(jobs, self.ideal_force)]
        return outcomes

    @cached_property
    def sensitivity(self) -> Mapping[str, list[tuple[float, float, Summary | None]]]:
        """Summaries of both algorithms over Psi and a factor on Gamma; None instead of a summary if a run failed."""
        grid = [(psi, factor) for psi in PSI_GRID for factor in GAMMA_GRID_FACTORS]
        table = {}
        for name in ("fig5", "fig7"):
            gain = "controller.Gamma[2]"
            nominal = self.scenario_value(name, gain)
            jobs = [
                Job(
                    name,
                    {
                        "controller.Psi[1]": psi,
                        "controller.Psi[2]": psi,
                        gain: factor * nominal,
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
        record = [f"controller.{n}[{i}]" for n in ("e", "e_star", "p_hat") for i in (1, 2)]
        return self.laboratory.results([Job("fig5", sample_time=period) for period in PERIODS], record)

    @cached_property
    def damped_from_wrong(self) -> list[Result]:
        """Runs of fig7 without torque limits at the gains `K_D_GRID`."""
        return self._damped({})

    @cached_property
    def damped_from_true(self) -> list[Result]:
        """Runs of fig7 as `damped_from_wrong`, with the true mass known from the start."""
        return self._damped({"controller.p_start[2]": TRUE_M2})

    def _damped(self, changes: Mapping[str, float]) -> list[Result]:
        record = [f"{n}[{i}]" for n in ("controller.s", "controller.e", "plant.q", *TOUCH) for i in (1, 2)]
        jobs = [
            Job("fig7", {"controller.K_d[1]": gain, "controller.K_d[2]": gain, **UNSATURATED, **changes})
            for gain in K_D_GRID
        ]
        return self.laboratory.results(jobs, [*record, ESTIMATE])

    @staticmethod
    def scenario_value(name: str, path: str) -> float:
        """The start value of a variable in a scenario."""
        return SCENARIOS[name].values[path].number


def _required(outcome: Outcome) -> Summary:
    if isinstance(outcome, Summary):
        return outcome
    raise outcome
