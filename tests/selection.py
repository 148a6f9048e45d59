"""Which tests carry the marks ``quick`` and ``processes``: a rule by folder, file and model, not by test.

``pytest -m quick`` runs a cross-section of every kind of evidence that is cheap. ``pytest -m processes``
runs what starts processes or threads, sends signals, or reads a clock: the tests that other programs on the
machine can disturb.
"""

from collections.abc import Iterable
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

TESTS = Path(__file__).parent

DISTURBED = {"concurrent", "distributed", "multiprocessing", "signal", "subprocess", "threading", "time"}
"""Packages with which a test starts processes or threads, sends signals or reads clocks."""

PROCESSES = (
    "benchmarks/*",
    "conformance/platforms/*",
    "conformance/sanitizers/*",
    "conformance/test_description.py",
    "faults/test_campaign_kills.py",
    "faults/test_check_command.py",
    "faults/test_kills.py",
    "faults/test_lies.py",
    "install/*",
    "interop/*",
    "pooled/*",
    "scenarios/test_containers_page.py",
    "scenarios/test_tutorial.py",
    "unit/adaptimp_fmu/test_toolchain.py",
    "unit/orchestration/campaigns/store/test_full_disk.py",
    "unit/orchestration/check/*",
    "unit/orchestration/results/test_full_disk.py",
    "unit/orchestration/sandbox/test_process.py",
)
"""Files, below ``tests/``, whose tests do so through helpers; other files are known by what they import."""

QUICK = ("golden/*", "property/*", "unit/*", "faults/*", "conformance/*")
"""Files whose tests are quick unless they have to do with processes or are in `SLOW`."""

SLOW = (
    "faults/test_all_scenarios.py",
    "faults/test_cli_examples.py",
    "faults/test_doctor_command.py",
    "faults/test_sweep_command.py",
    "unit/fmus/test_documented_examples.py",
    "unit/orchestration/analysis/test_doctor.py",
    "unit/orchestration/analysis/test_stability.py",
    "unit/orchestration/master/test_stiffness.py",
    "unit/orchestration/test_public_face.py",
)
"""Files that take seconds though they start no process."""

QUICK_FMUS = ("Plant", "ForceSensor")
"""FMUs that stand for all in quick tests: a continuous one, and a sampled one with random numbers."""


def mark(items: Iterable[Any]) -> None:
    """Give each test, a `pytest.Item`, the marks that its file, its imports and its FMU ask for."""
    for item in items:
        if not item.path.is_relative_to(TESTS):
            continue
        path = item.path.relative_to(TESTS).as_posix()
        if _is_in(path, PROCESSES) or _is_disturbed(getattr(item, "module", None)):
            item.add_marker(pytest.mark.processes)
        elif _is_in(path, QUICK) and not _is_in(path, SLOW) and _fmu(item) in (None, *QUICK_FMUS):
            item.add_marker(pytest.mark.quick)


def _is_in(path: str, patterns: Iterable[str]) -> bool:
    return any(fnmatch(path, pattern) for pattern in patterns)


@cache
def _is_disturbed(module: ModuleType | None) -> bool:
    """Whether a module has a name from one of the packages `DISTURBED`."""
    origins = (
        [
            value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None)
            for value in vars(module).values()
        ]
        if module
        else []
    )
    return any(isinstance(origin, str) and origin.partition(".")[0] in DISTURBED for origin in origins)


def _fmu(item: Any) -> object:
    """The model of the catalog that the test is about, None if it is not about a certain model."""
    called = getattr(item, "callspec", None)
    return called.params.get("identifier") if called else None
