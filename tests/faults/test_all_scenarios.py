"""Evidence that every scenario is public: listed, run and exported by its name."""

import json
from pathlib import Path

import pytest

from orchestration import Result
from orchestration.paper.scenarios import ALL_SCENARIOS, SCENARIOS, VARIANTS
from tests.faults.cli import Command

PAGE = Path(__file__).parents[2] / "docs" / "command-line.md"


def test_all_are_listed(adaptimp: Command) -> None:
    listed = json.loads(adaptimp("list", "--json").out)["scenarios"]
    assert set(listed) == set(ALL_SCENARIOS) >= {"ideal", "spong-ortega", *SCENARIOS}
    assert all(listed.values())


def test_the_page_names_the_figures_and_the_runs_beside_them() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert all(f"`{name}`" in text for name in (*SCENARIOS, *VARIANTS))


@pytest.mark.parametrize("name", ALL_SCENARIOS)
def test_each_runs_by_its_name(adaptimp: Command, tmp_path: Path, name: str) -> None:
    outcome = adaptimp("run", name, "--stop", "1e-3", "--no-verdict", "-o", tmp_path / "x.parquet")
    assert outcome.code == 0, outcome.err
    assert len(Result.read(tmp_path / "x.parquet").time) == round(1e-3 / ALL_SCENARIOS[name].step) + 1


@pytest.mark.parametrize("name", VARIANTS)
def test_the_runs_beside_the_figures_are_exported(adaptimp: Command, tmp_path: Path, name: str) -> None:
    assert adaptimp("export", name, "-o", tmp_path / "x.ssp").code == 0
    outcome = adaptimp("run", tmp_path / "x.ssp", "--stop", "1e-3", "--no-verdict", "-o", tmp_path / "x.parquet")
    assert outcome.code == 0, outcome.err
