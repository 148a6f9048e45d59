"""Evaluates points that are not known in advance, such as those that an optimizer asks for."""

import weakref
from collections.abc import Sequence
from typing import Any

import numpy as np

from orchestration.campaigns.design.factor import Factor, target
from orchestration.campaigns.engines.choice import engine_for
from orchestration.campaigns.execution.campaign import Rows, make_chunks
from orchestration.campaigns.execution.chunks import Chunks
from orchestration.campaigns.execution.local import LocalExecutor
from orchestration.campaigns.setting import Setting


class Evaluator:
    """Makes runs of one variant at values of certain factors; its engine stays ready as long as the evaluator is there.

    Parameters
    ----------
    setting
        What the runs have in common.
    variant
        Name of the variant of the system.
    factors
        Factors whose values are given.
    """

    def __init__(self, setting: Setting, variant: str, factors: Sequence[Factor]) -> None:
        self.task, self._pointed = setting.task(variant, factors)
        self.targets = [target(self.task.system, factor) for factor in factors]
        self.engine = engine_for(self.task)
        weakref.finalize(self, self.engine.close)

    def rows(self, columns: Sequence[Any], workers: int) -> Rows:
        """Make runs.

        Parameters
        ----------
        columns
            Values of each factor, sequences of one length.
        workers
            Number of threads.
        """
        checked = [self._column(k, column) for k, column in enumerate(columns)]
        values = np.column_stack(checked) if checked else np.empty((1, 0))
        rows = Rows.empty(len(values), len(self.task.measure_names))
        numbers = np.arange(len(values))
        if len(values) == 1:
            rows.add(self.engine.make(self._pointed(numbers, values)))
            return rows
        executor = LocalExecutor(self.engine, min(workers, len(values)))
        chunks = Chunks(numbers, lambda some: self._pointed(some, values[some]), lambda: executor.workers)
        try:
            make_chunks(chunks, executor, rows.add)
        finally:
            executor.wait()
        return rows

    def _column(self, place: int, column: Any) -> np.ndarray:
        """Values of a factor as numbers that its variables can take."""
        array = np.asarray(column)
        if array.dtype.kind in "iuf":
            return self.targets[place].checked(array.astype(np.float64))
        return self.targets[place].numbers(array.tolist())
