"""Fixtures: FMUs that do something unruly in one of their functions."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from adaptimp_fmu.toolchain import fmi_headers
from orchestration import System
from tests.faults.cli import Command, runner
from tests.sharing import made_once
from tests.strangers.fmus import Y, description, packed

Unruly = Callable[..., System]
ALONE = '<Unknown index="1" dependencies=""/>'
FLAGS = 'canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
AT_LOADING = ("flush", "exit", "crash")


def _compiled(output: Path, *flags: str) -> None:
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O1", "-I", str(fmi_headers())]
    command += ["-DFMI2_FUNCTION_PREFIX=", "-fno-sanitize=all", *flags]
    command += [str(Path(__file__).with_name("unruly.c")), "-o", str(output), "-lm"]
    subprocess.run(command, check=True, capture_output=True, text=True)


@pytest.fixture(scope="session")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The library by the deed that it does when it is loaded; by an empty text the one that does nothing then."""
    names = ("", *AT_LOADING)

    def make(folder: Path) -> None:
        for name in names:
            _compiled(folder / f"unruly{name}", *([f'-DAT_LOADING="{name}"'] if name else []))

    folder = made_once(tmp_path_factory, "unruly", make)
    return {name: folder / f"unruly{name}" for name in names}


@pytest.fixture
def unruly_file(libraries: dict[str, Path], tmp_path: Path) -> Callable[[str], Path]:
    """Make an FMU in the test's folder that does a deed in a place, such as ``step crash``; y is the time."""

    def make(deed: str) -> Path:
        place, _, what = deed.partition(" ")
        xml = description(deed, [Y], outputs=ALONE, flags=FLAGS, identifier="Unruly")
        name = f"{deed.replace(' ', '_')}.fmu"
        return packed(tmp_path / name, libraries[what if place == "load" else ""], xml)

    return make


@pytest.fixture
def unruly(unruly_file: Callable[[str], Path]) -> Unruly:
    """Make a system of one component, ``m``, whose FMU does a deed in a place."""
    return lambda deed: System.of({"m": unruly_file(deed)})


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)
