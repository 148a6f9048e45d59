"""A connection to the scheduler of a Dask cluster, made anew when the scheduler was restarted."""

import logging
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, Any

from orchestration.errors import ClusterError, printable
from orchestration.fmi.given import shown

if TYPE_CHECKING:
    from distributed import Client

_LOG = logging.getLogger(__name__)
FIRST = 30.0  # s; longest wait for a scheduler that has not been reached yet, as Dask's own
ATTEMPT = 5.0  # s; one attempt to reach a scheduler that was lost
CALL = 30.0  # s; longest answer of a scheduler


class LostError(Exception):
    """The scheduler is out of reach, or it was restarted and knows nothing of the runs."""


class Connection:
    """A client of a scheduler that is used for one campaign only.

    Parameters
    ----------
    cluster
        Address of a scheduler, such as ``tcp://10.0.0.5:8786``; or a `distributed.Client`, or a cluster with a
        ``scheduler_address``, both of which stay as they are.
    patience
        Longest wait, s, for a scheduler that was lost, and for the first worker.
    prepare
        Called with each new client before it is used.

    Raises
    ------
    ClusterError
        If there is no scheduler, or it has no worker.
    """

    def __init__(self, cluster: Any, patience: float, prepare: "Callable[[Client], None]") -> None:
        self.address, self._security = _address(cluster)
        self._patience, self._prepare = patience, prepare
        self._scheduler: str | None = None
        self._client: Client | None = None
        self._threads, self._with_workers = 0, monotonic()
        with ExitStack() as undone:
            undone.callback(self.close)
            try:
                self._open(FIRST)
            except OSError as error:
                msg = (
                    f"No scheduler of Dask was reached at {self.address} within {FIRST:g} s: {printable(error, 500)}."
                    " Start it there with dask scheduler, or give another address."
                )
                raise ClusterError(msg) from error
            undone.pop_all()

    @property
    def client(self) -> "Client":
        """The client of the present connection.

        Raises
        ------
        LostError
            If there is none.
        """
        if self._client is None:
            raise LostError
        return self._client

    @property
    def threads(self) -> int:
        """Number of threads of all workers when the scheduler was asked last, at least 1."""
        return max(1, self._threads)

    def look(self) -> None:
        """Ask the scheduler for its workers.

        Raises
        ------
        LostError
            If the scheduler is out of reach, or was restarted.
        ClusterError
            If there has been no worker for too long.
        """
        client = self.client
        try:
            by_worker: Any = client.nthreads(callback_timeout=CALL)
            if client.status != "running" or client.scheduler_info()["id"] != self._scheduler:
                raise LostError
        except OSError as error:
            raise LostError from error
        self._threads = sum(by_worker.values())
        now = monotonic()
        if self._threads:
            self._with_workers = now
        elif now - self._with_workers > self._patience:
            raise ClusterError(self._no_worker())

    def prepare(self) -> None:
        """Prepare the workers again.

        Raises
        ------
        LostError
            If the scheduler is out of reach.
        """
        try:
            self._prepare(self.client)
        except OSError as error:
            raise LostError from error

    def renew(self) -> None:
        """Connect to the scheduler again.

        Raises
        ------
        ClusterError
            If that takes longer than the patience allows.
        """
        _LOG.warning("The scheduler %s was lost; it is awaited for up to %g s.", self.address, self._patience)
        deadline = monotonic() + self._patience
        while True:
            self.close()
            try:
                self._open(min(ATTEMPT, self._patience))
            except OSError as error:
                if monotonic() < deadline:
                    continue
                msg = (
                    f"The scheduler {self.address} was lost, and was out of reach for {self._patience:g} s:"
                    f" {printable(error, 500)}. Start scheduler and workers again, then resume the study from its"
                    " store: finished runs are taken from there."
                )
                raise ClusterError(msg) from error
            _LOG.warning("The scheduler %s is back; unfinished runs are made again.", self.address)
            return

    def close(self) -> None:
        """End the connection."""
        client, self._client = self._client, None
        if client is not None:
            # A client that has lost its scheduler logs an error with a wrong time when it is closed.
            with suppress(OSError), _silent("distributed.client"):
                client.close()

    def _open(self, timeout: float) -> None:
        """Connect, wait for a worker, and prepare the client."""
        from distributed import Client

        options = {} if self._security is None else {"security": self._security}
        self._client = Client(self.address, timeout=timeout, set_as_default=False, **options)
        self._scheduler = self._client.scheduler_info()["id"]
        self._await_worker(self._client)
        self._prepare(self._client)
        by_worker: Any = self._client.nthreads(callback_timeout=CALL)
        self._threads, self._with_workers = sum(by_worker.values()), monotonic()

    def _await_worker(self, client: "Client") -> None:
        """Wait for the first worker."""
        if not client.nthreads(callback_timeout=CALL):
            _LOG.warning("The scheduler %s has no worker; one is awaited for up to %g s.", self.address, self._patience)
        try:
            client.wait_for_workers(1, timeout=self._patience)
        except TimeoutError as error:
            raise ClusterError(self._no_worker()) from error

    def _no_worker(self) -> str:
        """The message of a cluster without workers."""
        return (
            f"The scheduler {self.address} has had no worker for {self._patience:g} s; start one with"
            f" dask worker {self.address}."
        )


@contextmanager
def _silent(name: str) -> Iterator[None]:
    """Nothing is logged under a name meanwhile."""
    logger = logging.getLogger(name)
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before


def _address(cluster: Any) -> tuple[str, Any]:
    """Address of the scheduler, and what a client needs for encrypted connections, if anything."""
    from distributed.comm.addressing import get_address_host_port

    if isinstance(cluster, str):
        address = cluster if "://" in cluster else f"tcp://{cluster}"
        try:
            get_address_host_port(address, strict=True)
        except ValueError as error:
            msg = f"cluster is {shown(cluster)}: {printable(error, 200)}; give an address such as tcp://10.0.0.5:8786."
            raise ClusterError(msg) from error
        return address, None
    security = getattr(cluster, "security", None)
    if hasattr(cluster, "scheduler_address"):
        return cluster.scheduler_address, security
    if hasattr(cluster, "scheduler") and hasattr(cluster, "submit"):
        return cluster.scheduler.address, security
    msg = (
        f"cluster is {shown(cluster)}; give an address such as tcp://10.0.0.5:8786, a distributed.Client, or"
        " a LocalCluster."
    )
    raise ClusterError(msg)
