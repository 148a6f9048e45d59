"""Fixtures: systems of two FMUs, one of which does what its parameters say, and is reset as its kind says."""

from collections.abc import Callable
from pathlib import Path

import pytest

from orchestration import System
from tests.pooled.fmus import compiled, system_of
from tests.sharing import made_once

Pooled = Callable[..., System]


@pytest.fixture(scope="session")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the library, and with one that lacks fmi2Reset."""

    def make(folder: Path) -> None:
        compiled(folder / "whole")
        compiled(folder / "unresettable", "-DWITHOUT_RESET")

    return made_once(tmp_path_factory, "pooled", make)


@pytest.fixture
def pooled(libraries: Path, tmp_path: Path) -> Pooled:
    """Make a system; the arguments are the kind and the library of ``m``, and those of `system_of`."""

    def make(kind: str = "good", library: str = "whole", **more: str) -> System:
        return system_of(tmp_path, libraries / "whole", libraries / library, kind, **more)

    return make
