"""Evidence that a report tells the command that makes a run again, draws the arm, and refuses what it cannot show."""

import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import OrchestrationError, Result, scenario, simulate, write_report
from orchestration.paper.page.again import command_again
from orchestration.paper.page.arm import arm_of, arm_section, has_arm
from orchestration.paper.page.assumptions import assumptions_of, assumptions_section
from orchestration.paper.page.panels import paper_panels
from orchestration.paper.scenarios import SCENARIOS
from orchestration.results.row_hash import row_hash
from tests.faults.cli import runner

SHORT = 0.01  # s


@pytest.fixture(scope="module")
def fig2() -> Result:
    return simulate(scenario("fig2"), stop_time=SHORT)


def test_a_scenario_is_named_by_its_name(fig2: Result) -> None:
    assert command_again(fig2) == "adaptimp run fig2 --stop 0.01 --hash"


def test_the_command_gives_the_rows_again(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A controller, start values, a period and an algorithm of its own: all are in the command."""
    system = scenario("fig5", controller="SlotineLiAdaptiveImpedance")
    system = system.set({"controller.K[1]": 3000.0, "plant.mu": 0.25}).with_sample_time(2e-5)
    result = simulate(system, stop_time=SHORT, algorithm="jacobi")
    command = shlex.split(command_again(result))
    assert command[:2] == ["adaptimp", "run"]
    said = runner(monkeypatch, capsys)(*command[1:]).out
    assert f"SHA-256 of the rows: {row_hash(result)}" in said


def test_a_run_with_changes_from_outside_has_no_command(fig2: Result) -> None:
    changed = replace(fig2, metadata={**fig2.metadata, "changes": "[]"})
    assert command_again(changed).startswith("None: values came from outside")


def test_a_foreign_system_is_named_in_capitals(fig2: Result) -> None:
    foreign = replace(fig2, metadata={**fig2.metadata, "system": "tank; rm -rf"})
    command = command_again(foreign)
    assert command.startswith("adaptimp run SYSTEM --step 0.0001 --stop 0.01 --hash  # SYSTEM: the file of")


def test_the_wall_and_the_links_are_those_of_the_run(fig2: Result) -> None:
    found = arm_of(fig2)
    assert found["lengths"] == [1.0, 1.0]
    assert found["normal"] == [-1.0, 0.0]
    assert found["offset"] == pytest.approx(SCENARIOS["fig2"].values["plant.wall_offset"].number, abs=1e-12)


def test_what_is_missing_is_said() -> None:
    columns = ("plant.x[1]", "plant.x[2]")
    bare = Result(np.array([0.0, 1.0]), columns, np.array([[1.5, 0.0], [1.4, 0.1]]))
    assert has_arm(bare)
    assert set(arm_of(bare)) == {"lengths"}
    assert (
        "run has no plant.q, plant.F_ext, actuator.tau, trajectory.x_v, controller.x_t"
        in arm_section({"run": bare}).html
    )
    assert paper_panels([bare]) == []


def test_a_spatial_tip_is_no_planar_arm() -> None:
    columns = tuple(f"plant.x[{i}]" for i in (1, 2, 3))
    assert not has_arm(Result(np.zeros(1), columns, np.zeros((1, 3))))


def test_only_values_that_the_run_has_kept_are_called_assumed() -> None:
    system = scenario("fig2").set({"plant.mu": 0.3})
    result = simulate(system, stop_time=SHORT)
    for found in (assumptions_of(result, system), assumptions_of(result, None)):
        assert "plant.mu" not in found
        assert found["plant.wall_offset"][0] == SCENARIOS["fig2"].values["plant.wall_offset"].number
        assert found["plant.wall_offset"][1].startswith("assumed: ")
    section = assumptions_section({"run": result}, {})
    assert section is not None
    assert "the same for Figs. 2 to 7" in section.html


def test_a_report_about_nothing_is_refused(fig2: Result, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    empty = Result(np.zeros(0), ("a.y",), np.zeros((0, 1)))
    with pytest.raises(OrchestrationError, match="a: the result has no rows, so there is nothing to report"):
        write_report({"a": empty}, tmp_path / "a.html")
    with pytest.raises(OrchestrationError, match="3 results were given; a report is about one, or compares two"):
        write_report(dict.fromkeys("abc", fig2), tmp_path / "a.html")
    with pytest.raises(OrchestrationError, match=r"a\.pdf: a page has the suffix \.html; Result\.plot draws pictures"):
        write_report({"a": fig2}, tmp_path / "a.pdf")
    with pytest.raises(OrchestrationError, match="the page cannot be written"):
        write_report({"a": fig2}, tmp_path / "file" / "a.html")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_the_same_runs_give_the_same_bytes(fig2: Result, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        write_report({"run": fig2}, tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
