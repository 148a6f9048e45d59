"""A line on standard error that says what a program is doing, with a bar while a run makes its steps."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, Timer
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

RUNNING = "running"
"""What is said while a run makes its steps."""


class ProgressLine:
    """What a program is doing, shown for as long as it lasts; a context manager that clears the line at its end.

    On a terminal the line disappears when something else begins. Elsewhere, as in a log, a line stays for each thing
    that lasts long; steps are not shown there.

    Parameters
    ----------
    console
        Where the line goes, usually standard error.
    after
        Duration after which a thing is shown, s; 0 shows everything at once.

    Attributes
    ----------
    hidden
        Whether something else is shown on the terminal, so that nothing is shown here.
    """

    def __init__(self, console: Console, after: float) -> None:
        columns = TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn()
        self._bar = Progress(*columns, TimeRemainingColumn(), console=console, transient=True)
        self._console, self._after = console, after
        self._task = self._bar.add_task("", total=None)
        self._timer: Timer | None = None
        self._lock = Lock()
        self._text = ""
        self.hidden = False

    def begin(self, text: str) -> None:
        """Say that something else begins; an empty text says that what was going on has ended."""
        self.end()
        self._text = text
        self._bar.remove_task(self._task)
        self._task = self._bar.add_task(text, total=None)
        if not text:
            return
        if self._after == 0:
            self._show(text)
            return
        self._timer = Timer(self._after, self._show, (text,))
        self._timer.daemon = True
        self._timer.start()

    def steps(self, done: int, total: int) -> None:
        """Show how many steps a run has made, and how many there are in all."""
        if self._text != RUNNING:
            self.begin(RUNNING)
        self._bar.update(self._task, completed=done, total=total)

    def end(self) -> None:
        """Clear the line."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        with self._lock:  # the timer may be about to show the line
            self._text = ""
            if self._bar.live.is_started:  # else it would print an empty line
                self._bar.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    def _show(self, text: str) -> None:
        with self._lock:
            if self.hidden or text != self._text:  # it may have ended in the meantime
                return
            if self._console.is_terminal or self._console.is_jupyter:
                self._bar.start()
            elif text != RUNNING:
                self._console.print(f"{text} ...", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def progress_bar() -> Iterator[Callable[[int, int], None]]:
    """Show a bar on standard error from the beginning of a run, which disappears at the end.

    Yields
    ------
    callable
        To be called with the steps made and the steps in all.
    """
    with ProgressLine(Console(stderr=True), 0.0) as line:
        line.begin(RUNNING)
        yield line.steps
