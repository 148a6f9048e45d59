"""How many steps a compiled loop makes at a time."""

import time

FIRST = 256  # steps
LARGEST = 2**40  # steps, which no run makes; a number that grows without bound would leave the range of compiled code
SECONDS = 0.1  # that a part of a run lasts, so that interrupts are noticed and progress is shown


class Chunks:
    """Chooses the number of steps of the next part of a run from the time that the last part took.

    Attributes
    ----------
    steps
        Number of steps of the next part.
    """

    def __init__(self) -> None:
        self.steps = FIRST
        self._started = 0.0

    def begin(self) -> None:
        """Say that a part begins."""
        self._started = time.perf_counter()

    def end(self) -> None:
        """Say that a part has ended, which may have been shorter than was allowed."""
        elapsed = time.perf_counter() - self._started
        steps = int(self.steps * min(4.0, SECONDS / max(elapsed, 1e-6)))
        self.steps = min(max(1, steps), LARGEST)
