"""Fixtures: the FMUs for all platforms as ``adaptimp build`` leaves them, and what runs them here."""

import os
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest

from adaptimp_fmu import host_platform
from adaptimp_fmu.toolchain import PLATFORMS
from fmus.catalog import MODELS
from tests.conformance.container import CONTAINER, write_container
from tests.conformance.platforms.machines import Machine, MachineUnavailableError, machine
from tests.sharing import made_once

ROOT = Path(__file__).parents[3]
FOREIGN = ("win64", "aarch64-linux")  # what Wine and qemu run
COMMAND = "from orchestration.cli import main; main()"


def build_all(folder: Path, environment: Mapping[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """``adaptimp build --platform all --out FOLDER``, with changes to the environment."""
    return subprocess.run(
        [sys.executable, "-c", COMMAND, "build", "--platform", "all", "--out", str(folder)],
        cwd=ROOT,
        env=os.environ | (environment or {}),
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(params=(*MODELS, CONTAINER))
def identifier(request: pytest.FixtureRequest) -> str:
    """Name of each FMU that is built for all platforms, the container last."""
    return request.param


@pytest.fixture(scope="session")
def portable(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the FMU of every model for all platforms; a minute when nothing is in the caches."""

    def build(folder: Path) -> None:
        run = build_all(folder)
        assert run.returncode == 0, run.stderr

    return made_once(tmp_path_factory, "portable", build)


@pytest.fixture(scope="session")
def portable_file(portable: Path, fmu_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Finds the file for all platforms of an FMU, which may be the container, by its name."""

    def find(name: str) -> Path:
        if name != CONTAINER:
            return portable / f"{name}.fmu"
        folder = made_once(tmp_path_factory, "portable container", lambda at: write_container(fmu_folder, at, ["all"]))
        return folder / f"{CONTAINER}.fmu"

    return find


@pytest.fixture(scope="session")
def content(portable_file: Callable[[str], Path]) -> Callable[[str, str], bytes]:
    """Reads an FMU's shared library for a platform."""

    def read(identifier: str, platform: str) -> bytes:
        with zipfile.ZipFile(portable_file(identifier)) as archive:
            return archive.read(f"binaries/{platform}/{identifier}{PLATFORMS[platform].extension}")

    return read


@pytest.fixture(scope="session")
def native() -> Machine:
    """The machine that the tests run on."""
    return Machine(host_platform())


@pytest.fixture(scope="session", params=FOREIGN)
def foreign(request: pytest.FixtureRequest) -> Iterator[Machine]:
    """Another platform's machine, of those that can be had here."""
    try:
        with machine(request.param) as found:
            yield found
    except MachineUnavailableError as error:
        pytest.skip(f"{request.param}: {error}")
