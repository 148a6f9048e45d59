"""What makes the runs of a campaign: points go in, rows of numbers and sentences come out.

An engine makes runs in this process. An executor hands chunks of points to engines, here or on other machines.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True, eq=False)
class Points:
    """Values of the varied start values, one row for each run.

    Attributes
    ----------
    numbers
        Numbers of the runs in their study, int64, shape (n,).
    values
        Values in the units of the FMUs, float64, shape (n, n_varied), in the order of `Task.varied`.
    steps
        Communication steps, s, float64, shape (n,).
    """

    numbers: np.ndarray
    values: np.ndarray
    steps: np.ndarray

    def __len__(self) -> int:
        """Number of runs."""
        return len(self.numbers)

    def __getitem__(self, part: slice | np.ndarray) -> "Points":
        """Some of the runs."""
        return Points(self.numbers[part], self.values[part], self.steps[part])


@dataclass(frozen=True, eq=False)
class Outcomes:
    """What became of runs.

    Attributes
    ----------
    numbers
        Numbers of the runs in their study, int64, shape (n,).
    measured
        Measures, float64, shape (n, n_measures), in the order of `Task.measure_names`; NaN where a run failed.
    messages
        For each run the sentence that says why it failed; empty where it succeeded.
    """

    numbers: np.ndarray
    measured: np.ndarray
    messages: tuple[str, ...]

    def __len__(self) -> int:
        """Number of runs."""
        return len(self.numbers)

    def only(self, chosen: np.ndarray) -> "Outcomes":
        """Those of the runs that a bool array of shape (n,) chooses."""
        messages = tuple(itertools.compress(self.messages, chosen))
        return Outcomes(self.numbers[chosen], self.measured[chosen], messages)


class Engine(Protocol):
    """Makes the runs of one task in this process."""

    @property
    def name(self) -> str:
        """What the engine is called where it is shown, such as ``native``."""
        ...

    def make(self, points: Points) -> Outcomes:
        """Make runs, in the order of the points.

        Several threads may call it at once. A run that fails is a row with a message, never an exception.
        """
        ...

    def close(self) -> None:
        """Free what the engine holds; nothing may be made afterwards."""


class Executor(Protocol):
    """Hands chunks of points to engines."""

    @property
    def workers(self) -> int:
        """Number of chunks that can be made at the same time; it may change."""
        ...

    @property
    def chunk_time(self) -> float:
        """Time that a worker should take for a chunk, s: short for the tail, long beside the overhead of a chunk."""
        ...

    def map(self, chunks: Iterator[Points]) -> Iterator[Outcomes]:
        """Make the runs of all chunks.

        Each chunk is made once, and its outcomes come in any order. Chunks are taken as workers become free.
        """
        ...

    def close(self) -> None:
        """Stop the workers, and free what they hold."""
