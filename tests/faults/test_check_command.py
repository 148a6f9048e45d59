"""Tests of ``adaptimp check``: its exit codes, its table and its JSON."""

import json
from pathlib import Path

import pytest

from orchestration.cli.check import run_check
from tests.faults.cli import Command
from tests.unit.orchestration.checked import edited, swap

Captured = pytest.CaptureFixture[str]


def test_a_good_unit(fmu_folder: Path, adaptimp: Command) -> None:
    outcome = adaptimp("check", fmu_folder / "Plant.fmu")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines()[-1] == "Plant.fmu, plant: no findings"


@pytest.mark.parametrize("identifier", ["CraigAdaptiveImpedance", "HoganImpedance3R"])
def test_a_good_controller_drives_the_papers_loop(fmu_folder: Path, capsys: Captured, identifier: str) -> None:
    assert run_check(fmu_folder / f"{identifier}.fmu", "controller", True) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["findings"] == []
    assert report["role"] == "controller"
    assert report["facts"][-4].startswith("Closed loop of 1.2 s: max |x - x_v| = ")


def test_names_are_mapped(fmu_folder: Path, tmp_path: Path, adaptimp: Command) -> None:
    path = edited(fmu_folder / "HoganImpedance.fmu", tmp_path, lambda xml: xml.replace('name="tau_cmd[', 'name="T['))
    outcome = adaptimp("check", path, "--map", "tau_cmd=T")
    assert outcome.code == 0
    assert outcome.out.splitlines()[-1] == "HoganImpedance.fmu, controller: no findings"
    wrong = adaptimp("check", path, "--map", "tau_cmd")
    assert (wrong.code, wrong.sentence) == (2, "--map tau_cmd: NAME=VALUE is needed.")


def test_a_wrong_unit(fmu_folder: Path, tmp_path: Path, capsys: Captured) -> None:
    path = edited(fmu_folder / "Plant.fmu", tmp_path, swap('name="gap"', 'name="distance"'))
    assert run_check(path, None, False) == 0, "a note is no error"
    out = capsys.readouterr().out
    assert " role │ note " in out
    assert out.splitlines()[-1] == "Plant.fmu, plant: 1 note"
    assert run_check(path, "sensor", True) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["errors"] == len([f for f in report["findings"] if f["severity"] == "error"]) > 0
    assert {"rule", "severity", "message"} == set(report["findings"][0])


def test_a_controller_with_other_names(fmu_folder: Path, tmp_path: Path, capsys: Captured) -> None:
    def edit(xml: str) -> str:
        return xml.replace('"tau_cmd[', '"Torque[').replace('"q[', '"JointAngle[')

    path = edited(fmu_folder / "HoganImpedance.fmu", tmp_path, edit)
    assert run_check(path, None, True, ["tau_cmd=Torque", "q=JointAngle"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["role"], report["findings"]) == ("controller", [])
    assert report["facts"][-1].startswith("Closed loop of 1.2 s")
    assert run_check(path, None, False, ["tau_cmd"]) == 2
    assert "--map tau_cmd: NAME=VALUE is needed" in capsys.readouterr().err


@pytest.mark.parametrize("as_json", [False, True])
def test_what_cannot_be_examined(tmp_path: Path, fmu_folder: Path, capsys: Captured, as_json: bool) -> None:
    for path, role, said in (
        (tmp_path / "none.fmu", None, "there is no such file"),
        (tmp_path, None, "is a folder; give the path of a file"),
        (fmu_folder / "Plant.fmu", "pilot", "There is no role pilot"),
    ):
        assert run_check(path, role, as_json) == 2
        out, err = capsys.readouterr()
        assert said in err
        assert said in json.loads(out)["error"] if as_json else out == ""


def test_a_file_that_is_no_fmu(tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "text.fmu"
    path.write_text("no archive")
    assert run_check(path, None, False) == 1
    assert "is not a readable zip archive" in capsys.readouterr().out
