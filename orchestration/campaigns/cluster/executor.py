"""Makes the runs of a campaign on the workers of a Dask cluster.

A task travels to each worker once; chunks of points follow, a few at a time. A worker that is lost costs nothing but
time: its chunks are made again elsewhere. The same holds for a scheduler that is restarted at the same address.
"""

from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.cluster.payload import MakeEngine, Payload
from orchestration.campaigns.cluster.versions import COMPARED, require_equal
from orchestration.campaigns.engine import Outcomes, Points
from orchestration.campaigns.task import Task
from orchestration.errors import ClusterError

if TYPE_CHECKING:
    from distributed import Client, KilledWorker

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

    def __init__(
        self, task: Task, cluster: Any, make_engine: MakeEngine | None = None, patience: float = PATIENCE
    ) -> None:
        if find_spec("distributed") is None:
            msg = "A campaign on a cluster needs Dask; install it with pip install 'adaptimp[cluster]'."
            raise ClusterError(msg)
        from orchestration.campaigns.cluster.connection import Connection
        from orchestration.campaigns.cluster.flights import Flights

        self._n_measures = len(task.measure_names)
        self._payload = Payload.of(task, make_engine or _default())
        self._connection = Connection(cluster, patience, self._prepare)
        self._flights = Flights(self._connection, self._payload.name, self._deliver)

    def map(self, chunks: Iterator[Points]) -> Iterator[Outcomes]:
        """Make the runs of all chunks, each of them once; their outcomes come in any order.

        Raises
        ------
        ClusterError
            If the scheduler or all workers stay away, or a worker cannot make the runs.
        """
        suspects = []
        for points, answer in self._flights.answers(iter(chunks)):
            if isinstance(answer, Outcomes):
                yield answer
            else:
                suspects.append(points)
        for points in suspects:
            yield self._one_by_one(points)

    def close(self) -> None:
        """Take the task back from the workers, and end the connection."""
        from orchestration.campaigns.cluster.connection import LostError

        # A scheduler that is gone has no task; another campaign with the same task may have taken it back already.
        with suppress(LostError, OSError, ValueError):
            self._connection.client.unregister_worker_plugin(self._payload.name)
        self._connection.close()

    def _one_by_one(self, points: Points) -> Outcomes:
        """Make the runs of a chunk that ended workers, with nothing else in flight, to find the run that does so."""
        found = [
            answer if isinstance(answer, Outcomes) else self._failed(point, answer)
            for point, answer in self._flights.answers((points[k : k + 1] for k in range(len(points))), at_once=1)
        ]
        return Outcomes(
            np.concatenate([one.numbers for one in found]),
            np.concatenate([one.measured for one in found]),
            tuple(message for one in found for message in one.messages),
        )

    def _failed(self, points: Points, error: "KilledWorker") -> Outcomes:
        """The outcome of a run that ends the worker that makes it."""
        last: Any = error.last_worker
        message = (
            f"The run ended the process of its worker, {error.allowed_failures + 1} times, at last that of"
            f" {last.address}; the log of the worker may say why, such as too little memory."
        )
        return Outcomes(points.numbers, np.full((1, self._n_measures), np.nan), (message,))

    def _prepare(self, client: "Client") -> None:
        """Compare versions, and bring the task to the workers."""
        require_equal(client.get_versions(packages=list(COMPARED)))
        self._deliver(client)

    def _deliver(self, client: "Client") -> None:
        """Bring the task to all workers that do not have it."""
        from distributed.versions import get_versions

        from orchestration.campaigns.cluster.delivery import Delivery

        ours = get_versions(packages=list(COMPARED))["packages"]
        client.register_plugin(Delivery(self._payload, ours), name=self._payload.name)


def _default() -> MakeEngine:
    """The function that chooses the engine of a task."""
    from orchestration.campaigns.engines.choice import engine_for

    return engine_for
