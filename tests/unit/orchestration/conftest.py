"""Fixtures: the FMUs of small models, fig2, and a cache of its own for every test that reads packages."""

import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import System
from orchestration.paper.scenarios import SCENARIOS
from orchestration.results import arrow_table
from tests.sharing import made_once
from tests.unit.orchestration.foreign import build_foreign
from tests.unit.orchestration.small_models import H, build_small_models, mixed
from tests.unit.orchestration.stored import NAMES


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """FMU files of the small models, by model identifier."""
    return {path.stem: path for path in made_once(tmp_path_factory, "small", build_small_models).glob("*.fmu")}


@pytest.fixture(scope="session")
def strange(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """FMU files of foreign models, by model identifier."""
    return {path.stem: path for path in made_once(tmp_path_factory, "strange", build_foreign).glob("*.fmu")}


@pytest.fixture(scope="session")
def fig2(fmu_folder: Path) -> System:
    """The system of Fig. 2."""
    scenario = SCENARIOS["fig2"]
    return scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder of the test's own."""
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def signals(small: dict[str, Path]) -> System:
    """A system with a start value of each type."""
    values = {"relay.offset": 0.1, "relay.n": -7, "relay.even": True, "switch.flag": False, "source.sample_time": H}
    return replace(mixed(small).set(values), step=H / 2, stop_time=1.5)


@pytest.fixture
def package(signals: System, tmp_path: Path) -> Path:
    """That system as a package."""
    return signals.write(tmp_path / "signals.ssp")


@pytest.fixture
def small_groups(monkeypatch: pytest.MonkeyPatch) -> int:
    """Row groups of 64 rows of the sample."""
    monkeypatch.setattr(arrow_table, "ROW_GROUP_BYTES", 64 * 8 * (len(NAMES) + 1))
    return 64


@pytest.fixture
def heeded() -> Iterator[None]:
    """Heed SIGINT as in the foreground, because a shell starts background processes with SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
