"""Fixtures shared by all tests."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from adaptimp_fmu import build
from fmus.catalog import UNITS
from tests.driver import Driver


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every unit's FMU, built for this machine."""
    folder = tmp_path_factory.mktemp("fmus")
    for declare in UNITS.values():
        build(declare(), folder)
    return folder


@pytest.fixture
def open_fmu(fmu_folder: Path) -> Iterator[Callable[..., Driver]]:
    """Opens ``NAME.fmu`` as a `Driver`; everything opened is freed after the test."""
    drivers: list[Driver] = []

    def open_one(name: str | Path, **options: object) -> Driver:
        path = name if isinstance(name, Path) else fmu_folder / f"{name}.fmu"
        drivers.append(Driver(path, **options))
        return drivers[-1]

    yield open_one
    for driver in drivers:
        driver.close()
