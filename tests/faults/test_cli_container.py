"""A system that ``adaptimp export`` wrote as one FMU is run, shown and checked by the other commands."""

import json
from pathlib import Path

from orchestration import Result, System
from tests.faults.cli import Command


def test_a_container_is_exported_run_shown_and_checked(adaptimp: Command, fig2: System, tmp_path: Path) -> None:
    said = adaptimp("export", "fig2", "--set", "controller.K=[4000,2000]", "-o", "arm.fmu")
    assert said.out == "wrote arm.fmu: 5 components, 20 connections, in steps of 0.0001 s\n"
    expected = fig2.set({"controller.K": [4000.0, 2000.0]}).to_fmu(tmp_path / "expected.fmu")
    assert (tmp_path / "arm.fmu").read_bytes() == expected.read_bytes()
    assert adaptimp("export", "fig2", "--set", "controller.K=[4000,2000]", "-o", "arm.fmu").out.startswith(
        "replaced arm"
    )

    ran = adaptimp("run", "arm.fmu", "--stop", "0.01", "--record", "arm.plant.*", "-o", "one.csv")
    assert ran.code == 0, ran.err
    whole = ("--set", "controller.K=[4000,2000]", "--stop", "0.01", "--record", "plant.*")
    assert adaptimp("run", "fig2", *whole, "-o", "many.csv").code == 0
    one, many = (Result.read(tmp_path / name) for name in ("one.csv", "many.csv"))
    assert len(one.time) == 101
    for name in many.names:
        assert one[f"arm.{name}"].tobytes() == many[name].tobytes(), name

    shown = json.loads(adaptimp("info", "arm.fmu", "--json").out)
    assert "plant.x[1]" in json.dumps(shown)
    assert adaptimp("check", "arm.fmu").out.splitlines()[-1] == "arm.fmu: no findings"


def test_a_platform_that_is_unknown_is_refused(adaptimp: Command, tmp_path: Path) -> None:
    outcome = adaptimp("export", "fig2", "--platform", "linux46", "-o", "arm.fmu")
    assert outcome.code == 2
    assert outcome.sentence.startswith("There is no platform linux46; did you mean linux64")
    assert list(tmp_path.iterdir()) == []
