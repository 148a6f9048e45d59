"""The line that says what is going on: after a while only, as a bar on terminals, and gone at the end."""

import io
import re
from collections.abc import Callable
from typing import Any

import pytest
from rich.console import Console

from orchestration.master import progress
from orchestration.master.progress import RUNNING, ProgressLine

CLEARED = "\x1b[2K"
"""What a terminal is sent to erase a line."""


class Later:
    """A timer whose time comes when the test says so."""

    made: list["Later"]

    def __init__(self, after: float, call: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        self.after, self.call, self.arguments = after, call, arguments
        self.cancelled = False
        Later.made.append(self)

    def start(self) -> None:
        """Begin to wait."""

    def cancel(self) -> None:
        """Wait no longer."""
        self.cancelled = True

    def comes(self) -> None:
        """The time is over, though the timer may have been cancelled a moment before."""
        self.call(*self.arguments)


@pytest.fixture
def timers(monkeypatch: pytest.MonkeyPatch) -> list[Later]:
    """All timers of the test."""
    Later.made = []
    monkeypatch.setattr(progress, "Timer", Later)
    return Later.made


def consoles() -> tuple[Console, io.StringIO]:
    """A terminal, and what it is sent."""
    sent = io.StringIO()
    return Console(file=sent, force_terminal=True, width=60, legacy_windows=False), sent


def test_what_is_short_is_not_shown(timers: list[Later]) -> None:
    console, sent = consoles()
    with ProgressLine(console, 1.0) as line:
        line.begin("unpacking")
        line.begin("compiling")
        line.steps(1, 2)
    assert [(timer.after, timer.cancelled) for timer in timers] == [(1.0, True)] * 3
    for timer in timers:
        timer.comes()  # too late
    assert sent.getvalue() == ""


def test_what_is_long_is_shown_on_a_terminal_and_cleared(timers: list[Later]) -> None:
    console, sent = consoles()
    line = ProgressLine(console, 1.0)

    def interrupted() -> None:
        with line:
            line.begin("compiling the loop")
            timers[-1].comes()
            line.steps(1, 4)
            timers[-1].comes()
            line.steps(3, 4)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    before, shown, after = sent.getvalue().rpartition(RUNNING)
    assert "compiling the loop" in before
    assert shown
    assert CLEARED in after


def test_elsewhere_a_line_stays_but_for_steps(timers: list[Later]) -> None:
    sent = io.StringIO()
    with ProgressLine(Console(file=sent, width=20), 1.0) as line:
        line.begin("compiling the loop of the master")
        timers[-1].comes()
        line.steps(1, 4)
        timers[-1].comes()
    assert sent.getvalue() == "compiling the loop of the master ...\n"


def test_what_is_hidden_leaves_the_terminal_to_others(timers: list[Later]) -> None:
    console, sent = consoles()
    with ProgressLine(console, 1.0) as line:
        line.hidden = True
        line.begin("compiling another loop")
        timers[-1].comes()
        assert sent.getvalue() == ""
        line.hidden = False
        line.begin("writing the rows")
        timers[-1].comes()
        assert "writing the rows" in sent.getvalue()


def test_without_delay_it_is_shown_at_once(timers: list[Later]) -> None:
    console, sent = consoles()
    with ProgressLine(console, 0.0) as line:
        line.begin("running [fast]")
    assert timers == []
    assert "running [fast]" in sent.getvalue()


def test_a_poor_terminal_gets_ascii() -> None:
    raw = io.BytesIO()
    poor = io.TextIOWrapper(raw, encoding="ascii", write_through=True)
    with ProgressLine(Console(file=poor, force_terminal=True, width=60), 0.0) as line:
        line.steps(1, 4)
    assert re.search(rb"running.* 25%", raw.getvalue())
