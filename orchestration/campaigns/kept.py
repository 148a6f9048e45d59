"""Runs of a study that a store keeps: what is in the store is taken from there, what is made is appended."""

from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Self

import numpy as np

from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.store.row_table import RowColumns
from orchestration.campaigns.store.store import Store
from orchestration.campaigns.table import Columns


class KeptRuns:
    """Keeps the runs of a study in a store; to be used as a context manager.

    Parameters
    ----------
    store
        The store.
    study
        Identity of the study in the store.
    columns
        Columns of the study's table.
    factors
        Gives the values of the factors in some runs by column, of their numbers.
    retry_failed
        Whether runs that failed are to be made again. Where a run succeeds then, that is what the store has of it.
    """

    def __init__(
        self,
        store: Store,
        study: str,
        columns: Columns,
        factors: Callable[[np.ndarray], Mapping[str, np.ndarray]],
        *,
        retry_failed: bool = False,
    ) -> None:
        self._store, self._study, self._measures, self._factors = store, study, columns.measures, factors
        self._retry_failed = retry_failed
        units = columns.units
        factor_units = {name: units[name] for name in columns.factors}
        measure_units = {name: units[name] for name in columns.measures}
        texts = tuple(name for name in columns.all_factors if name not in factor_units)
        self._writer = store.writer(study, RowColumns(factor_units, measure_units, texts))

    def __enter__(self) -> Self:
        """Begin to keep runs."""
        self._writer.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End; what was kept stays in the store."""
        self._writer.__exit__(kind, error, trace)

    def found(self, task: Task, points: Points) -> Outcomes:
        """Return what the store has of runs; what another study made is appended to the rows of this one."""
        keys = self._store.keys(task, points)
        found = self._store.find(keys, self._measures, self._study)
        all_found = Outcomes(points.numbers, found.measured, tuple(found.messages))
        taken = found.present & ((found.messages == "") | (not self._retry_failed))
        foreign = taken & ~found.own
        self._append(keys[foreign], all_found.only(foreign))
        return all_found.only(taken)

    def keep(self, task: Task, points: Points, outcomes: Outcomes) -> None:
        """Append what became of runs; it is kept from then on, even if the process is killed."""
        self._append(self._store.keys(task, points), outcomes)

    def _append(self, keys: np.ndarray, outcomes: Outcomes) -> None:
        if len(keys):
            self._writer.append(keys, self._factors(outcomes.numbers), outcomes)
