"""The plainest engine, which makes each run alone by `simulate`: what all other engines are compared with."""

import math

import numpy as np

from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.single import single_run
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.measuring.measure import measured
from orchestration.errors import OrchestrationError


class PlainEngine:
    """Makes the runs of a task one after the other, and loads everything for each of them.

    Parameters
    ----------
    task
        What the runs have in common.
    """

    name = "plain"

    def __init__(self, task: Task) -> None:
        self.task = task

    def make(self, points: Points) -> Outcomes:
        """Make runs; see `orchestration.campaigns.engines.engine.Engine`."""
        rows = [self._row(values, step) for values, step in zip(points.values, points.steps, strict=True)]
        shape = (len(points), len(self.task.measure_names))
        numbers = np.array([row for row, _ in rows], dtype=np.float64).reshape(shape)
        return Outcomes(points.numbers, numbers, tuple(message for _, message in rows))

    def close(self) -> None:
        """Free nothing, since nothing is held between runs."""

    def _row(self, values: np.ndarray, step: float) -> tuple[tuple[float, ...], str]:
        """Measures of a run, and why it failed."""
        try:
            result = single_run(self.task, values, float(step), self.task.record)
        except OrchestrationError as error:
            return (math.nan,) * len(self.task.measure_names), str(error)
        return measured(self.task.measures, result)
