"""Predicted stability over the factors of a study: a table whose measure is the growth rate of small deviations."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from orchestration.analysis.stability.verdict import judged
from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.execution.campaign import Job, Rows
from orchestration.campaigns.table import Columns
from orchestration.errors import OrchestrationError

GROWTH_RATE = "growth_rate"
"""Name of the measure."""


def predicted(jobs: Sequence[Job], columns: Columns, at: float) -> tuple[Columns, Rows]:
    """Predict the growth rate for each run of a study, one after the other.

    Parameters
    ----------
    jobs
        Runs of each variant.
    columns
        Columns of the study's table.
    at
        Time of the operating point, s.

    Returns
    -------
    tuple
        Columns and rows of a table with the only measure `GROWTH_RATE`, 1/s.
    """
    rows = Rows.empty(sum(len(job.numbers) for job in jobs), 1)
    for job in jobs:
        points = job.points(np.array(job.numbers, dtype=np.int64))
        for number, values, step in zip(points.numbers, points.values, points.steps, strict=True):
            rate, message = _growth_rate(job, values, float(step), at)
            rows.add(Outcomes(np.array([number]), np.array([[rate]]), (message,)))
    units = {name: unit for name, unit in columns.units.items() if name not in columns.measures}
    return replace(columns, measures=(GROWTH_RATE,), units=units | {GROWTH_RATE: "1/s"}), rows


def _growth_rate(job: Job, values: np.ndarray, step: float, at: float) -> tuple[float, str]:
    """Growth rate, 1/s, and an empty text; or NaN and a sentence that says why there is none."""
    task = job.task
    try:
        point = judged(task.system_of(values), step, task.algorithm, at=at, isolation=task.isolation)
    except OrchestrationError as error:
        return math.nan, str(error)
    rate = math.log(max(point.radius, 1e-300)) / point.step
    # A radius that exceeds 1 by less than its own error is no growth.
    return (min(rate, 0.0) if point.stable else rate), ""
