"""The part that workers of a Dask cluster run: a payload that stays with a worker, and the runs of a chunk."""

from threading import Lock
from typing import Any

from distributed import Worker, WorkerPlugin, get_worker
from distributed.versions import get_versions

from orchestration.campaigns.cluster.payload import Payload
from orchestration.campaigns.cluster.versions import COMPARED, differences
from orchestration.campaigns.engine import Engine, Outcomes, Points
from orchestration.errors import ClusterError, printable


class NotDeliveredError(Exception):
    """The worker does not have the payload (any more)."""


class Delivery(WorkerPlugin):
    """A payload that Dask brings to each worker once, also to those that join later; it makes one engine there.

    Attributes
    ----------
    payload
        Task, and the function that makes its engine.
    versions
        Versions of the client by package, as `COMPARED` lists them.
    """

    idempotent = True  # equal names mean equal contents

    def __init__(self, payload: Payload, versions: dict[str, str | None]) -> None:
        self.payload, self.versions = payload, versions

    def setup(self, worker: Worker) -> None:
        """Wait for the first chunk, which makes the engine."""
        self._address = worker.address
        self._lock = Lock()
        self._engine: Engine | None = None
        self._running, self._ended = 0, False

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002, Dask gives it by name
        """Close the engine as soon as no thread uses it."""
        with self._lock:
            self._ended = True
            self._close_if_unused()

    def make(self, points: Points) -> Outcomes:
        """Make the runs of a chunk; several threads may call it at once.

        Raises
        ------
        ClusterError
            If this worker cannot make the runs of the task.
        """
        with self._lock:
            engine = self._engine = self._engine or self._made()
            self._running += 1
        try:
            return engine.make(points)
        finally:
            with self._lock:
                self._running -= 1
                self._close_if_unused()

    def _made(self) -> Engine:
        """The engine, made while other threads of this worker wait for it."""
        theirs = get_versions(packages=COMPARED)["packages"]
        if found := differences(f"Worker {self._address}", theirs, self.versions):
            raise ClusterError(" ".join(found))
        return self.payload.engine()

    def _close_if_unused(self) -> None:
        """Close the engine if the payload was taken back and no thread uses it."""
        if self._ended and not self._running and self._engine is not None:
            self._engine.close()
            self._engine = None


def make_runs(name: str, points: Points) -> Outcomes:
    """Make the runs of a chunk with the payload of a name, on a worker.

    Raises
    ------
    NotDeliveredError
        If the worker does not have the payload.
    ClusterError
        If the worker cannot make the runs.
    """
    worker = get_worker()
    delivery: Any = worker.plugins.get(name)
    if delivery is None:
        raise NotDeliveredError(name)
    try:
        return delivery.make(points)
    except ClusterError:
        raise
    except Exception as error:
        msg = f"Worker {worker.address} cannot make the runs: {type(error).__name__}: {printable(error, 1000)}"
        raise ClusterError(msg) from error
