"""Runs scenarios as native libraries: the bits of `orchestration.simulate`, without its preparations for each run."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import Protocol

import numpy as np

from orchestration.containers.native.program import NativeProgram
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.paper.laboratory import Job
from orchestration.paper.scenarios import ALL_SCENARIOS
from orchestration.results.result import Result


class Runner(Protocol):
    """Runs jobs, as `orchestration.paper.laboratory.Laboratory` does."""

    def run(self, job: Job, record: Collection[str]) -> Result:
        """Run one job.

        Raises
        ------
        SimulationError
        """
        ...


@dataclass(frozen=True)
class NativeLaboratory:
    """Runs jobs in native libraries, with FMU files by model identifier. Threads may share it.

    Jobs of a scenario that change the same start values, and show the same columns, share a library.
    """

    fmus: Mapping[str, Path]
    _programs: dict[tuple[object, ...], NativeProgram] = field(default_factory=dict, init=False)
    _lock: Lock = field(default_factory=Lock, init=False)

    def run(self, job: Job, record: Collection[str]) -> Result:
        """Run one job.

        Raises
        ------
        SimulationError
            If the run fails.
        """
        program = self._program(job, tuple(record))
        scenario = ALL_SCENARIOS[job.scenario]
        step = job.sample_time or scenario.step
        values = np.array([job.changes.get(path, step) for path in program.varied])
        return program.result(values, step, job.stop_time or scenario.stop_time)

    def _program(self, job: Job, record: tuple[str, ...]) -> NativeProgram:
        """The library of a job, whose periods and changed start values are varied."""
        key = (job.scenario, tuple(sorted(job.changes)), record)
        with self._lock:
            if key not in self._programs:
                system = ALL_SCENARIOS[job.scenario].system(self.fmus)
                sampled = [c.name for c in system.components if c.sample_time is not None]
                varied = (*sorted(job.changes), *(f"{name}.{SAMPLE_TIME}" for name in sampled))
                self._programs[key] = NativeProgram.of(system, varied=varied, record=record)
            return self._programs[key]
