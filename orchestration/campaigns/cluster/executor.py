"""Makes the runs of a campaign on the workers of a Dask cluster.

A task travels to each worker once; chunks of points follow, a few at a time. A worker that is lost costs nothing but
time: its chunks are made again elsewhere. The same holds for a scheduler that is restarted at the same address.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.cluster.payload import MakeEngine, Payload
from orchestration.campaigns.cluster.versions import COMPARED, require_equal
from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.task import Task
from orchestration.errors import ClusterError

if TYPE_CHECKING:
    from distributed import Client, KilledWorker

    from orchestration.campaigns.cluster.flights import Flights

PATIENCE = 300.0
"""Longest wait, s, for a scheduler that was lost, and for a worker."""


class ClusterExecutor:
    """Hands chunks of points to the workers of a Dask cluster.

    Parameters
    ----------
    task
        What the runs have in common.
    cluster
        Address of a scheduler, such as ``tcp://10.0.0.5:8786``; or a `distributed.Client`, or a `LocalCluster`, both
        of which stay as they are.
    make_engine
        Function that makes the engine of a task on a worker. Default: `engine_for`, as in this process.
    patience
        Longest wait, s, for a scheduler that was lost, and for a worker.

    Raises
    ------
    ClusterError
        If Dask is not installed, no scheduler or no worker is reached, or versions differ.
    """

    chunk_time = 0.5
    """Time, s, that a thread should take for a chunk, which costs 4 ms of the scheduler and of this process."""

    def __init__(
        self, task: Task, cluster: Any, make_engine: MakeEngine | None = None, patience: float = PATIENCE
    ) -> None:
        if find_spec("distributed") is None:
            msg = "A campaign on a cluster needs Dask; install it with pip install 'adaptimp[cluster]'."
            raise ClusterError(msg)
        from orchestration.campaigns.cluster.connection import Connection

        self._n_measures = len(task.measure_names)
        self._payload = Payload.of(task, make_engine or _default())
        self._connection = Connection(cluster, patience, self._prepare)
        self._at_work: list[Flights] = []

    @property
    def workers(self) -> int:
        """Number of threads of all workers when the scheduler was asked last, at least 1."""
        return self._connection.threads

    def map(self, chunks: Iterator[Points]) -> Iterator[Outcomes]:
        """Make the runs of all chunks, each of them once; their outcomes come in any order.

        The iterator may go on after an interrupt. Its `next` raises a `ClusterError` if the scheduler or all workers
        stay away, or a worker cannot make the runs.
        """
        return _Outcomes(self._fly, self._failed, chunks)

    def close(self) -> None:
        """Take the task back from the workers, and end the connection."""
        from orchestration.campaigns.cluster.connection import LostError

        for flights in self._at_work:
            flights.abandon()
        # A scheduler that is gone has no task; another campaign with the same task may have taken it back already.
        with suppress(LostError, OSError, ValueError):
            self._connection.client.unregister_worker_plugin(self._payload.name)
        self._connection.close()

    def _fly(self, chunks: Iterator[Points], at_once: int | None = None) -> "Flights":
        """Chunks in flight to the workers."""
        from orchestration.campaigns.cluster.flights import Flights

        flights = Flights(self._connection, self._payload.name, chunks, at_once)
        self._at_work.append(flights)
        return flights

    def _failed(self, points: Points, error: "KilledWorker") -> Outcomes:
        """The outcome of a run that ends the worker that makes it."""
        last: Any = error.last_worker
        message = (
            f"The run ended the process of its worker, {error.allowed_failures + 1} times, at last that of"
            f" {last.address}; the log of the worker may say why, such as too little memory."
        )
        return Outcomes(points.numbers, np.full((1, self._n_measures), np.nan), (message,))

    def _prepare(self, client: "Client") -> None:
        """Compare versions, bring the task to all workers that do not have it, and have them make its engine."""
        from orchestration.campaigns.cluster.delivery import deliver

        versions: Any = client.get_versions(packages=list(COMPARED))
        require_equal(versions)
        deliver(client, self._payload, versions["client"]["packages"])


class _Outcomes(Iterator[Outcomes]):
    """Outcomes of chunks in any order. A chunk that ended workers is made at last, run by run, to find the culprit.

    Parameters
    ----------
    fly
        Sends chunks to the workers.
    failed
        Gives the outcome of a run that ends its worker.
    chunks
        Chunks to be made.
    """

    def __init__(
        self,
        fly: "Callable[..., Flights]",
        failed: "Callable[[Points, KilledWorker], Outcomes]",
        chunks: Iterator[Points],
    ) -> None:
        self._fly, self._failed = fly, failed
        self._flights = fly(chunks)
        self._suspects: list[Points] = []

    def __next__(self) -> Outcomes:
        for points, answer in self._flights:
            if isinstance(answer, Outcomes):
                return answer
            self._suspects.append(points)
        if not self._suspects:
            raise StopIteration
        outcomes = self._one_by_one(self._suspects[-1])
        self._suspects.pop()
        return outcomes

    def _one_by_one(self, points: Points) -> Outcomes:
        """Make the runs of a chunk with nothing else in flight."""
        single = (points[k : k + 1] for k in range(len(points)))
        found = [
            answer if isinstance(answer, Outcomes) else self._failed(point, answer)
            for point, answer in self._fly(single, at_once=1)
        ]
        return Outcomes(
            np.concatenate([one.numbers for one in found]),
            np.concatenate([one.measured for one in found]),
            tuple(message for one in found for message in one.messages),
        )


def _default() -> MakeEngine:
    """The function that chooses the engine of a task."""
    from orchestration.campaigns.engines.choice import engine_for

    return engine_for
