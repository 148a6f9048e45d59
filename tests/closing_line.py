"""Hook of pytest: the line at the end of a run about what was not tested; see ``tests/untested.py``."""

from collections.abc import Iterator

import pytest

from tests.untested import left_out, sentence


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> Iterator[None]:
    """Say in one line what was not tested, below the other summaries, with workers and without."""
    yield
    reports = [report for kind in ("skipped", "passed") for report in terminalreporter.stats.get(kind, [])]
    if said := sentence(left_out(reports)):
        terminalreporter.write_line(said)
