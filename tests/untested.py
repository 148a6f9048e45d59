"""What a run of the tests could not test on this machine, and which Debian packages bring it.

A reason to skip a test that names its packages, as `needs` writes it, is a want of this machine. Any other
reason belongs to the platform or to the test.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the other tools' environments, which read `needs`, have no pytest
    from collections.abc import Iterable

    import pytest

PROPERTY = "untested"
"""Name under which a test that passes records what it left out; see `left_out`."""
_PACKAGES = re.compile(r"\(Debian: ([a-z0-9.+, -]+)\)")


def needs(what: str, *packages: str) -> str:
    """Reason to skip a test on a machine without some Debian packages.

    >>> needs("clang is not installed", "clang", "libclang-rt-14-dev")
    'clang is not installed (Debian: clang, libclang-rt-14-dev)'
    """
    return f"{what} (Debian: {', '.join(packages)})"


def left_out(reports: Iterable[pytest.TestReport | pytest.CollectReport]) -> list[str]:
    """Reason of each test that was skipped, and of each part that a test recorded as `PROPERTY`."""
    found = []
    for report in reports:
        if report.skipped and isinstance(report.longrepr, tuple):
            found.append(report.longrepr[2].removeprefix("Skipped: "))
        if getattr(report, "when", "") == "call":
            found += [str(value) for name, value in report.user_properties if name == PROPERTY]
    return found


def sentence(reasons: Iterable[str]) -> str:
    """One line that says what was not tested, empty if everything was.

    What packages would bring is told apart from what this platform does not have.

    Parameters
    ----------
    reasons
        One for each test or part of a test that was left out.
    """
    wanting, elsewhere, packages = 0, 0, set[str]()
    for reason in reasons:
        named = _PACKAGES.search(reason)
        if named:
            wanting += 1
            packages |= set(named[1].split(", "))
        else:
            elsewhere += 1
    parts = []
    if wanting:
        parts.append(f"{_tests(wanting)} that Debian's packages {' '.join(sorted(packages))} bring")
    if elsewhere:
        parts.append(f"{_tests(elsewhere)} for another platform")
    return f"Not tested here: {'; '.join(parts)}." if parts else ""


def _tests(count: int) -> str:
    return "1 test" if count == 1 else f"{count} tests"
