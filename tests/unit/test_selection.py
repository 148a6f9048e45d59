"""The marks quick and processes come from a rule, and the rule knows the files that are there."""

import concurrent.futures
import signal
import subprocess
from pathlib import Path
from types import ModuleType

import pytest

from tests.selection import PROCESSES, QUICK, QUICK_FMUS, SLOW, TESTS, mark

UNIT = TESTS / "unit" / "test_example.py"


def marks(path: Path, module: ModuleType | None = None, **parameters: str) -> set[str]:
    """Marks that a test of a file and a module gets, for these parameters."""
    item = Item(path, module, parameters)
    mark([item])
    return item.marks


class Item:
    """What `mark` asks of a test."""

    def __init__(self, path: Path, module: ModuleType | None, parameters: dict[str, str]) -> None:
        self.path, self.module, self.marks = path, module, set[str]()
        if parameters:
            self.callspec = type("Parameters", (), {"params": parameters})

    def add_marker(self, marker: pytest.MarkDecorator) -> None:
        """Keep the name of a mark."""
        self.marks.add(marker.name)


@pytest.mark.parametrize("pattern", [*PROCESSES, *QUICK, *SLOW])
def test_each_pattern_names_files_that_are_there(pattern: str) -> None:
    assert list(TESTS.glob(pattern))


@pytest.mark.parametrize(
    "name",
    [subprocess, concurrent.futures.ThreadPoolExecutor, signal.SIGINT, subprocess.run],
    ids=["module", "class", "signal", "function"],
)
def test_a_module_that_imports_processes_signals_or_clocks_is_known(name: object) -> None:
    plain, disturbed = ModuleType("plain"), ModuleType("disturbed")
    plain.__dict__.update(Path=Path, number=1.0)
    disturbed.__dict__.update(plain.__dict__, name=name)
    assert marks(UNIT, plain) == {"quick"}
    assert marks(UNIT, disturbed) == {"processes"}


def test_a_test_about_an_fmu_is_quick_for_two_of_them() -> None:
    file = TESTS / "conformance" / "test_numbers.py"
    about = {name: marks(file, identifier=name) for name in ("Actuator", "Plant", "ForceSensor")}
    assert {name for name, given in about.items() if "quick" in given} == {*QUICK_FMUS}
    assert marks(file) == {"quick"}


def test_no_mark_comes_to_what_is_slow_or_elsewhere(tmp_path: Path) -> None:
    assert marks(TESTS / "reference" / "test_monolithic.py") == set()
    assert marks(tmp_path / "unit" / "test_other.py") == set()
