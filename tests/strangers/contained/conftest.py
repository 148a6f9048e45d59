"""Fixtures: programs of systems, each compiled for one test and freed after it."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from orchestration import System
from tests.sharing import made_once
from tests.strangers.contained.fmus import small
from tests.strangers.contained.program import Program

Compiled = Callable[..., Program]


@pytest.fixture(scope="session")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two small FMUs that define equal names, and differ in a number."""

    def make(folder: Path) -> None:
        small(folder, "First")
        small(folder, "Second", gain=-2.0)

    folder = made_once(tmp_path_factory, "small_fmus_with_sources", make)
    return folder / "First.fmu", folder / "Second.fmu"


@pytest.fixture
def compiled(tmp_path: Path) -> Iterator[Compiled]:
    """Compiles the program of a system."""
    programs: list[Program] = []

    def compile_one(system: System, **options: Any) -> Program:
        folder = tmp_path / f"program{len(programs)}"
        folder.mkdir()
        programs.append(Program(system, folder, **options))
        return programs[-1]

    yield compile_one
    for program in programs:
        program.close()
