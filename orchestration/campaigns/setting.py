"""What the runs of a study have in common besides its design: systems, measures, times, algorithm."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from orchestration.campaigns.design.design import Design, Pointing, pointing
from orchestration.campaigns.design.factor import Factor, Target, target
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.execution.campaign import Job
from orchestration.campaigns.measuring.measure import Measure
from orchestration.campaigns.measuring.named_measures import fitted
from orchestration.errors import StudyError
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.names import suggestion
from orchestration.master.simulate import prepare
from orchestration.master.walls import WALLS, different_walls
from orchestration.system.system import System

SEEN_FOR_WALLS = 33
"""Runs of a study, spread evenly, that are asked whether their walls differ; the warning names one of them."""


@dataclass(frozen=True)
class Setting:
    """What the runs of a study have in common.

    Attributes
    ----------
    systems
        Variants of the system by name.
    measures
        Measures as they were given, their formulas with names of arrays.
    stop_time, step
        Stop time and communication step, s, if the study gives its own; else those of each system.
    algorithm
        Name of the algorithm.
    isolation
        Components in processes of their own; None lets the engine decide.
    """

    systems: Mapping[str, System]
    measures: tuple[Measure, ...]
    stop_time: float | None
    step: float | None
    algorithm: str
    isolation: Isolation | None

    def variant(self, name: str | None) -> str:
        """The name of a variant, after a check that there is one of that name.

        Raises
        ------
        StudyError
            If there is none, or no name is given though there are several.
        """
        if name is None and len(self.systems) == 1:
            return next(iter(self.systems))
        if name not in self.systems:
            msg = f"The study has no variant system = {name!r}; {suggestion(str(name), self.systems)}"
            raise StudyError(msg)
        return str(name)

    def targets(self, factors: Sequence[Factor]) -> list[Target]:
        """What factors set in the first system, after a check that they set something in every system.

        Raises
        ------
        StudyError, SystemDescriptionError
            If a factor does not fit a system.
        """
        found = [[target(system, factor) for factor in factors] for system in self.systems.values()]
        for targets in found:
            pointing(targets, None)
        return found[0]

    def task(self, variant: str, factors: Sequence[Factor]) -> tuple[Task, Pointing]:
        """What the runs of a variant have in common, and what makes points of numbers and values of the factors.

        Raises
        ------
        SystemDescriptionError
            If there is no communication step or no stop time.
        """
        system = self.systems[variant]
        targets = [target(system, factor) for factor in factors]
        step = None if any(t.sets_step for t in targets) else system.run_step(self.step)
        varied, pointed = pointing(targets, step)
        measures = tuple(fitted(measure, system) for measure in self.measures)
        stop_time = float(system.run_stop_time(self.stop_time))
        return Task(system, varied, measures, stop_time, self.algorithm, self.isolation), pointed

    def job(self, variant: str, design: Design) -> Job:
        """The runs of a variant in a design."""
        task, pointed = self.task(variant, design.factors)
        each = len(design) // len(design.variants)
        first = each * design.variants.index(variant)
        numbers = range(first, first + each)
        varies = any(target(task.system, factor).sets_step for factor in design.factors)
        step = None if varies else task.system.run_step(self.step)
        return Job(task, numbers, lambda some: pointed(some, design.values(some)), step)


def require_runnable(job: Job) -> None:
    """Check that a system can be run as asked, and warn once of what `simulate` would warn of for each run.

    Raises
    ------
    SystemDescriptionError
        If it cannot.
    """
    task, system, step = job.task, job.task.system, job.step
    if step is None and system.step is None:
        first = job.points(np.array([job.numbers.start]))
        system, step = task.system_of(first.values[0]), float(first.steps[0])
    if any(path.partition(".")[2].partition("[")[0] in WALLS for path in task.varied):
        system, step = _with_different_walls(job)
    prepare(system, task.stop_time, step, task.algorithm, isolate=task.isolation)


def _with_different_walls(job: Job) -> tuple[System, float]:
    """A run of a study, among some, whose components have different walls, or else the first: system and step, s."""
    some = np.unique(np.linspace(job.numbers.start, job.numbers.stop - 1, SEEN_FOR_WALLS).round().astype(int))
    points = job.points(some)
    systems = [job.task.system_of(values) for values in points.values]
    chosen = next((i for i, system in enumerate(systems) if different_walls(system)), 0)
    return systems[chosen], float(points.steps[chosen])
