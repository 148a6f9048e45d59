"""Chunks of points in flight to the workers of a Dask cluster, a few for each thread, so that memory stays flat."""

from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from queue import Empty, SimpleQueue
from time import monotonic

from distributed import CancelledError, Future, KilledWorker

from orchestration.campaigns.cluster.connection import CALL, Connection, LostError
from orchestration.campaigns.cluster.delivery import NotDeliveredError, make_runs
from orchestration.campaigns.engines.engine import Outcomes, Points

PER_THREAD = 2  # chunks for each thread of a worker: one that is made, and one that waits at the worker
CHECK = 2.0  # s between two looks at the scheduler


class Flights(Iterator[tuple[Points, Outcomes | KilledWorker]]):
    """Chunks with their outcomes, or with the error of the workers that they ended; each chunk comes once.

    Iteration may go on after an interrupt of `next`. Chunks are taken as threads become free.

    Parameters
    ----------
    connection
        Connection to the scheduler.
    name
        Name of the payload that makes the runs.
    chunks
        Points of some runs each.
    at_once
        Largest number of chunks in flight. Default: `PER_THREAD` for each thread of the workers.
    """

    def __init__(self, connection: Connection, name: str, chunks: Iterator[Points], at_once: int | None = None) -> None:
        self._connection, self._name, self._given = connection, name, chunks
        self._at_once = at_once
        self._numbers = count()
        self._answered = 0
        self._chunks: dict[int, Points] = {}  # without an answer
        self._futures: dict[int, Future] = {}
        self._done: SimpleQueue[tuple[int, Future]] = SimpleQueue()
        self._looked = monotonic()

    def __next__(self) -> tuple[Points, Outcomes | KilledWorker]:
        """Return a chunk with its answer.

        Raises
        ------
        ClusterError
            If the scheduler or all workers stay away, or a worker cannot make the runs.
        """
        while True:
            try:
                self._look()
                self._fill()
                if not self._chunks:
                    raise StopIteration
                answered = self._landed()
            except LostError:
                self._begin_again()
                continue
            if answered is not None:
                return answered

    def abandon(self) -> None:
        """Call back the chunks that are in flight."""
        futures = list(self._futures.values())
        self._futures.clear()
        self._chunks.clear()
        if futures:
            with suppress(LostError, OSError):  # then there is nothing to call back
                self._connection.client.cancel(futures)

    def _look(self) -> None:
        """Look now and then whether the scheduler is there, and how many threads its workers have."""
        if monotonic() - self._looked > CHECK:
            self._connection.look()
            self._looked = monotonic()

    def _fill(self) -> None:
        """Send chunks: at first one for each thread, since the size of chunks follows the time that they take."""
        threads = self._connection.threads
        most = min(threads + self._answered, PER_THREAD * threads) if self._at_once is None else self._at_once
        while len(self._chunks) < most and (points := next(self._given, None)) is not None:
            number = next(self._numbers)
            self._chunks[number] = points
            self._send(number)

    def _send(self, number: int) -> None:
        """Send a chunk, for the first time or again."""
        client = self._connection.client
        future = client.submit(make_runs, self._name, self._chunks[number], pure=False)
        self._futures[number] = future
        self._await(number, future)

    def _await(self, number: int, future: Future) -> None:
        """Have a chunk put into the queue as soon as something has become of it."""
        future.add_done_callback(lambda done: self._done.put((number, done)))

    def _landed(self) -> tuple[Points, Outcomes | KilledWorker] | None:
        """A chunk with its answer; None if no chunk had an answer for a while."""
        try:
            number, future = self._done.get(timeout=CHECK)
        except Empty:
            for number, future in self._futures.items():
                if future.done():  # an interrupt may have come between the queue and its reader
                    self._done.put((number, future))
            return None
        if self._futures.get(number) is not future:
            return None  # answered already, or of a connection that was lost
        try:
            answer = future.result(timeout=CALL)
        except KilledWorker as error:
            answer = error
        except NotDeliveredError:
            self._connection.prepare()
            self._send(number)
            return None
        except TimeoutError:  # the worker with the outcome was lost, and the chunk is made again
            self._await(number, future)
            return None
        except (CancelledError, OSError) as error:
            raise LostError from error
        self._answered += 1
        points = self._chunks.pop(number)
        del self._futures[number]
        return points, answer

    def _begin_again(self) -> None:
        """Connect again, and send all chunks that have no answer."""
        self._futures.clear()
        self._connection.renew()
        with suppress(LostError):  # then the next look finds out, and everything begins again
            for number in self._chunks:
                self._send(number)
