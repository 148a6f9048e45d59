"""``adaptimp run`` with time series, with changes on the way, and at the pace of the clock."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from orchestration import Algorithm, Result, System, simulate
from orchestration.cli.outside import joined
from orchestration.fmi.isolation import Isolation
from tests.faults.cli import Command

RUN = ("run", "Plant.fmu", "--step", "1e-3", "--stop", "0.01", "--no-verdict")


@pytest.fixture
def plant(fmu_folder: Path, tmp_path: Path) -> Path:
    """Put a plant and measured torques into the folder; return the folder."""
    (tmp_path / "Plant.fmu").write_bytes((fmu_folder / "Plant.fmu").read_bytes())
    (tmp_path / "tau.csv").write_text("time,Plant.tau[1] [kN.m],Plant.tau[2]\n0,0,1\n5e-3,1e-3,3\n0.01,0,-1\n")
    (tmp_path / "first.csv").write_text("time,Plant.tau[1]\n0,1\n0.01,1\n")
    return tmp_path


def torques(path: Path) -> np.ndarray:
    """Return the torques that a run recorded, N.m, shape (n, 2), without the first row."""
    return Result.read(path)["Plant.tau"][1:]


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_file_drives_inputs(adaptimp: Command, plant: Path, suffix: str) -> None:
    t = np.arange(10) * 1e-3
    times = [0.0, 5e-3, 0.01]
    for choice, expected in (
        ("", [np.interp(t, times, [0, 1, 0]), np.interp(t, times, [1, 3, -1])]),
        (":linear", [np.interp(t, times, [0, 1, 0]), np.interp(t, times, [1, 3, -1])]),
        (":held", [np.where(t < 5e-3, 0, 1), np.where(t < 5e-3, 1, 3)]),
    ):
        outcome = adaptimp(*RUN, "--input", f"tau.csv{choice}", "--record", "Plant.tau", "-o", f"x.{suffix}")
        assert (outcome.code, outcome.err) == (0, "")
        np.testing.assert_allclose(torques(plant / f"x.{suffix}"), np.column_stack(expected), atol=1e-12)
    if suffix == "parquet":
        entries = json.loads(Result.read(plant / "x.parquet").metadata["inputs"])
        assert [(e["input"], e["file"]) for e in entries] == [(f"Plant.tau[{i}]", "tau.csv") for i in (1, 2)]


@pytest.mark.usefixtures("plant")
def test_the_verdict_is_about_the_inputs_at_the_start(adaptimp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    judged: list[System] = []

    def stable(system: System, step: float, algorithm: Algorithm, *, isolation: Isolation | None) -> bool:
        judged.append(system)
        return step > 0 and bool(algorithm.name) and isolation is None

    monkeypatch.setattr("orchestration.analysis.stability.verdict.is_stable", stable)
    outcome = adaptimp(*RUN[:-1], "--input", "tau.csv")
    assert (outcome.code, outcome.err) == (0, "")
    assert [judged[0]["Plant"].start[f"tau[{i}]"] for i in (1, 2)] == [0.0, 1.0]


def test_several_files_give_different_inputs(adaptimp: Command, plant: Path) -> None:
    (plant / "second.csv").write_text("time,Plant.tau[2]\n0,2\n0.01,2\n")
    files = ("--input", "first.csv", "--input", "second.csv:held")
    assert adaptimp(*RUN, *files, "--record", "Plant.tau", "-o", "x.csv").code == 0
    np.testing.assert_array_equal(torques(plant / "x.csv"), [[1.0, 2.0]] * 10)
    twice = adaptimp(*RUN, "--input", "first.csv", "--input", "tau.csv")
    assert (twice.code, twice.sentence) == (
        2,
        "--input tau.csv: Plant.tau[1] is given by another file too, first.csv; give it once.",
    )


def test_values_change_on_the_way(adaptimp: Command, fig2: System, tmp_path: Path) -> None:
    changes = ("--at", "0.005", "controller.K=[2000,1000]", "--at", "5e-3", "controller.B=100")
    outcome = adaptimp("run", "fig2", "--stop", "0.01", *changes, "--record", "plant.x", "-o", "x.csv")
    assert outcome.code == 0
    changed = {0.005: {"controller.K": [2000.0, 1000.0], "controller.B": 100.0}}
    expected = simulate(fig2, 0.01, record="plant.x", changes=changed)
    assert Result.read(tmp_path / "x.csv").rows.tobytes() == expected.rows.tobytes()


def test_a_paced_run_says_how_late_it_was(adaptimp: Command, tmp_path: Path) -> None:
    assert adaptimp("run", "fig2", "--stop", "0.01", "--pace", "10", "--record", "plant.x", "-o", "x.csv").code == 0
    with (tmp_path / "x.csv").open(newline="") as file:
        assert next(csv.reader(file)) == ["time", "plant.x[1]", "plant.x[2]", "lateness"]
    assert (Result.read(tmp_path / "x.csv")["lateness"] >= 0).all()


def test_parameters_and_inputs_are_recorded(adaptimp: Command, tmp_path: Path) -> None:
    outcome = adaptimp("run", "fig2", "--stop", "1e-3", "--record", "controller.K,plant.tau[1]", "-o", "x.csv")
    assert outcome.code == 0
    assert Result.read(tmp_path / "x.csv").names == ("controller.K[1]", "controller.K[2]", "plant.tau[1]")


WRONG = [
    (("--at", "3", "controller.K=1"), r"changes: t = 3 s lies outside of the run from 0 s to 0.01 s."),
    (
        ("--at", "soon", "controller.K=1"),
        "--at soon controller.K=1: a time in s and COMPONENT.VARIABLE=VALUE are",
    ),
    (("--at", "0.005", "controller.K"), "--at 0.005 controller.K: a time in s and COMPONENT.VARIABLE=VALUE are needed"),
    (("--at", "0.005"), "--at 0.005: a time in s and COMPONENT.VARIABLE=VALUE are needed"),
    (("--at", "0.005", "plant.m=1"), "changes: plant.m[1] is a fixed parameter; only tunable parameters and inputs"),
    (("--at", "0.005", "plant.tau=1"), "changes: plant.tau[1] takes its value from actuator.tau[1]"),
    (("--at", "0.005", "controller.K=stiff"), "controller.K[1] = 'stiff'"),
    (("--pace", "0"), "pace = 0.0: simulated seconds per second are needed"),
    (("--input", "none.csv"), "none.csv: the time series cannot be read: No such file"),
    (("--input", "none.txt:held"), "none.txt: time series are read from .csv or .parquet, not from .txt."),
    (("--record", "controller.Q"), "controller has no variable Q"),
]


@pytest.mark.parametrize(("arguments", "words"), WRONG, ids=[" ".join(arguments) for arguments, _ in WRONG])
def test_wrong_options_are_refused(adaptimp: Command, arguments: tuple[str, ...], words: str) -> None:
    outcome = adaptimp("run", "fig2", "--stop", "0.01", "--no-verdict", *arguments)
    assert outcome.code == 2
    assert outcome.sentence.startswith(words)


def test_the_two_words_of_at_become_one() -> None:
    words = ["fig2", "--at", "1", "a.b=2", "--at", "1 a.b=2", "--stop", "1", "--at", "3", "--every", "2"]
    assert joined(words) == ["fig2", "--at", "1 a.b=2", "--at", "1 a.b=2", "--stop", "1", "--at", "3", "--every", "2"]
