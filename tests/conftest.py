"""Fixtures shared by all tests."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from xdist.scheduler import LoadFileScheduling

from adaptimp_fmu import build
from fmus.catalog import MODELS
from tests import selection
from tests.bytecode import pytest_configure, pytest_unconfigure  # noqa: F401, pytest finds them by their names
from tests.closing_line import pytest_terminal_summary  # noqa: F401, pytest finds it by its name
from tests.driver import Driver
from tests.sharing import made_once

TOGETHER = ("tests/conformance/platforms/", "tests/install/", "tests/reference/")
"""Folders whose tests one worker runs, because the others would wait for what the first of these tests makes."""


class ByFile(LoadFileScheduling):
    """Gives all tests of a file to one worker, and those of the folders `TOGETHER` as if they were one file."""

    def _split_scope(self, nodeid: str) -> str:
        """Return the name of what a test is given to a worker with."""
        return next((folder for folder in TOGETHER if nodeid.startswith(folder)), super()._split_scope(nodeid))


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> ByFile:
    """Let xdist use `ByFile`."""
    return ByFile(config, log)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that are quick, and those that have to do with processes."""
    selection.mark(items)


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the FMU of every model, built for this machine."""

    def build_all(folder: Path) -> None:
        for declare in MODELS.values():
            build(declare(), folder)

    return made_once(tmp_path_factory, "fmus", build_all)


@pytest.fixture(scope="session")
def reals_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the FMU of every model, with Reals in the place of Booleans and Integers."""

    def build_all(folder: Path) -> None:
        for declare in MODELS.values():
            build(declare(), folder, reals=True)

    return made_once(tmp_path_factory, "reals", build_all)


@pytest.fixture
def open_fmu(fmu_folder: Path) -> Iterator[Callable[..., Driver]]:
    """Opens ``NAME.fmu`` as a `Driver`; everything opened is freed after the test."""
    drivers: list[Driver] = []

    def open_one(name: str | Path) -> Driver:
        path = name if isinstance(name, Path) else fmu_folder / f"{name}.fmu"
        drivers.append(Driver(path))
        return drivers[-1]

    yield open_one
    for driver in drivers:
        driver.close()
