"""Programs with FMUs of other tools, built by others: by a Makefile, and as a part of another program."""

import os
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu.toolchain import fmi_headers
from orchestration import System, scenario, simulate
from orchestration.check.static.elf import read
from tests.conformance.binary import FUNCTIONS
from tests.strangers.contained.program import QUICKEST
from tests.strangers.contained.test_runs import STEP, coupled
from tests.untested import needs

pytestmark = [
    pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning"),
    pytest.mark.filterwarnings("ignore::orchestration.FormalityWarning"),
]
posix = pytest.mark.skipif(sys.platform == "win32", reason="the Makefile is for POSIX systems")


def bits(values: np.ndarray) -> bytes:
    return np.asarray(values, np.float64).tobytes()


@pytest.mark.skipif(sys.platform != "linux", reason="reads the symbols of an ELF library")
def test_nothing_but_fmi_functions_is_exported(pair: tuple[Path, Path], tmp_path: Path) -> None:
    path = coupled(*pair).to_fmu(tmp_path / "three.fmu")
    with zipfile.ZipFile(path) as archive:
        name = next(name for name in archive.namelist() if name.startswith("binaries/"))
        assert read(archive.read(name)).exported == set(FUNCTIONS)


def test_a_program_around_an_fmu_that_holds_one_of_this_project(pair: tuple[Path, Path], tmp_path: Path) -> None:
    """The sources of the inner FMU honour the prefix as any tool's do, and its parts have names of their own."""
    arm = scenario("fig2")["plant"].path
    inner = replace(System.of({"arm": arm, "small": pair[1]}, "inner"), step=STEP).to_fmu(tmp_path / "inner.fmu")
    system = replace(System.of({"a": pair[0], "b": inner, "c": inner}), step=STEP).connect("a.y -> b.small.u")
    path = system.to_fmu(tmp_path / "outer.fmu")
    expected = simulate(system, stop_time=20 * STEP)
    found = simulate(replace(System.of({"all": path}), step=STEP), stop_time=20 * STEP)
    assert {name for name in expected.names if bits(found[f"all.{name}"]) != bits(expected[name])} == set()


@posix
@pytest.mark.skipif(shutil.which("make") is None, reason=needs("make is not installed", "make"))
def test_the_makefile_builds_sources_of_other_tools(pair: tuple[Path, Path], tmp_path: Path) -> None:
    system = coupled(*pair)
    system.to_c(tmp_path)
    command = ["make", "-e", f"FMI={fmi_headers()}", "STACK=", "CFLAGS=-O1 -Werror"]
    environment = {**os.environ, "CC": " ".join(QUICKEST)}
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    printed = subprocess.run(["./system", "--steps", "50"], cwd=tmp_path, check=True, capture_output=True, text=True)
    header, *lines = printed.stdout.replace('"', "").splitlines()
    rows = np.array([line.split(",") for line in lines], np.float64)
    result = simulate(system, stop_time=50 * STEP)
    columns = dict(zip(header.split(","), rows.T, strict=True))
    assert {name for name in result.names if bits(columns[name]) != bits(result[name])} == set()
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "`strcmp`, `strlen`, `strncpy`" in page
    assert "an array of 65536 bytes" in page
