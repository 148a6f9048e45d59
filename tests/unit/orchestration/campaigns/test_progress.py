"""Evidence for the progress of campaigns: what is counted, what a terminal shows, and that a pipe gets nothing."""

import io
import re
from collections.abc import Sequence

import numpy as np
import pytest
from rich.console import Console

from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.execution import progress
from orchestration.campaigns.execution.progress import Goal, ProgressBar, Tally
from orchestration.errors import StudyError

NAMES = ("peak_force", "max_e")


def outcomes(first: int, forces: Sequence[float]) -> Outcomes:
    """Rows with numbers from `first` on; a NaN is a failed run."""
    measured = np.array([[force, 0.0] for force in forces])
    numbers = np.arange(first, first + len(forces))
    return Outcomes(numbers, measured, tuple("It diverged." if np.isnan(f) else "" for f in forces))


def place(number: int) -> str:
    return f"seed={number}"


@pytest.mark.parametrize(("text", "best"), [("min:peak_force", (2.0, "seed=3")), ("max:peak_force", (7.0, "seed=1"))])
def test_the_best_run_is_remembered_with_its_place(text: str, best: tuple[float, str]) -> None:
    tally = Tally(Goal.of(text))
    tally.begin(6, NAMES, place)
    tally.add(outcomes(1, [7.0, np.nan]), kept=False)
    tally.add(outcomes(3, [2.0, 2.0]), kept=False)  # the first of equals wins
    tally.add(outcomes(5, [np.nan, np.nan]), kept=False)
    assert tally.best == best


def test_runs_from_the_store_are_no_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([10.0, 11.0, 12.0, 12.0])
    monkeypatch.setattr(progress, "perf_counter", lambda: next(clock))
    tally = Tally()
    tally.begin(10, NAMES, place)
    tally.add(outcomes(0, [1.0, 1.0, np.nan]), kept=True)
    tally.add(outcomes(3, [1.0, np.nan, 1.0, 1.0]), kept=False)
    assert (tally.total, tally.done, tally.kept, tally.failed) == (10, 7, 3, 2)
    assert tally.rate == 2.0
    tally.end()
    assert tally.seconds == 2.0
    assert tally.rate == 2.0


def test_the_pace_leaves_out_what_is_prepared(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([10.0, 17.0, 19.0])
    monkeypatch.setattr(progress, "perf_counter", lambda: next(clock))
    tally = Tally()
    tally.begin(10, NAMES, place)
    tally.add(outcomes(0, [1.0]), kept=True)
    tally.add(outcomes(1, [1.0]), kept=False)
    assert tally.pace == 0.0
    tally.add(outcomes(2, [1.0] * 6), kept=False)
    assert tally.pace == 3.0


@pytest.mark.parametrize("text", ["peak_force", "least:peak_force", "min:", "min"])
def test_a_goal_of_another_form_is_refused(text: str) -> None:
    with pytest.raises(StudyError, match=r"write min:MEASURE or max:MEASURE\.$"):
        Goal.of(text)


def test_a_goal_without_its_measure_is_refused() -> None:
    with pytest.raises(StudyError, match=r"no measure peak_forse .* did you mean peak_force\?"):
        Tally(Goal.of("min:peak_forse")).begin(1, NAMES, place)


def shown(*, terminal: bool, width: int = 120) -> str:
    """What a bar writes for ten runs."""
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=terminal, width=width, color_system=None)
    bar = ProgressBar(Goal.of("min:peak_force"), console)
    bar.begin(10, NAMES, place)
    try:
        bar.add(outcomes(1, [7.0, np.nan]), kept=True)
        assert stream.getvalue() == ""  # what is being prepared has the terminal
        bar.add(outcomes(3, [2.5] * 4), kept=False)
        bar.add(outcomes(7, [2.5] * 4), kept=False)
    finally:
        bar.end()
    assert bar.done == 10
    return stream.getvalue()


def test_a_terminal_shows_counts_failures_and_the_best_run() -> None:
    text = shown(terminal=True)
    for said in ("10/10", " runs/s", "1 failed", "min peak_force 2.5 at seed=3"):
        assert said in text
    assert text.endswith("\x1b[1A\x1b[2K")  # the line is gone at the end


@pytest.mark.parametrize("width", [40, 60])
def test_a_narrow_terminal_shows_one_line(width: int) -> None:
    text = shown(terminal=True, width=width)
    assert " 10/10 " in text
    lines = re.sub(r"\x1b\[[?\d]+[hlAK]", "", text).replace("\n", "\r").split("\r")
    assert max(map(len, lines)) <= width
    assert "\x1b[1A\x1b[1A" not in text  # the line is the only one that is cleared


def test_a_pipe_gets_nothing() -> None:
    assert shown(terminal=False) == ""
