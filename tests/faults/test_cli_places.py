"""Tests of the command line on folders, .ssd files and variants of packages."""

import json
import zipfile
from pathlib import Path

import pytest

from tests.faults.cli import Command

SSD = "SystemStructure.ssd"


@pytest.fixture
def folder(adaptimp: Command) -> Path:
    """An unpacked package of Fig. 2 with a variant in which runs begin at 0.5 s."""
    assert adaptimp("export", "fig2", "-o", "fig2.ssp").code == 0
    with zipfile.ZipFile("fig2.ssp") as archive:
        archive.extractall("loop")
    text = Path("loop", SSD).read_text(encoding="utf-8")
    Path("loop", "Late.ssd").write_text(text.replace('startTime="0.0"', 'startTime="0.5"'), encoding="utf-8")
    return Path("loop")


@pytest.mark.parametrize("name", ["loop", f"loop/{SSD}", "fig2.ssp"])
def test_a_folder_runs_as_its_package_does(adaptimp: Command, folder: Path, name: str) -> None:
    assert folder.is_dir()
    outcome = adaptimp("run", name, "--stop", "0.01", "--record", "plant.x", "-o", "x.csv", "--no-verdict")
    assert (outcome.code, outcome.err) == (0, "")
    assert "100 steps" in outcome.out


def test_a_variant_is_run_listed_and_exported(adaptimp: Command, folder: Path) -> None:
    outcome = adaptimp("run", folder, "--variant", "Late", "--stop", "0.51", "--no-verdict", "--json")
    facts = json.loads(outcome.out)
    assert (facts["start_time"], facts["stop_time"], facts["steps"]) == (0.5, 0.51, 100)
    assert "  variants: SystemStructure, Late\n" in adaptimp("info", folder).out
    found = json.loads(adaptimp("info", folder, "--variant", "Late", "--json").out)
    assert (found["variants"], found["experiment"]["start"]) == (["SystemStructure", "Late"], 0.5)
    assert adaptimp("export", folder, "--variant", "Late", "-o", "late.ssp").code == 0
    assert json.loads(adaptimp("info", "late.ssp", "--json").out)["experiment"]["start"] == 0.5
    assert adaptimp("run", folder, "--variant", "Late", "--start", "0", "--stop", "0.01", "--no-verdict").code == 0


def test_a_wrong_variant_is_one_sentence(adaptimp: Command, folder: Path) -> None:
    outcome = adaptimp("run", folder, "--variant", "Early")
    assert (outcome.code, outcome.sentence) == (2, "loop has no variant Early; there are SystemStructure, Late.")
    words = "--variant Early: only a package has variants, and fig2 is none."
    assert adaptimp("info", "fig2", "--variant", "Early").sentence == words


def test_a_scenario_goes_before_a_folder_of_its_name(adaptimp: Command) -> None:
    Path("fig2").mkdir()
    assert adaptimp("info", "fig2").code == 0
