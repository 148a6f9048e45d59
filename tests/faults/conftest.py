"""Fixtures: the command line in an empty folder, and packages with one fault each."""

from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import System
from orchestration.paper.scenarios import SCENARIOS
from tests.faults.cli import Command, runner
from tests.unit.orchestration.packages import SSD_FILE, edited, substitute


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command line, run in the test's own folder."""
    monkeypatch.chdir(tmp_path)
    return runner(monkeypatch, capsys)


@pytest.fixture(scope="module")
def fig2(fmu_folder: Path) -> System:
    """The system of Fig. 2."""
    scenario = SCENARIOS["fig2"]
    return scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})


@pytest.fixture(scope="module")
def packages(fig2: System, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Packages of fig2: as it is, with a connection missing, and with one between units that differ."""
    folder = tmp_path_factory.mktemp("packages")
    good = fig2.write(folder / "good.ssp")
    fewer = tuple(c for c in fig2.connections if (c.target, c.input) != ("sensor", "F_ext[2]"))
    wrong = substitute(r'startConnector="F_ext\[1\]" endElement="sensor"', 'startConnector="x[1]" endElement="sensor"')
    return {
        "good": good,
        "loose": replace(fig2, connections=fewer).write(folder / "loose.ssp"),
        "units": edited(good, SSD_FILE, wrong),
    }
