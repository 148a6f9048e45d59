"""``adaptimp export --as``: what is written, and which requests are refused before anything is written."""

from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import System
from tests.faults.cli import Command


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_folder_of_c_has_all_that_was_changed(adaptimp: Command, fig2: System, tmp_path: Path) -> None:
    order = ("sensor", "trajectory", "controller", "actuator", "plant")
    changes = ("--set", "controller.K=[4000,2000]", "--order", ",".join(order), "--algorithm", "jacobi")
    said = adaptimp("export", "fig2", "--as", "c", *changes, "--step", "5e-5", "-o", "new/fig2")
    assert said.out == "wrote new/fig2: 5 components, 20 connections, in steps of 5e-05 s\n"
    expected = replace(fig2.set({"controller.K": [4000.0, 2000.0]}).ordered(order), step=5e-5)
    assert files(tmp_path / "new" / "fig2") == files(expected.to_c(tmp_path / "expected", algorithm="jacobi"))
    assert adaptimp("export", "fig2", "--as", "c", "-o", "new/fig2").out.startswith("replaced new/fig2: ")


def test_a_package_keeps_step_and_order(adaptimp: Command, tmp_path: Path) -> None:
    order = ["sensor", "trajectory", "controller", "actuator", "plant"]
    assert adaptimp("export", "fig2", "--step", "5e-5", "--order", ",".join(order), "-o", "x.ssp").code == 0
    system = System.read(tmp_path / "x.ssp")
    assert ([*system], system.step) == (order, 5e-5)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--as", "d", "-o", "x"), "--as d: there is no such form; "),
        (("-o", "x"), "x: the name does not say what to write; end it with one of .ssp, .fmu, .wasm, or give"),
        (("--as", "c", "--platform", "all", "-o", "x"), "--platform all: a folder of C has no binaries"),
        (
            ("--algorithm", "jacobi", "-o", "x.ssp"),
            "--algorithm jacobi: a package has no algorithm; leave the option out",
        ),
        (("--platform", "all", "-o", "x.ssp"), "--platform all: a package of this command has no binaries"),
        (
            ("--as", "ssp", "-o", "x.zip"),
            "x.zip: with --as ssp the name of the file ends in .ssp, not in .zip; write x.ssp.",
        ),
        (("--as", "fmu", "-o", "x"), "x: with --as fmu the name of the file ends in .fmu; write x.fmu."),
        (("--as", "c", "--algorithm", "newton", "-o", "x"), "System fig2: a program cannot step with newton; choose"),
        (("--as", "c", "--algorithm", "jacoby", "-o", "x"), "There is no algorithm 'jacoby'"),
        (("--as", "c", "--order", "plant", "-o", "x"), "The order plant must name each of"),
        (("--as", "c", "--step", "3e-4", "-o", "x"), "trajectory: sample time 0.0001 s is not a multiple of the step"),
    ],
)
def test_what_cannot_be_written_is_refused(
    adaptimp: Command, tmp_path: Path, arguments: tuple[str, ...], sentence: str
) -> None:
    outcome = adaptimp("export", "fig2", *arguments)
    assert outcome.sentence.startswith(sentence)
    assert outcome.code == 2
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_the_place_of_a_file_is_refused(adaptimp: Command, tmp_path: Path) -> None:
    (tmp_path / "x.ssp").mkdir()
    assert "is a folder; a file for the package is needed" in adaptimp("export", "fig2", "-o", "x.ssp").sentence
    (tmp_path / "letter.txt").write_text("mine", encoding="utf-8")
    refused = adaptimp("export", "fig2", "--as", "c", "-o", ".")
    assert "has files that are not of a C program" in refused.sentence
