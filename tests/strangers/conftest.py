"""Fixtures: the compiled program of all strangers, with all functions and without those that are optional."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.faults.cli import Command, runner
from tests.sharing import made_once
from tests.strangers.fmus import compiled, description, packed

Stranger = Callable[..., Path]


@pytest.fixture(scope="session")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The whole library, and one without the functions for states and derivatives."""

    def make(folder: Path) -> None:
        for name, flags in (("whole", ()), ("stateless", ("-DWITHOUT_STATE",))):
            (folder / name).mkdir()
            compiled(folder / name, *flags).rename(folder / name / "library")

    folder = made_once(tmp_path_factory, "strangers", make)
    return {name: folder / name / "library" for name in ("whole", "stateless")}


@pytest.fixture
def stranger(libraries: dict[str, Path], tmp_path: Path) -> Stranger:
    """Make an FMU of a kind in the test's folder; the arguments are those of `description`, and of `packed`."""

    def make(kind, variables, *, outputs, name="stranger", library="whole", entries=(), **more) -> Path:
        xml = description(kind, variables, outputs=outputs, **more)
        return packed(tmp_path / f"{name}.fmu", libraries[library], xml, entries)

    return make


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command line, run in the test's own folder."""
    monkeypatch.chdir(tmp_path)
    return runner(monkeypatch, capsys)
