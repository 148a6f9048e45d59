"""The engine that steps FMUs: each thread keeps the FMUs of the system open, and makes them like new for each run.

It serves systems that cannot be one native program: with FMUs without sources, FMUs of other tools, or an algorithm
that iterates or controls its step. FMUs of other tools live in processes of their own, so that a crash costs its run.
"""

import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.isolated import foreign_components, isolation_of
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.measuring.measure import measured
from orchestration.errors import OrchestrationError, StudyError
from orchestration.master.options import Options
from orchestration.master.reruns import Reruns
from orchestration.master.reuse import Learned

LONGEST_END = 10.0  # s that runs may take to end when the engine is closed


class MasterEngine:
    """Makes the runs of a task with the master, with FMUs that stay open.

    Parameters
    ----------
    task
        What the runs have in common.
    """

    name = "master"

    def __init__(self, task: Task) -> None:
        self.task = task
        self._options = Options(record=_recorded(task), isolate=isolation_of(task))
        self._own = [name for name in task.system if name not in foreign_components(task)]
        self._learned = Learned()
        self._idle: list[Reruns] = []
        self._busy: set[Reruns] = set()
        self._change, self._closed = threading.Condition(), False

    def make(self, points: Points) -> Outcomes:
        """Make runs; see `orchestration.campaigns.engines.engine.Engine`.

        Raises
        ------
        StudyError
            If the engine is closed meanwhile, because a run that was cut off is not a failed one.
        """
        with self._runs() as runs:
            rows = [self._row(runs, values, step) for values, step in zip(points.values, points.steps, strict=True)]
        shape = (len(points), len(self.task.measure_names))
        numbers = np.array([row for row, _ in rows], np.float64).reshape(shape)
        return Outcomes(points.numbers, numbers, tuple(message for _, message in rows))

    def close(self) -> None:
        """End the runs under way and their processes, and free all FMUs; a second call does nothing."""
        with self._change:
            self._closed = True
            idle, self._idle = self._idle, []
            for runs in self._busy:
                runs.end()
        for runs in idle:
            runs.close()
        with self._change:
            self._change.wait_for(lambda: not self._busy, LONGEST_END)

    @contextmanager
    def _runs(self) -> Iterator[Reruns]:
        """FMUs for this thread alone, those of an earlier chunk if some are free."""
        with self._change:
            self._require_open()
            runs = self._idle.pop() if self._idle else self._opened()
            self._busy.add(runs)
        whole = False
        try:
            yield runs
            whole = True
        finally:
            with self._change:
                kept = whole and not self._closed
                if kept:
                    self._idle.append(runs)
            if not kept:
                runs.close()
            with self._change:
                self._busy.remove(runs)
                self._change.notify_all()

    def _opened(self) -> Reruns:
        task, shared = self.task, {"trusted": self._own, "learned": self._learned}
        return Reruns(task.system, task.stop_time, task.algorithm, self._options, **shared)

    def _row(self, runs: Reruns, values: np.ndarray, step: float) -> tuple[tuple[float, ...], str]:
        """Measures of a run, and why it failed."""
        try:
            result = runs.run(dict(zip(self.task.varied, values.tolist(), strict=True)), float(step))
        except (OrchestrationError, Warning) as error:  # a program may let warnings be errors
            self._require_open()
            return (math.nan,) * len(self.task.measure_names), str(error)
        return measured(self.task.measures, result)

    def _require_open(self) -> None:
        if self._closed:
            msg = f"System {self.task.system.name}: the campaign was ended while runs were under way; resume it."
            raise StudyError(msg)


def _recorded(task: Task) -> tuple[str, ...] | None:
    """What the measures need, and all outputs of FMUs of other tools, since one that is not finite fails a run.

    Outputs are in the order of the system, so that a failed run names the output that `simulate` names.
    """
    if task.record is None:
        return None
    foreign = foreign_components(task)
    outputs = [
        f"{component.name}.{variable.name}"
        for component in task.system.components
        for variable in component.description.of_causality("output")
    ]
    kept = [path for path in outputs if path in task.record or path.partition(".")[0] in foreign]
    return tuple(dict.fromkeys((*kept, *task.record)))
