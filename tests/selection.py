"""Which tests carry the marks ``quick`` and ``processes``: a rule by folder, file and unit, not by test.

``pytest -m quick`` runs a cross-section of every kind of evidence that is cheap. ``pytest -m processes``
runs what starts processes or threads, sends signals, or reads a clock: the tests that other programs on the
machine can disturb.
"""

from collections.abc import Iterable
from fnmatch import fnmatch
from pathlib import Path

import pytest

TESTS = Path(__file__).parent

PROCESSES = (
    "benchmarks/*",
    "conformance/platforms/*",
    "conformance/sanitizers/*",
    "conformance/test_archive.py",
    "conformance/test_description.py",
    "conformance/test_rebuild.py",
    "conformance/test_state.py",
    "conformance/test_steps_and_experiment.py",
    "faults/test_check_command.py",
    "faults/test_cli.py",
    "interop/*",
    "scenarios/test_tutorial.py",
    "unit/test_untested.py",
    "unit/test_versions.py",
    "unit/adaptimp_fmu/test_testing.py",
    "unit/adaptimp_fmu/test_toolchain.py",
    "unit/orchestration/check/*",
    "unit/orchestration/master/test_oracle.py",
    "unit/orchestration/master/test_recording.py",
    "unit/orchestration/master/test_snapshots.py",
    "unit/orchestration/master/test_threads.py",
    "unit/orchestration/results/test_files.py",
    "unit/orchestration/results/test_full_disk.py",
)
"""Files, below ``tests/``, whose tests have to do with processes, threads, signals or clocks."""

QUICK = ("golden/*", "property/*", "unit/*", "faults/*", "conformance/*")
"""Files whose tests are quick unless they are in `PROCESSES` or `SLOW`."""

SLOW = ()
"""Files that take seconds though they start no process."""

QUICK_UNITS = ("Plant", "ForceSensor")
"""Units that stand for all in quick tests: a continuous one, and a sampled one with random numbers."""


def mark(items: Iterable[pytest.Item]) -> None:
    """Give each test the marks that its file and its unit ask for."""
    for item in items:
        if not item.path.is_relative_to(TESTS):
            continue
        path = item.path.relative_to(TESTS).as_posix()
        if _is_in(path, PROCESSES):
            item.add_marker(pytest.mark.processes)
        elif _is_in(path, QUICK) and not _is_in(path, SLOW) and _unit(item) in (None, *QUICK_UNITS):
            item.add_marker(pytest.mark.quick)


def _is_in(path: str, patterns: Iterable[str]) -> bool:
    return any(fnmatch(path, pattern) for pattern in patterns)


def _unit(item: pytest.Item) -> object:
    """The unit of the catalog that the test is about, None if it is about no unit in particular."""
    called = getattr(item, "callspec", None)
    return called.params.get("unit") if called else None
