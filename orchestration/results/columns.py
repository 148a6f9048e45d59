"""Plain columns of recorded numbers over time, as files of results keep them.

The columns have no methods. `orchestration.results.result` adds methods.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import OrchestrationError

TIME = "time"
"""Name of the first column of every file, which holds the communication points."""

LATENESS = "lateness"
"""Name of the column of a run that keeps step with a clock: by how many seconds each row was made after it was due."""

MESSAGES = "messages"
"""Key of the metadata with what FMUs logged, as JSON of a list of texts."""

COMPLETE, ENDED, FAILED, INTERRUPTED = "complete", "ended", "failed", "interrupted"
"""What became of the run that recorded the numbers."""


class TicksMissingError(OrchestrationError):
    """A result does not have the rows of all ticks of a sampled component."""


@dataclass(frozen=True)
class Columns:
    """Values of named columns at increasing times.

    Attributes
    ----------
    time
        Communication points, s, shape (n_rows,).
    names
        Columns of numbers as ``component.variable``, without time; the last one of a paced run is `LATENESS`.
    rows
        Values, float64, shape (n_rows, n_columns), in the units of the columns. Booleans and Integers are
        stored as numbers.
    units
        Unit of each column. The text is empty where the FMU declares no unit.
    steps_per_tick
        Number of steps per sampling period, by the name of a sampled component.
    metadata
        Texts by key that describe the run, such as its system and algorithm.
    sample_times
        Sampling periods, s, by the name of a sampled component.
    status
        ``complete``; ``ended`` if a component ended the simulation before the stop time; ``failed`` or
        ``interrupted`` where the rows are those before.
    message
        Why the status is not ``complete``, as a sentence.
    texts
        Columns of recorded Strings by ``component.variable``, arrays of objects of type str, shape (n_rows,). A file
        has them after the columns of numbers.
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
    texts: Mapping[str, np.ndarray] = field(default_factory=dict)
