"""Recorded numbers as plain columns over time: what files keep, without any behaviour."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

TIME = "time"
"""Name of the column of times, which every file has first."""

COMPLETE, FAILED, INTERRUPTED = "complete", "failed", "interrupted"
"""What became of the run that recorded the numbers."""


@dataclass(frozen=True)
class Columns:
    """Values of named columns at increasing times.

    Attributes
    ----------
    time
        Communication points, s, shape (n_rows,).
    names
        Columns as ``component.variable``, without time.
    rows
        Values, float64, shape (n_rows, n_columns); Booleans and Integers are numbers.
    units
        Unit of each column; the text is empty where the FMU declares none.
    steps_per_tick
        Number of steps per sampling period, by the name of a sampled component.
    metadata
        How the numbers came about, texts by key.
    sample_times
        Sampling periods, s, by the name of a sampled component.
    status
        ``complete``, or ``failed`` or ``interrupted`` where the rows are those before.
    message
        Why the status is not ``complete``, as a sentence.
    """

    time: np.ndarray
    names: tuple[str, ...]
    rows: np.ndarray
    units: Mapping[str, str] = field(default_factory=dict)
    steps_per_tick: Mapping[str, int] = field(default_factory=dict)
    metadata: Mapping[str, str] = field(default_factory=dict)
    sample_times: Mapping[str, float] = field(default_factory=dict)
    status: str = COMPLETE
    message: str = ""
