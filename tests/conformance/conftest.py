"""Fixtures: each FMU's binary, loaded once, and its instances."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.conformance.binary import Binary, Instance
from tests.conformance.container import CONTAINER, FMUS, write_container
from tests.conformance.units import file_of_unit
from tests.sharing import made_once


@pytest.fixture(scope="session")
def file_of(fmu_folder: Path, reals_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Finds the file of an FMU, which may be the container, by its name."""

    def find(name: str) -> Path:
        if name != CONTAINER:
            return file_of_unit(name, fmu_folder, reals_folder)
        folder = made_once(tmp_path_factory, "container", lambda place: write_container(fmu_folder, place))
        return folder / f"{CONTAINER}.fmu"

    return find


@pytest.fixture(scope="session")
def load(file_of: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Binary]:
    """Loads an FMU's binary, once."""
    loaded: dict[str, Binary] = {}

    def load_once(name: str) -> Binary:
        if name not in loaded:
            loaded[name] = Binary(file_of(name), tmp_path_factory.mktemp(Path(name).name))
        return loaded[name]

    return load_once


@pytest.fixture(params=FMUS)
def identifier(request: pytest.FixtureRequest) -> str:
    """Name of each FMU in turn, the container last."""
    return request.param


@pytest.fixture
def fmu(file_of: Callable[[str], Path], identifier: str) -> Path:
    """File of each FMU in turn."""
    return file_of(identifier)


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
