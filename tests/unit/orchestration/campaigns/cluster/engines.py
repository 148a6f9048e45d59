"""Engines whose numbers can be predicted, and which end their worker, count or fail as a test asks for."""

import importlib
import os
import signal
from pathlib import Path

import numpy as np

from orchestration import Result, scenario
from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.measuring.measure import Measure
from orchestration.errors import StudyError


def reach(result: Result) -> float:
    """Measure that these engines do not evaluate."""
    return float(result["plant.x[1]"].max())


def process(result: Result) -> float:
    """Measure in whose place these engines say which process has made the run."""
    return float(len(result.time))


def a_task() -> Task:
    """A task with two start values that rows vary, and two measures."""
    measures = Measure.of(reach), Measure.of(process)
    return Task(scenario("fig7"), ("plant.K_f", "sensor.seed"), measures, stop_time=2.0)


def some_points(count: int) -> Points:
    """Points whose rows all differ."""
    numbers = np.arange(count)
    return Points(numbers, np.column_stack([1e4 + numbers / 3, 1.0 + numbers]), np.full(count, 1e-4))


def in_chunks(points: Points, size: int) -> list[Points]:
    """Points in chunks of a number of rows."""
    return [points[first : first + size] for first in range(0, len(points), size)]


class Arithmetic:
    """Engine that multiplies the varied values of a run, and adds the start value that the task sets."""

    name = "arithmetic"

    def __init__(self, task: Task) -> None:
        self.task = task

    def make(self, points: Points) -> Outcomes:
        """Make the runs."""
        stiffness = task_value(self.task)
        products = points.values.prod(axis=1) + stiffness
        processes = np.full(len(points), float(os.getpid()))
        return Outcomes(points.numbers, np.column_stack([products, processes]), ("",) * len(points))

    def close(self) -> None:
        """Nothing is held."""


def task_value(task: Task) -> float:
    """A start value of the system, which an engine reads from the FMU or the package."""
    return float(task.start_values["controller.K[1]"])


class Deadly(Arithmetic):
    """Engine that kills its process at one run."""

    def __init__(self, task: Task, number: int) -> None:
        super().__init__(task)
        self.number = number

    def make(self, points: Points) -> Outcomes:
        """Make the runs, or die."""
        if self.number in points.numbers:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().make(points)


class Closing(Arithmetic):
    """Engine that leaves a file in a folder when it is closed."""

    def __init__(self, task: Task, folder: Path) -> None:
        super().__init__(task)
        self.folder = folder

    def close(self) -> None:
        """Leave the file; an engine that is closed twice fails."""
        (self.folder / f"{id(self)}").touch(exist_ok=False)


def refuse(task: Task) -> Arithmetic:
    """Refuse a task, as an engine does that cannot make its runs."""
    msg = f"System {task.system.name} has no engine here."
    raise StudyError(msg)


def import_something(task: Task) -> Arithmetic:
    """Need a module that is not there."""
    importlib.import_module("no_such_module")
    return Arithmetic(task)


class Measuring(Arithmetic):
    """Engine that asks the functions of the measures, for numbers instead of results."""

    def make(self, points: Points) -> Outcomes:
        """Make the runs."""
        functions = [measure.function for measure in self.task.measures]
        rows = [[function(float(n)) for function in functions if function] for n in points.numbers]  # pyright: ignore[reportArgumentType]
        return Outcomes(points.numbers, np.array(rows), ("",) * len(points))
