"""Brings payloads to the workers of a Dask cluster, and makes the runs of chunks there."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import Lock
from time import monotonic
from typing import Any

from distributed import Client, Worker, WorkerPlugin, get_worker
from distributed.versions import get_versions

from orchestration.campaigns.cluster.payload import Payload
from orchestration.campaigns.cluster.versions import COMPARED, differences
from orchestration.campaigns.engines.engine import Engine, Outcomes, Points
from orchestration.errors import ClusterError, printable

LONGEST = 120.0  # s; longest wait for engines


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
        self._making, self._counting = Lock(), Lock()
        self._engine: Engine | None = None
        self._running, self._ended = 0, False

    def teardown(self, worker: Worker) -> None:  # noqa: ARG002, Dask gives it by name
        """Close the engine as soon as no thread uses it."""
        with self._counting:
            self._ended = True
            self._close_if_unused()

    @contextmanager
    def engine(self) -> Iterator[Engine]:
        """The engine, which stays open during the context; several threads may use it at once.

        Raises
        ------
        ClusterError
            If versions differ on this worker.
        """
        with self._making:  # other threads of this worker wait for the first one
            with self._counting:
                engine = self._engine
                self._running += engine is not None
            if engine is None:
                engine = self._made()
                with self._counting:
                    self._engine = engine
                    self._running += 1
        try:
            yield engine
        finally:
            with self._counting:
                self._running -= 1
                self._close_if_unused()

    def _made(self) -> Engine:
        """A new engine."""
        theirs = get_versions(packages=COMPARED)["packages"]
        if found := differences(f"Worker {self._address}", theirs, self.versions):
            raise ClusterError(" ".join(found))
        return self.payload.engine()

    def _close_if_unused(self) -> None:
        """Close the engine if the payload was taken back and no thread uses it."""
        if self._ended and not self._running and self._engine is not None:
            self._engine.close()
            self._engine = None


def deliver(client: Client, payload: Payload, versions: dict[str, str | None]) -> None:
    """Bring a payload to all workers that do not have it, and have each of them make its engine.

    Engines are made before the first run, since that may take far longer than a chunk, whose size follows its time.

    Raises
    ------
    ClusterError
        If a worker cannot make the engine.
    OSError
        If the scheduler is lost meanwhile.
    """
    client.register_plugin(Delivery(payload, versions), name=payload.name)
    by_worker: Any = client.nthreads()
    futures = [
        client.submit(make_engine, payload.name, workers=[address], allow_other_workers=True, pure=False)
        for address in by_worker
    ]
    deadline = monotonic() + LONGEST
    for future in futures:
        with suppress(TimeoutError):  # a worker that is not ready has its chunks wait
            error = future.exception(timeout=max(0.0, deadline - monotonic()))
            if isinstance(error, ClusterError):  # any other comes again with the first chunk
                client.unregister_worker_plugin(payload.name)
                raise error


def make_engine(name: str) -> None:
    """Make the engine of the payload of a name, on a worker; errors as of `make_runs`."""
    with _engine(name):
        pass


def make_runs(name: str, points: Points) -> Outcomes:
    """Make the runs of a chunk with the payload of a name, on a worker.

    Raises
    ------
    NotDeliveredError
        If the worker does not have the payload.
    ClusterError
        If the worker cannot make the runs.
    """
    with _engine(name) as engine:
        return engine.make(points)


@contextmanager
def _engine(name: str) -> Iterator[Engine]:
    """The engine of a payload on this worker; whatever fails in the context is an error that names the worker."""
    worker = get_worker()
    delivery: Any = worker.plugins.get(name)
    if delivery is None:
        raise NotDeliveredError(name)
    try:
        with delivery.engine() as engine:
            yield engine
    except ClusterError:
        raise
    except Exception as error:
        remedy = "; install it there." if isinstance(error, ImportError) else ""
        msg = f"Worker {worker.address} cannot make the runs: {type(error).__name__}: {printable(error, 1000)}{remedy}"
        raise ClusterError(msg) from error
