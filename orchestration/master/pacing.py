"""Soft real time: a run that keeps step with a clock, and the lateness of its rows.

A row is due when the clock has advanced, since the run began or went on, by the time of the row divided by the rate.
The run waits after each row until the row is due, so the run is never more than one step ahead of the clock. A row that
is made after it was due is late; the run does not skip steps to catch up, it makes them without waiting.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from orchestration.errors import SystemDescriptionError


@dataclass(frozen=True)
class Pace:
    """How fast a run goes by a clock.

    Attributes
    ----------
    rate
        Simulated seconds per second of the clock: 1 for real time, 2 for twice as fast.
    clock
        Function that returns the time of the clock, s. Default: a clock of the machine that is never set.
    sleep
        Function that waits for a number of seconds, s.

    Raises
    ------
    SystemDescriptionError
        If the rate is not positive and finite.

    Examples
    --------
    >>> from orchestration import Pace, scenario, simulate
    >>> result = simulate(scenario("fig2"), 0.01, pace=Pace(10.0))
    >>> result["lateness"].shape == result.time.shape, result.unit("lateness")
    (True, 's')

    A clock of your own, here one that nobody has to wait for:

    >>> now = [0.0]  # s
    >>> def sleep(seconds):
    ...     now[0] += seconds
    >>> pace = Pace(1.0, clock=lambda: now[0], sleep=sleep)
    >>> result = simulate(scenario("fig2"), 0.01, pace=pace)
    >>> pace.clock() >= 0.01, pace.sleep is sleep, Pace.of(2.0).rate
    (True, True, 2.0)
    """

    rate: float
    clock: Callable[[], float] = time.perf_counter
    sleep: Callable[[float], None] = time.sleep

    def __post_init__(self) -> None:
        """Refuse a rate that cannot be kept."""
        is_number = isinstance(self.rate, int | float | np.number) and not isinstance(self.rate, bool)
        if not (is_number and math.isfinite(self.rate) and self.rate > 0):
            msg = f"pace = {self.rate!r}: simulated seconds per second are needed, positive and finite, such as 1.0."
            raise SystemDescriptionError(msg)

    @classmethod
    def of(cls, pace: "float | Pace | None") -> "Pace | None":
        """A pace of its rate; None stays None."""
        return pace if pace is None or isinstance(pace, Pace) else cls(pace)


class Pacer:
    """Keeps a run to its pace.

    Parameters
    ----------
    pace
        The pace.
    """

    def __init__(self, pace: Pace) -> None:
        self._pace = pace
        self._clock_start = self._time_start = 0.0
        self.largest, self.late_rows = 0.0, 0

    def begin(self, at: float) -> None:
        """Set the clock to zero while the run stands at a time, s."""
        self._clock_start, self._time_start = self._pace.clock(), at

    def reach(self, times: np.ndarray, interval: int, last: int) -> int:
        """Return the point up to which to step now from a point: the first that is not due yet, at most `last`."""
        due = np.searchsorted(times[interval : last + 1], self._time_start + self._pace.rate * self._elapsed(), "right")
        return min(last, interval + max(1, int(due)))

    def lateness(self, times: np.ndarray) -> np.ndarray:
        """Return how late rows are that have been made just now, s, shape (n,); 0 for a row that is not due yet."""
        late = np.maximum(0.0, self._elapsed() - self._due(times))
        self.largest = max(self.largest, float(late.max(initial=0.0)))
        self.late_rows += int(np.count_nonzero(late))
        return late

    def wait(self, at: float) -> None:
        """Wait until a time of the run, s, is due."""
        while (left := float(self._due(at)) - self._elapsed()) > 0:
            self._pace.sleep(left)

    def described(self) -> dict[str, str]:
        """Metadata of a result: the rate, the largest lateness, s, and the number of late rows."""
        return {
            "pace": repr(float(self._pace.rate)),
            "lateness_max": repr(self.largest),
            "late_rows": str(self.late_rows),
        }

    def _elapsed(self) -> float:
        return self._pace.clock() - self._clock_start

    def _due(self, times: np.ndarray | float) -> np.ndarray:
        return (np.asarray(times) - self._time_start) / self._pace.rate
