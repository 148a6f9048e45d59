"""The fast engine: the system is one native library in this process, and one call of it makes many runs."""

import math
from collections.abc import Sequence

import numpy as np

from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.measuring.measure import measured
from orchestration.containers.native.program import NativeProgram
from orchestration.errors import SimulationError, SystemDescriptionError


class NativeEngine:
    """Makes the runs of a task by a native library, with the bits of `simulate`.

    Formulas are reduced within the library, so that no rows are kept. A function of a result gets the columns that it
    needs, and then formulas are evaluated on these.

    Parameters
    ----------
    task
        What the runs have in common.

    Raises
    ------
    ContainerError
        If the system cannot be a native library, or the library does not show what is varied or measured.
    """

    name = "native"

    def __init__(self, task: Task) -> None:
        self.task = task
        self._by_rows = any(measure.formula is None for measure in task.measures)
        formulas = () if self._by_rows else tuple(m.formula for m in task.measures if m.formula is not None)
        self._formulas = formulas
        wanted = dict.fromkeys(reduction for formula in formulas for reduction in formula.reductions)
        self._places = {reduction: place for place, reduction in enumerate(wanted)}
        self.program = NativeProgram.of(
            task.system,
            task.algorithm,
            varied=task.varied,
            reductions=tuple(wanted),
            record=_recorded(task) if self._by_rows else (),
        )

    def make(self, points: Points) -> Outcomes:
        """Make runs; see `orchestration.campaigns.engines.engine.Engine`."""
        if self._by_rows:
            return self._make_by_rows(points)
        task = self.task
        runs = self.program.runs(points.values, points.steps, task.stop_time, task.system.start_time)
        columns = [
            formula.combine([runs.reduced[:, self._places[reduction]] for reduction in formula.reductions])
            for formula in self._formulas
        ]
        numbers = np.column_stack([np.broadcast_to(column, len(points)) for column in columns])
        failed = np.array([message != "" for message in runs.messages], dtype=bool)
        return Outcomes(points.numbers, np.where(failed[:, None], np.nan, numbers), runs.messages)

    def close(self) -> None:
        """Free nothing: the library stays, since a process may use it again."""

    def _make_by_rows(self, points: Points) -> Outcomes:
        rows = [self._row(values, float(step)) for values, step in zip(points.values, points.steps, strict=True)]
        numbers = np.array([row for row, _ in rows], dtype=np.float64)
        return Outcomes(points.numbers, numbers, tuple(message for _, message in rows))

    def _row(self, values: np.ndarray, step: float) -> tuple[Sequence[float], str]:
        """Measures of one run, and why it failed."""
        task = self.task
        try:
            result = self.program.result(values, step, task.stop_time, task.system.start_time)
        except (SimulationError, SystemDescriptionError) as error:
            return (math.nan,) * len(task.measure_names), str(error)
        return measured(task.measures, result)


def _recorded(task: Task) -> tuple[str, ...]:
    """Columns that the measures of a task need, all outputs included if one of them does not say what it needs."""
    return task.outputs if task.record is None else task.record
