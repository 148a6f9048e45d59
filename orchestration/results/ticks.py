"""Finds the rows of a result that belong to the ticks of a sampled component."""

import numpy as np

from orchestration.results.columns import Columns, TicksMissingError

TICK_TOLERANCE = 1e-9
"""By which a row may miss a tick, in sampling periods."""


def tick_rows(columns: Columns, name: str) -> np.ndarray | None:
    """Rows at the instants of ticks, without the last; None for a component that is not sampled.

    Raises
    ------
    TicksMissingError
        If ticks were not recorded.
    """
    component = name.partition(".")[0]
    if component in columns.steps_per_tick:
        return np.arange(0, len(columns.time) - 1, columns.steps_per_tick[component])
    period = columns.sample_times.get(component)
    if period is None:
        return None
    position = (columns.time[:-1] - columns.time[0]) / period
    rows = np.flatnonzero(np.abs(position - np.round(position)) <= TICK_TOLERANCE * np.maximum(1, position))
    expected = (columns.time[-1] - columns.time[0]) / period
    if len(rows) < np.ceil(expected - TICK_TOLERANCE * max(1.0, expected)):
        msg = f"{name}: not every tick of {period:g} s is recorded; record every step."
        raise TicksMissingError(msg)
    return rows
