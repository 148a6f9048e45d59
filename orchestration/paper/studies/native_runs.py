"""Runs scenarios as native libraries: the bits of `orchestration.simulate`, without its preparations for each run."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from threading import Lock

import numpy as np

from adaptimp_fmu.files.parts import has
from orchestration.containers.native.program import NativeProgram
from orchestration.fmi.codes import STRING
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.scenarios import ALL_SCENARIOS
from orchestration.results.result import Result
from orchestration.system.system import System

Start = Mapping[str, float]
"""Start values by ``component.variable``."""


@dataclass(frozen=True)
class NativeLaboratory(Laboratory):
    """Runs jobs in native libraries, with FMU files by model identifier. Threads may share it.

    A library takes every parameter as a value of a run. So all jobs whose systems are of the same FMUs, and show the
    same columns, share a library, which is compiled once. A job that shows everything is run by the master. So is every
    job where no compiler is installed, which takes longer and gives the same bits.
    """

    compiles: bool = field(default_factory=lambda: has("ziglang"))
    _systems: dict[str, tuple[System, Start]] = field(default_factory=dict, init=False)
    _programs: dict[tuple[object, ...], NativeProgram] = field(default_factory=dict, init=False)
    _lock: Lock = field(default_factory=Lock, init=False)

    def run(self, job: Job, record: Collection[str] | None = None) -> Result:
        """Run one job.

        Raises
        ------
        SimulationError
            If the run fails.
        ContainerError
            If a native library cannot change a start value of the job, or has no such column.
        """
        if record is None or not self.compiles:
            return super().run(job)
        with self._lock:
            system, start = self._system(job.scenario)
            program = self._program(job, tuple(record))
        step = job.sample_time or system.run_step()
        given = {**start, **dict.fromkeys(_periods(system), step), **job.changes}
        values = np.array([given[path] for path in program.varied], float)
        return program.result(values, step, job.stop_time or system.run_stop_time(), job.start_time)

    def _system(self, scenario: str) -> tuple[System, Start]:
        """The system of a scenario, and the start values of its parameters."""
        if scenario not in self._systems:
            system = ALL_SCENARIOS[scenario].system(self.fmus)
            self._systems[scenario] = system, _start(system)
        return self._systems[scenario]

    def _program(self, job: Job, record: tuple[str, ...]) -> NativeProgram:
        """The library of a job, whose parameters are varied, and what else the job changes."""
        system, start = self._system(job.scenario)
        more = sorted(set(job.changes) - set(start))
        key = (job.scenario, *more, record)
        if key not in self._programs:
            self._programs[key] = NativeProgram.of(system, varied=(*start, *more), record=record)
        return self._programs[key]


def _start(system: System) -> Start:
    """Start values of all parameters that are numbers, sampling periods among them."""
    return {
        f"{component.name}.{name}": float(component.start.get(name, variable.start or 0.0))
        for component in system.components
        for name, variable in component.description.variables.items()
        if variable.causality == "parameter" and variable.type != STRING
    }


def _periods(system: System) -> list[str]:
    """Sampling periods of the sampled components, as ``component.variable``."""
    return [f"{name}.{SAMPLE_TIME}" for name in system.sample_times]
