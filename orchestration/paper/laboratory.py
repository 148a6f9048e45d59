"""Runs scenarios with varied numbers, one on each core: the compiled loop releases the GIL."""

import os
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from orchestration.errors import SimulationError
from orchestration.master.simulate import Options, simulate
from orchestration.paper.cases import case_of
from orchestration.paper.measure import NoContactError, Summary, recorded, summarize
from orchestration.paper.scenarios import ALL_SCENARIOS
from orchestration.results.result import Result

SEEDS = tuple(range(1, 31))
Outcome = Summary | SimulationError | NoContactError


@dataclass(frozen=True)
class Job:
    """A run to make: a scenario with some start values changed, by ``component.variable``.

    Attributes
    ----------
    sample_time
        Communication step and sampling period, s; the scenario's if None.
    stop_time
        End of the run, s; the scenario's if None.
    start_time
        Begin of the run, s.
    """

    scenario: str
    changes: Mapping[str, float] = field(default_factory=dict)
    sample_time: float | None = None
    stop_time: float | None = None
    start_time: float = 0.0


class Runner(Protocol):
    """Runs jobs, as `orchestration.paper.laboratory.Laboratory` does."""

    def run(self, job: Job, record: Collection[str]) -> Result:
        """Run one job.

        Raises
        ------
        SimulationError
            If the run fails.
        """
        ...


@dataclass(frozen=True)
class Laboratory:
    """Runs jobs, with FMU files by model identifier."""

    fmus: Mapping[str, Path]

    def run(self, job: Job, record: Collection[str] | None = None) -> Result:
        """Run one job.

        Raises
        ------
        SimulationError
            If the run fails.
        """
        scenario = ALL_SCENARIOS[job.scenario]
        system = scenario.system(self.fmus).set(job.changes)
        if job.sample_time is not None:
            system = system.with_sample_time(job.sample_time)
        system = replace(system, start_time=job.start_time)
        return simulate(system, stop_time=job.stop_time, options=Options(record=record, strict=True))

    def results(self, jobs: Sequence[Job], record: Collection[str]) -> list[Result]:
        """Run many jobs.

        Raises
        ------
        SimulationError
            Of the first job that fails.
        """
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(lambda job: self.run(job, record), jobs))

    def summaries(self, jobs: Sequence[Job], ideal_force: np.ndarray | None = None) -> list[Outcome]:
        """Summaries of many jobs; in the place of a run that fails, or never touches the wall, stands its error."""

        def work(job: Job) -> Outcome:
            try:
                return summarize(self.run(job, recorded(case_of(job.scenario).shape)), ideal_force)
            except (SimulationError, NoContactError) as error:
                return error

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(work, jobs))
