"""Chunks of points in flight to the workers of a Dask cluster, a few for each thread, so that memory stays flat."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import count, islice
from queue import Empty, SimpleQueue
from time import monotonic

from distributed import CancelledError, Client, Future, KilledWorker

from orchestration.campaigns.cluster.connection import CALL, Connection, LostError
from orchestration.campaigns.cluster.delivery import NotDeliveredError, make_runs
from orchestration.campaigns.engine import Outcomes, Points

PER_THREAD = 2  # chunks for each thread of a worker: one that is made, and one that waits at the worker
CHECK = 2.0  # s between two looks at the scheduler


class Flights:
    """Sends chunks to workers and collects what becomes of them, whatever happens to the connection.

    Parameters
    ----------
    connection
        Connection to the scheduler.
    name
        Name of the payload that makes the runs.
    deliver
        Brings the payload to the workers.
    """

    def __init__(self, connection: Connection, name: str, deliver: Callable[[Client], None]) -> None:
        self._connection, self._name, self._deliver = connection, name, deliver
        self._numbers = count()
        self._chunks: dict[int, Points] = {}  # without an answer
        self._futures: dict[int, Future] = {}
        self._done: SimpleQueue[tuple[int, Future]] = SimpleQueue()
        self._room, self._looked = 1, float("-inf")

    def answers(
        self, chunks: Iterator[Points], at_once: int | None = None
    ) -> Iterator[tuple[Points, Outcomes | KilledWorker]]:
        """Send all chunks, and yield each once with its outcomes, or with the error of the workers that it ended.

        Parameters
        ----------
        chunks
            Points of some runs each.
        at_once
            Number of chunks in flight. Default: some for each thread of the workers.

        Raises
        ------
        ClusterError
            If the scheduler or all workers stay away, or a worker cannot make the runs.
        """
        try:
            while True:
                try:
                    self._look()
                    for points in islice(chunks, max(0, (at_once or self._room) - len(self._chunks))):
                        self._launch(points)
                    if not self._chunks:
                        return
                    answered = self._next()
                except LostError:
                    self._begin_again()
                    continue
                if answered is not None:
                    yield answered
        finally:
            self._abandon()

    def _look(self) -> None:
        """Look now and then whether the scheduler is there, and how many threads its workers have."""
        if monotonic() - self._looked > CHECK:
            self._room = max(1, PER_THREAD * self._connection.threads())
            self._looked = monotonic()

    def _launch(self, points: Points) -> None:
        """Send a chunk."""
        number = next(self._numbers)
        self._chunks[number] = points
        self._send(number)

    def _send(self, number: int) -> None:
        """Send a chunk of a number, for the first time or again."""
        client = self._connection.client
        future = client.submit(make_runs, self._name, self._chunks[number], pure=False)
        self._futures[number] = future
        self._await(number, future)

    def _await(self, number: int, future: Future) -> None:
        """Have a chunk put into the queue as soon as something has become of it."""
        future.add_done_callback(lambda done: self._done.put((number, done)))

    def _next(self) -> tuple[Points, Outcomes | KilledWorker] | None:
        """A chunk with its answer; None if no chunk had an answer for a while."""
        try:
            number, future = self._done.get(timeout=CHECK)
        except Empty:
            return None
        if self._futures.get(number) is not future:
            return None  # of a connection that was lost meanwhile
        try:
            answer = future.result(timeout=CALL)
        except KilledWorker as error:
            answer = error
        except NotDeliveredError:
            self._deliver(self._connection.client)
            self._send(number)
            return None
        except TimeoutError:  # the worker with the outcome was lost, and the chunk is made again
            self._await(number, future)
            return None
        except (CancelledError, OSError) as error:
            raise LostError from error
        del self._futures[number]
        return self._chunks.pop(number), answer

    def _begin_again(self) -> None:
        """Connect again, and send all chunks that have no answer."""
        self._futures.clear()
        self._connection.renew()
        with suppress(LostError):  # then the next look finds out, and everything begins again
            for number in self._chunks:
                self._send(number)

    def _abandon(self) -> None:
        """Call back the chunks that are still in flight."""
        futures = list(self._futures.values())
        self._futures.clear()
        self._chunks.clear()
        if futures:
            with suppress(LostError, OSError):  # then there is nothing to call back
                self._connection.client.cancel(futures)
