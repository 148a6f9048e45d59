"""Tells how far a campaign is: runs made, runs per second, remaining time, failures, and the best run so far.

A terminal shows one line that is renewed in place and disappears at the end. Nothing is shown where standard error is
a file or a pipe.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, Protocol

import numpy as np

from orchestration.errors import StudyError, printable
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as Bar

    from orchestration.campaigns.engines.engine import Outcomes

REFRESHED = 5.0  # times per second that the line is renewed
BAR, REMAINING = 20, 7  # columns of the bar and of the remaining time


class Progress(Protocol):
    """What `Study.run` tells while it runs."""

    def begin(self, total: int, names: Sequence[str], place: Callable[[int], str]) -> None:
        """Take note of what is to come.

        Parameters
        ----------
        total
            Number of runs in all.
        names
            Names of the measures.
        place
            Factors of the run with a number, in words.
        """
        ...

    def add(self, outcomes: "Outcomes", kept: bool) -> None:
        """Take note of runs that are finished; `kept` if the store had them already."""
        ...

    def end(self) -> None:
        """Take note that no more runs come."""
        ...


@dataclass(frozen=True)
class Goal:
    """The measure whose best value is shown while runs are made.

    Attributes
    ----------
    measure
        Name of the measure.
    largest
        Whether the largest value is the best; otherwise the smallest one is.

    Examples
    --------
    >>> from orchestration.campaigns.execution.progress import Goal
    >>> Goal.of("min:peak_force")
    Goal(measure='peak_force', largest=False)
    """

    measure: str
    largest: bool = False

    @classmethod
    def of(cls, text: str) -> "Goal":
        """Read ``min:MEASURE`` or ``max:MEASURE``.

        Raises
        ------
        StudyError
            If the text has another form.
        """
        sense, colon, measure = text.partition(":")
        if sense not in ("min", "max") or not colon or not measure.strip():
            msg = f"The goal {text!r} has no form that is known; write min:MEASURE or max:MEASURE."
            raise StudyError(msg)
        return cls(measure.strip(), largest=sense == "max")

    def place(self, names: Sequence[str]) -> int:
        """Position of the measure among names.

        Raises
        ------
        StudyError
            If there is no such measure.
        """
        if self.measure not in names:
            msg = f"There is no measure {self.measure} to look for the best run; {suggestion(self.measure, names)}"
            raise StudyError(msg)
        return list(names).index(self.measure)


class Tally:
    """Counts the runs of a campaign, and remembers the best one; it shows nothing.

    Parameters
    ----------
    goal
        Which run is the best; None remembers none.

    Attributes
    ----------
    total, done, kept, failed
        Number of runs in all, of runs that are finished, and among these of runs that the store had and of runs that
        failed.
    best
        Value of the goal's measure in the best run, and the run's factors in words; None before the first value.
    seconds
        Duration since the campaign began, s; after its end the duration of the whole.
    """

    def __init__(self, goal: Goal | None = None) -> None:
        self.goal = goal
        self.total = self.done = self.kept = self.failed = 0
        self.best: tuple[float, str] | None = None
        self._column = 0
        self._place: Callable[[int], str] = str
        self._began = self._ended = 0.0
        self._first: tuple[int, float] | None = None  # runs made by the first chunk, and when it was finished, s

    @property
    def seconds(self) -> float:
        """Duration since the campaign began, s."""
        return (self._ended or perf_counter()) - self._began if self._began else 0.0

    @property
    def rate(self) -> float:
        """Runs made per second; runs from the store do not count. 0 before the first run."""
        return (self.done - self.kept) / self.seconds if self.done > self.kept else 0.0

    @property
    def pace(self) -> float:
        """Runs made per second since the first chunk, without what is prepared before it; 0 before the second one."""
        if self._first is None or self.done - self.kept <= self._first[0]:
            return 0.0
        return (self.done - self.kept - self._first[0]) / ((self._ended or perf_counter()) - self._first[1])

    def begin(self, total: int, names: Sequence[str], place: Callable[[int], str]) -> None:
        """Begin to count.

        Raises
        ------
        StudyError
            If the goal's measure is not among the names.
        """
        self._column = self.goal.place(names) if self.goal else 0
        self.total, self._place, self._began = total, place, perf_counter()

    def add(self, outcomes: "Outcomes", kept: bool) -> None:
        """Count finished runs."""
        n = len(outcomes.messages)
        self.done += n
        self.kept += n if kept else 0
        self.failed += sum(message != "" for message in outcomes.messages)
        if self._first is None and not kept:
            self._first = n, perf_counter()
        if self.goal is not None:
            self._look(outcomes, self.goal)

    def end(self) -> None:
        """Stop the clock."""
        self._ended = perf_counter()

    def _look(self, outcomes: "Outcomes", goal: Goal) -> None:
        """Remember the best of finished runs, if it is better than all before."""
        values = outcomes.measured[:, self._column]
        if np.isnan(values).all():
            return
        i = int(np.nanargmax(values) if goal.largest else np.nanargmin(values))
        if self.best is None or (values[i] > self.best[0] if goal.largest else values[i] < self.best[0]):
            self.best = float(values[i]), self._place(int(outcomes.numbers[i]))


class ProgressBar(Tally):
    """Counts the runs of a campaign, and shows the count on a terminal.

    Parameters
    ----------
    goal
        Which run is the best; None shows none.
    console
        Where the line goes; by default standard error.
    """

    def __init__(self, goal: Goal | None = None, console: "Console | None" = None) -> None:
        super().__init__(goal)
        self._console = console
        self._bar: Bar | None = None

    def add(self, outcomes: "Outcomes", kept: bool) -> None:
        """Count finished runs, and renew the line, which appears with the first run that is made."""
        super().add(outcomes, kept)
        if self._bar is None and not kept:
            self.show()
        if self._bar is not None:
            room = self._bar.console.width - BAR - REMAINING - 2 * len(str(self.total)) - 5  # a slash and four blanks
            text = self.sentence if len(self.sentence) <= room else f"{self.sentence[: max(0, room - 3)]}..."
            self._bar.update(self._bar.task_ids[0], completed=self.done, description=text)

    def show(self) -> bool:
        """Show the line if there is a terminal; return whether there is one."""
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        console = self._console or Console(stderr=True)
        if not (console.is_terminal or console.is_jupyter):
            return False
        said = TextColumn("{task.description}", markup=False)
        columns = BarColumn(bar_width=BAR), MofNCompleteColumn(), TimeRemainingColumn(), said
        self._bar = Progress(*columns, console=console, transient=True, refresh_per_second=REFRESHED)
        self._bar.add_task("", total=self.total, completed=self.kept)
        self._bar.start()
        return True

    def end(self) -> None:
        """Clear the line."""
        super().end()
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    @property
    def sentence(self) -> str:
        """What stands beside the bar: the rate, failures, and the best run."""
        parts = [f"{self.pace:.3g} runs/s"] if self.pace else []
        parts += [f"{self.failed} failed"] if self.failed else []
        if self.goal and self.best:
            value, where = self.best
            sense = "max" if self.goal.largest else "min"
            parts.append(printable(f"{sense} {self.goal.measure} {value:.4g} at {where}"))
        return ", ".join(parts)
