"""Makes a run of a campaign alone, as `simulate` makes it."""

from collections.abc import Sequence

import numpy as np

from orchestration.campaigns.engines.isolated import isolation_of
from orchestration.campaigns.engines.task import Task
from orchestration.master.simulate import simulate
from orchestration.results.result import Result


def single_run(
    task: Task, values: Sequence[float] | np.ndarray, step: float, record: Sequence[str] | None = None
) -> Result:
    """Run the system of a task once.

    Parameters
    ----------
    values
        Values of the varied start values, shape (n_varied,).
    step
        Communication step, s.
    record
        Columns to record; all outputs if None.

    Raises
    ------
    OrchestrationError
        If the run fails.
    """
    return simulate(
        task.system_of(values),
        task.stop_time,
        float(step),
        task.algorithm,
        record=record,
        isolate=isolation_of(task),
    )
