"""Tests that FMUs that fail, or that nobody closes, leave neither mappings nor descriptors nor folders."""

import gc
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from orchestration import Fmu, OrchestrationError, System, simulate
from tests.unit.orchestration.checked import compiled, misbehaving

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux lists mappings")
TIMES = 40
FEW = 8  # mappings that an allocator may add; a library that stays loaded has 3 to 5, each time


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of the FMU that misbehaves."""
    return compiled(tmp_path_factory.mktemp("misbehaving"), "Misbehaving")


def held(folder: Path) -> tuple[int, int, int]:
    """Mappings and descriptors of this process, and temporary folders."""
    gc.collect()
    mappings = Path("/proc/self/maps").read_text(encoding="utf-8").count("\n")
    return mappings, len(os.listdir("/proc/self/fd")), len(list(folder.iterdir()))


def forgotten(path: Path) -> None:
    Fmu(path).step(0.5)


def closed(path: Path) -> None:
    with Fmu(path) as fmu:
        fmu.step(0.5)


def coupled(path: Path) -> None:
    simulate(System.of({"a": path}), stop_time=5.0, step=0.5, record="a.y")


@pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning")
@pytest.mark.parametrize("use", [forgotten, closed, coupled])
@pytest.mark.parametrize("fault", ["none", "refuse", "step", "terminate"])
def test_nothing_is_held(
    tmp_path: Path, library: Path, monkeypatch: pytest.MonkeyPatch, fault: str, use: Callable[[Path], None]
) -> None:
    path = misbehaving(library, tmp_path / "x.fmu", fault)
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))

    def once() -> None:
        with suppress(OrchestrationError):
            use(path)

    once()
    before = held(tmp_path / "temporary")
    for _ in range(TIMES):
        once()
    mappings, *others = held(tmp_path / "temporary")
    assert mappings <= before[0] + FEW
    assert others == [*before[1:]]
    assert others[1] == 0
