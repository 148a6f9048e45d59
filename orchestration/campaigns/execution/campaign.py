"""Makes the runs of a study: what is known comes from the store, the rest from an engine, in chunks."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from orchestration.campaigns.engines.engine import Executor, Outcomes, Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.execution.chunks import Chunks

LOOKED_UP = 2**20
"""Runs that are looked up in the store at once; each time all of its files are read."""


@dataclass(frozen=True)
class Job:
    """The runs of one variant.

    Attributes
    ----------
    task
        What the runs have in common.
    numbers
        Numbers of the runs, a range.
    points
        Makes the points of some runs of their numbers.
    step
        Communication step of all runs, s; None if they vary it.
    """

    task: Task
    numbers: range
    points: Callable[[np.ndarray], Points]
    step: float | None


@dataclass(eq=False)
class Rows:
    """What became of all runs, by their numbers.

    Attributes
    ----------
    measured
        Measures, float64, shape (n, n_measures); NaN where a run failed or was not made.
    made
        Whether a run was made, bool, shape (n,).
    messages
        Sentences of the runs that failed.
    """

    measured: np.ndarray
    made: np.ndarray
    messages: dict[int, str] = field(default_factory=dict)

    @classmethod
    def empty(cls, runs: int, measures: int) -> "Rows":
        """Rows of which none was made."""
        return cls(np.full((runs, measures), np.nan), np.zeros(runs, dtype=bool))

    def add(self, outcomes: Outcomes) -> None:
        """Take up outcomes."""
        self.measured[outcomes.numbers] = outcomes.measured
        self.made[outcomes.numbers] = True
        self.messages.update(
            (int(number), message)
            for number, message in zip(outcomes.numbers, outcomes.messages, strict=True)
            if message
        )


class Keeper(Protocol):
    """Keeps what became of runs beyond the life of this process."""

    def found(self, task: Task, points: Points) -> Outcomes:
        """Return what became of those runs that were made before."""
        ...

    def keep(self, task: Task, points: Points, outcomes: Outcomes) -> None:
        """Keep what became of runs; it is durable when the call returns."""
        ...


def make_runs(
    jobs: Sequence[Job],
    rows: Rows,
    executor: Callable[[Task], Executor],
    report: Callable[[Outcomes, bool], None],
    keeper: Keeper | None = None,
) -> None:
    """Make all runs that the keeper does not have.

    Parameters
    ----------
    rows
        Takes up what became of the runs.
    executor
        Gives the workers for a task.
    report
        Is called with outcomes, and whether they were made before.
    keeper
        Keeps outcomes; without one they are in the rows only.

    Raises
    ------
    KeyboardInterrupt
        After an interrupt, when the chunks that were being made are finished and kept. A second interrupt stops at
        once.
    """
    if keeper is not None:
        for job in jobs:
            for points in _parts(job, np.asarray(job.numbers)):
                outcomes = keeper.found(job.task, points)
                rows.add(outcomes)
                report(outcomes, True)
    for job in jobs:
        left = np.asarray(job.numbers)[~rows.made[job.numbers.start : job.numbers.stop]]
        if not len(left):
            continue
        workers = executor(job.task)

        def take(outcomes: Outcomes, job: Job = job) -> None:
            if keeper is not None:
                keeper.keep(job.task, job.points(outcomes.numbers), outcomes)
            rows.add(outcomes)
            report(outcomes, False)

        try:
            chunks = Chunks(left, job.points, lambda workers=workers: workers.workers, workers.chunk_time)
            make_chunks(chunks, workers, take)
        finally:
            workers.close()


def _parts(job: Job, numbers: np.ndarray) -> Iterator[Points]:
    """Points of many runs, some at a time."""
    for begin in range(0, len(numbers), LOOKED_UP):
        yield job.points(numbers[begin : begin + LOOKED_UP])


def make_chunks(chunks: Chunks, workers: Executor, take: Callable[[Outcomes], None]) -> None:
    """Make the runs of all chunks; an interrupt ends the making when the chunks at work are finished and taken.

    Raises
    ------
    KeyboardInterrupt
        At the end, after an interrupt.
    """
    made = workers.map(chunks)
    interrupt: KeyboardInterrupt | None = None
    while True:
        try:
            outcomes = next(made, None)
            if outcomes is None:
                break
            take(outcomes)
        except KeyboardInterrupt as error:
            if interrupt is not None:
                raise
            interrupt = error
            chunks.stop()
    if interrupt is not None:
        raise interrupt
