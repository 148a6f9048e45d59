"""The marks quick and processes come from a rule, and the rule knows the files that are there."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.selection import PROCESSES, QUICK, QUICK_UNITS, SLOW, TESTS, mark

DISTURBED = {"concurrent.futures", "multiprocessing", "signal", "subprocess", "threading", "time"}
"""Modules of Python with which a test starts processes or threads, sends signals or reads clocks."""


def imported(file: Path) -> Iterator[str]:
    """Names of the modules that a file imports."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""


def marks(path: Path, **parameters: str) -> set[str]:
    """Marks that a test of a file gets, for these parameters."""
    item = Item(path, parameters)
    mark([item])  # type: ignore[list-item]
    return item.marks


class Item:
    """What `mark` asks of a test."""

    def __init__(self, path: Path, parameters: dict[str, str]) -> None:
        self.path, self.marks = path, set[str]()
        if parameters:
            self.callspec = type("Parameters", (), {"params": parameters})

    def add_marker(self, marker: pytest.MarkDecorator) -> None:
        """Keep the name of a mark."""
        self.marks.add(marker.name)


@pytest.mark.parametrize("pattern", [*PROCESSES, *QUICK, *SLOW])
def test_each_pattern_names_files_that_are_there(pattern: str) -> None:
    assert list(TESTS.glob(pattern))


def test_what_imports_processes_signals_or_clocks_is_marked() -> None:
    files = [path for path in TESTS.rglob("test_*.py") if DISTURBED.intersection(imported(path))]
    assert len(files) > 10
    assert [str(path) for path in files if "processes" not in marks(path)] == []


def test_a_test_about_a_unit_is_quick_for_two_of_them() -> None:
    file = TESTS / "conformance" / "test_numbers.py"
    assert {unit for unit in ("Actuator", "Plant", "ForceSensor") if "quick" in marks(file, unit=unit)} == {
        *QUICK_UNITS
    }
    assert marks(file) == {"quick"}


def test_no_mark_comes_to_what_is_slow_or_elsewhere(tmp_path: Path) -> None:
    assert marks(TESTS / "reference" / "test_monolithic.py") == set()
    assert marks(tmp_path / "unit" / "test_other.py") == set()
