"""Evidence that the count of runs and the line on what is going on never share a terminal."""

import io

import numpy as np
from rich.console import Console

from orchestration.campaigns.engines.engine import Outcomes
from orchestration.cli.sweep import RunBar
from orchestration.master.progress import ProgressLine

ONE = Outcomes(np.array([0]), np.array([[1.0]]), ("",))


def shown(*, terminal: bool) -> str:
    """What is written while a run is made between two preparations."""
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=terminal, width=80, color_system=None)
    with ProgressLine(console, 0.0) as line:
        bar = RunBar(None, line, console)
        line.begin("compiling the first system")
        bar.begin(2, ("e",), str)
        bar.add(ONE, kept=False)
        line.begin("compiling the second system")
        bar.end()
        line.begin("writing the table")
    return stream.getvalue()


def test_a_terminal_has_one_of_them_at_a_time() -> None:
    text = shown(terminal=True)
    assert "compiling the first system" in text.partition("1/2")[0]
    assert "compiling the second system" not in text
    assert "writing the table" in text.rpartition("1/2")[2]


def test_a_log_has_a_line_for_each_preparation() -> None:
    first, second, third = "compiling the first system", "compiling the second system", "writing the table"
    assert shown(terminal=False) == f"{first} ...\n{second} ...\n{third} ...\n"
