"""Fixtures: each FMU's binary, loaded once, and its instances."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.conformance.binary import Binary, Instance
from tests.conformance.units import UNITS, file_of


@pytest.fixture(scope="session")
def load(fmu_folder: Path, reals_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Binary]:
    """Loads an FMU's binary, once."""
    loaded: dict[str, Binary] = {}

    def load_once(name: str) -> Binary:
        if name not in loaded:
            loaded[name] = Binary(file_of(name, fmu_folder, reals_folder), tmp_path_factory.mktemp(Path(name).name))
        return loaded[name]

    return load_once


@pytest.fixture(params=UNITS)
def identifier(request: pytest.FixtureRequest) -> str:
    """Name of each FMU in turn."""
    return request.param


@pytest.fixture
def fmu(fmu_folder: Path, reals_folder: Path, identifier: str) -> Path:
    """File of each FMU in turn."""
    return file_of(identifier, fmu_folder, reals_folder)


@pytest.fixture
def binary(load: Callable[[str], Binary], identifier: str) -> Binary:
    """Binary of each FMU in turn."""
    return load(identifier)


@pytest.fixture
def create() -> Iterator[Callable[..., Instance]]:
    """Creates instances, which are freed after the test."""
    instances: list[Instance] = []

    def create_one(binary: Binary, **options: Any) -> Instance:
        instances.append(Instance(binary, **options))
        return instances[-1]

    yield create_one
    for instance in instances:
        instance.free()
