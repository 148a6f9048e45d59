"""Evidence for ``--json``: one object with the documented keys, whatever becomes of the run, and nothing else."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestration import Result, RunInterrupted, Simulation, System, simulate
from tests.faults.cli import Command, Outcome

PAGE = Path(__file__).parents[2] / "docs" / "command-line.md"
SIGNALS = ("--record", "plant.x,actuator.saturated[1]")
UNSTABLE = ("--set", "controller.K[1]=1e9", "--no-verdict")


def documented() -> dict[str, str]:
    """Types of the keys of the object, as the page gives them."""
    rows = re.findall(r"^\| `(\w+)` \| ([^|]+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    return {key: kind.strip() for key, kind in rows}


KINDS: dict[str, tuple[type, ...]] = {
    "text": (str,),
    "text or null": (str, type(None)),
    "number": (float,),
    "number or null": (float, type(None)),
    "integer": (int,),
    "true or false": (bool,),
    "list of texts": (list,),
    "object": (dict,),
}


def read(outcome: Outcome) -> dict[str, Any]:
    """The object, which has all documented keys and no other, with values of the documented types."""
    found = json.loads(outcome.out)
    kinds = documented()
    assert list(found) == list(kinds)
    for key, kind in kinds.items():
        assert isinstance(found[key], KINDS[kind]), (key, found[key])
    assert found["exit_code"] == outcome.code
    return found


@pytest.mark.parametrize("suffix", [None, "csv", "parquet"])
def test_the_numbers_are_those_of_the_run(adaptimp: Command, fig2: System, suffix: str | None) -> None:
    files = [] if suffix is None else ["-o", f"x.{suffix}"]
    outcome = adaptimp("run", "fig2", "--stop", "0.1", *SIGNALS, *files, "--json")
    found, result = read(outcome), simulate(fig2, 0.1, record=["plant.x", "actuator.saturated[1]"])
    assert (found["status"], found["message"], found["exit_code"]) == ("complete", "", 0)
    assert (found["system"], found["algorithm"], found["step"]) == ("fig2", "gauss-seidel", 1e-4)
    assert found["order"] == ["trajectory", "sensor", "controller", "actuator", "plant"]
    assert (found["start_time"], found["stop_time"], found["time"]) == (0.0, 0.1, 0.1)
    assert (found["steps"], found["rows"]) == (1000, 1001)
    assert found["stepping_seconds"] > 0
    assert found["compile_seconds"] > 0
    assert (found["file"], found["replaced"]) == (None if suffix is None else f"x.{suffix}", False)
    assert list(found["signals"]) == list(result.names)
    for name, signal in found["signals"].items():
        column = result[name]
        assert signal == {
            "unit": result.unit(name),
            "min": column.min(),
            "max": column.max(),
            "final": column[-1],
        }
    assert "order trajectory > sensor" in outcome.err
    assert "1000 steps in " in outcome.err
    again = read(adaptimp("run", "fig2", "--stop", "0.1", *SIGNALS, *files, "--json"))
    assert again["replaced"] is (suffix is not None)


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_failed_run_has_its_numbers_until_then(adaptimp: Command, tmp_path: Path, suffix: str) -> None:
    outcome = adaptimp("run", "fig2", *UNSTABLE, *SIGNALS, "-o", f"x.{suffix}", "--json")
    found = read(outcome)
    assert (found["status"], outcome.code) == ("failed", 1)
    assert found["message"] == outcome.sentence
    assert found["file"] == f"x.partial.{suffix}"
    result = Result.read(tmp_path / found["file"])
    assert found["rows"] == len(result.time) == found["steps"] + 1
    assert found["time"] == result.time[-1] < found["stop_time"]
    assert found["signals"]["plant.x[1]"]["final"] == result["plant.x[1]"][-1]
    assert not read(adaptimp("run", "fig2", *UNSTABLE, *SIGNALS, "--json"))["file"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("fig9",), "There is no scenario fig9"),
        (("fig2", "--step", "nan"), "The step is nan; give a finite number, in s."),
        (("fig2", "--set", "plant.K_f=-1"), "K_f = -1 must be at least 0 N/m"),
        (("fig2", "-o", "x.txt"), "results are written as .csv or .parquet"),
    ],
)
def test_what_is_refused_is_an_object_too(
    adaptimp: Command, tmp_path: Path, options: tuple[str, ...], said: str
) -> None:
    outcome = adaptimp("run", *options, "--json")
    found = read(outcome)
    assert (found["status"], outcome.code, found["signals"], found["steps"]) == ("refused", 2, {}, 0)
    assert said in found["message"] == outcome.sentence
    assert not list(tmp_path.iterdir())


def test_an_interrupted_run_is_an_object_too(
    adaptimp: Command, fig2: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = simulate(fig2, 0.01)

    def interrupted(_: Simulation) -> None:
        raise RunInterrupted(rows)

    monkeypatch.setattr(Simulation, "run", interrupted)
    outcome = adaptimp("run", "fig2", "-o", "x.csv", "--json", "--no-verdict")
    found = read(outcome)
    assert (found["status"], outcome.code) == ("interrupted", 130)
    assert (found["file"], found["rows"]) == ("x.partial.csv", 101)
    assert found["signals"]["plant.x[1]"]["final"] == rows["plant.x[1]"][-1]
    assert outcome.err.count("Interrupted") == 1
    assert [file.name for file in tmp_path.iterdir()] == ["x.partial.csv"]


def test_warnings_and_notices_are_in_the_object(adaptimp: Command, packages: dict[str, Path]) -> None:
    loose = read(adaptimp("run", packages["loose"], "--stop", "0.01", "--json"))
    assert loose["warnings"] == ["Unconnected inputs keep their start values: sensor.F_ext[2]."]
    unstable = read(adaptimp("run", "fig2", *UNSTABLE[:2], "--stop", "1e-3", "--json"))
    assert "is UNSTABLE" in unstable["warnings"][0]
    swapped = ("--controller", "SlotineLiAdaptiveImpedance", "--stop", "1e-3")
    assert len(read(adaptimp("run", "fig2", *swapped, "--json"))["notices"]) == 2


def test_a_result_without_finite_numbers_is_valid_json(adaptimp: Command, tmp_path: Path) -> None:
    Result(np.array([0.0]), ("a.x",), np.array([[np.nan]])).write(tmp_path / "x.csv")
    found = json.loads(adaptimp("info", "x.csv", "--json").out)
    assert found["signals"] == {"a.x": {"unit": "", "min": None, "max": None, "final": None}}


def test_other_commands_print_one_object(adaptimp: Command, fmu_folder: Path) -> None:
    listed = json.loads(adaptimp("list", "--json").out)
    assert list(listed) == ["scenarios", "fmus", "variants", "algorithms", "measures"]
    reasons = json.loads(adaptimp("run", "fig2", "--assumptions", "--json").out)
    assert reasons["plant.gravity"].startswith("assumed: ")
    report = json.loads(adaptimp("check", fmu_folder / "Plant.fmu", "--json").out)
    assert report["findings"] == []
