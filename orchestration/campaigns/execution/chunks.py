"""Cuts the runs of a campaign into chunks that take a part of a second each."""

import threading
from collections.abc import Callable, Iterator
from time import perf_counter

import numpy as np

from orchestration.campaigns.engines.engine import Points

TIME = 0.2
"""Time that a thread should take for a chunk, s: short for interrupts and the tail, long beside all overheads."""
GROWTH = 4
"""Largest ratio of the sizes of a chunk and the one before."""
LARGEST = 65536
"""Most runs of a chunk."""


class Chunks(Iterator[Points]):
    """An iterator of chunks, whose size follows the rate at which runs are made. Several threads may iterate at once.

    Parameters
    ----------
    numbers
        Numbers of the runs, int64, shape (n,).
    points
        Makes the points of some runs of their numbers.
    workers
        Tells the number of workers, which may change.
    time
        Time that a worker should take for a chunk, s.
    """

    def __init__(
        self,
        numbers: np.ndarray,
        points: Callable[[np.ndarray], Points],
        workers: Callable[[], int],
        time: float = TIME,
    ) -> None:
        self._numbers, self._points, self._workers, self._time = numbers, points, workers, time
        self._lock = threading.Lock()
        self._next, self._size = 0, 1
        self._began: float | None = None

    def __next__(self) -> Points:
        """The next chunk."""
        with self._lock:
            left = len(self._numbers) - self._next
            if left <= 0:
                raise StopIteration
            self._began = perf_counter() if self._began is None else self._began
            self._size = self._next_size(left)
            numbers = self._numbers[self._next : self._next + self._size]
            self._next += self._size
            return self._points(numbers)

    def stop(self) -> None:
        """Give out no further chunk."""
        with self._lock:
            self._next = len(self._numbers)

    def _next_size(self, left: int) -> int:
        """Size by the rate until now; at the end smaller, so that no worker waits long for another.

        A worker that asks for a chunk has made the one before, so the rate follows from what was given out.
        """
        workers = max(1, self._workers())
        if self._next < workers or self._began is None:
            return 1
        rate = self._next / max(perf_counter() - self._began, 1e-6) / workers
        return max(1, min(int(self._time * rate), GROWTH * self._size, LARGEST, -(-left // workers)))
