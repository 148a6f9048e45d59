"""Makes the runs of a campaign by threads of this process."""

import os
import threading
from collections.abc import Iterator
from queue import SimpleQueue

from orchestration.campaigns.engines.engine import Engine, Outcomes, Points
from orchestration.campaigns.execution.chunks import TIME
from orchestration.errors import StudyError
from orchestration.fmi.given import shown

LONGEST_END = 2.0
"""Longest wait for a thread whose engine is closed, s."""
AHEAD = 8
"""Chunks for each thread that are at work or wait to be taken; threads rest until there are fewer."""


def worker_count(asked: int | None) -> int:
    """Number of threads: that which is asked for, else the number of cores that this process may use.

    Raises
    ------
    StudyError
        If it is not a whole number from 1 on.
    """
    if asked is None:
        available = getattr(os, "sched_getaffinity", None)
        return len(available(0)) if available else os.cpu_count() or 1
    if isinstance(asked, bool) or not isinstance(asked, int) or asked < 1:
        msg = f"workers is {shown(asked)}; give a whole number from 1 on."
        raise StudyError(msg)
    return asked


class LocalExecutor:
    """Threads that take chunks as they become free; the engine works without the interpreter's lock.

    Parameters
    ----------
    engine
        Engine that all threads use.
    workers
        Number of threads.
    """

    chunk_time = TIME

    def __init__(self, engine: Engine, workers: int) -> None:
        self.engine, self.workers = engine, workers
        self._at_work: list[_Outcomes] = []

    def map(self, chunks: Iterator[Points]) -> "Iterator[Outcomes]":
        """Make the runs of all chunks; `chunks` must allow several threads to iterate."""
        self._at_work.append(_Outcomes(self.engine, self.workers, chunks))
        return self._at_work[-1]

    def wait(self, longest: float | None = None) -> None:
        """Let the threads finish the chunks that they are at, and end them.

        Parameters
        ----------
        longest
            Longest wait for each thread, s; None waits for its end.
        """
        while self._at_work:
            self._at_work.pop().wait(longest)

    def close(self) -> None:
        """Free what the engine holds, and end the threads.

        An engine that is closed cuts off runs under way, or leaves a thread to the end of its run. After a second
        interrupt nobody waits for such a thread; it ends with the process at the latest.
        """
        for outcomes in self._at_work:
            outcomes.stop()
        self.engine.close()
        self.wait(LONGEST_END)


class _Outcomes(Iterator[Outcomes]):
    """Outcomes as threads make them, some chunks ahead of who takes them.

    An interrupt of `next` leaves the threads at work, so `next` may go on.
    """

    def __init__(self, engine: Engine, workers: int, chunks: Iterator[Points]) -> None:
        self._engine, self._chunks = engine, chunks
        self._made: SimpleQueue[Outcomes | BaseException | None] = SimpleQueue()
        self._stopped = threading.Event()
        self._room = threading.Semaphore(AHEAD * workers)
        self._working = workers
        self._threads = [threading.Thread(target=self._work, name=f"campaign-{k}", daemon=True) for k in range(workers)]
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """Let the threads take no further chunk, those that rest included."""
        self._stopped.set()
        self._room.release(len(self._threads))

    def wait(self, longest: float | None) -> None:
        """Wait until the threads have ended, each for a time, s, at most."""
        self.stop()
        for thread in self._threads:
            thread.join(longest)

    def __next__(self) -> Outcomes:
        while self._working:
            made = self._made.get()
            if made is None:
                self._working -= 1
            elif isinstance(made, BaseException):
                self.stop()
                raise made
            else:
                self._room.release()
                return made
        raise StopIteration

    def _work(self) -> None:
        """Make chunk after chunk, until there is none or another thread failed."""
        try:
            while self._may_go_on() and (points := next(self._chunks, None)) is not None:
                self._made.put(self._engine.make(points))
        except BaseException as error:
            self._made.put(error)
        finally:
            self._made.put(None)

    def _may_go_on(self) -> bool:
        """Wait until there is room for the outcomes of one more chunk; return whether one is wanted."""
        self._room.acquire()
        return not self._stopped.is_set()
