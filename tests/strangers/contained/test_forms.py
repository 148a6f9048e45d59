"""FMUs of other tools in the other forms of a program: an FMU, C for the user's own compiler, WebAssembly."""

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
from orchestration import Result, System, prepare, scenario, simulate
from orchestration.check import check
from orchestration.check.static.elf import read
from orchestration.fmi.description import read_description
from tests.conformance.binary import FUNCTIONS
from tests.interop.foreign.builders import MAPPING, without_compiler
from tests.strangers.contained.fmus import controller, small, small_sources
from tests.strangers.contained.program import QUICKEST
from tests.strangers.contained.test_runs import STEP, coupled
from tests.untested import needs

pytestmark = [
    pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning"),
    pytest.mark.filterwarnings("ignore::orchestration.FormalityWarning"),
]
posix = pytest.mark.skipif(sys.platform == "win32", reason="the Makefile is for POSIX systems")


@pytest.fixture(scope="module")
def container(pair: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The FMU of three components of other tools."""
    return coupled(*pair).to_fmu(tmp_path_factory.mktemp("container") / "coupled.fmu")


def alone(path: Path, step: float) -> System:
    return replace(System.of({"all": path}), step=step)


def assert_same(found: Result, expected: Result) -> None:
    """Every column of a system is that of its FMU, bit by bit."""
    differ = {n for n in expected.names if _bytes(found[f"all.{n}"]) != _bytes(expected[n])}
    assert differ == set()


def _bytes(values: np.ndarray) -> bytes:
    return np.asarray(values, np.float64).tobytes()


def test_an_fmu_of_fmus_of_other_tools(pair: tuple[Path, Path], container: Path) -> None:
    expected = simulate(coupled(*pair), stop_time=100 * STEP)
    for _ in range(2):
        assert_same(simulate(alone(container, STEP), stop_time=100 * STEP), expected)


def test_a_checked_fmu_has_no_findings(container: Path) -> None:
    report = check(container)
    assert report.findings == ()
    description = read_description(container)
    assert description.can("canGetAndSetFMUstate")
    assert not description.can("canSerializeFMUstate")


def test_states_of_an_fmu_go_back(container: Path) -> None:
    with prepare(alone(container, STEP), stop_time=100 * STEP) as run:
        run.run(until=30 * STEP)
        middle = run.save()
        run.run(until=60 * STEP)
        first = run.result()
        run.restore(middle)
        run.run(until=60 * STEP)
        assert run.result() == first


def test_an_fmu_saves_only_if_all_parts_do(pair: tuple[Path, Path], tmp_path: Path) -> None:
    system = coupled(pair[0], small(tmp_path, "Forgetful", flags=""))
    path = system.to_fmu(tmp_path / "coupled.fmu")
    assert not read_description(path).can("canGetAndSetFMUstate")
    assert check(path).findings == ()
    assert_same(simulate(alone(path, STEP), stop_time=20 * STEP), simulate(system, stop_time=20 * STEP))


def test_messages_of_parts_reach_the_host(pair: tuple[Path, Path], tmp_path: Path) -> None:
    system = replace(System.of({"tank": pair[0]}).set({"tank.fault": 3}), step=STEP)
    path = system.to_fmu(tmp_path / "tank.fmu")
    with pytest.raises(Exception, match=r"tank: fmi2DoStep returned fmi2Error; its last message: .*the tank is 3 % full"):
        simulate(alone(path, STEP), stop_time=100 * STEP)


@pytest.mark.skipif(sys.platform != "linux", reason="reads the symbols of an ELF library")
def test_nothing_but_fmi_functions_is_exported(container: Path) -> None:
    with zipfile.ZipFile(container) as archive:
        name = next(name for name in archive.namelist() if name.startswith("binaries/"))
        assert read(archive.read(name)).exported == set(FUNCTIONS)


def test_an_fmu_of_a_system_is_a_part_of_a_system(container: Path, pair: tuple[Path, Path], tmp_path: Path) -> None:
    """Its sources are those of any FMU that honours the prefix: an FMU of this project lies within, too."""
    arm = scenario("fig2")["plant"].path
    inner = replace(System.of({"arm": arm, "small": pair[1]}), step=STEP).to_fmu(tmp_path / "inner.fmu")
    system = replace(System.of({"a": container, "b": inner}).connect("a.b.y -> b.small.u"), step=STEP)
    path = system.to_fmu(tmp_path / "outer.fmu")
    assert_same(simulate(alone(path, STEP), stop_time=20 * STEP), simulate(system, stop_time=20 * STEP))


@pytest.mark.skipif(without_compiler() is not None, reason=str(without_compiler()))
def test_the_hand_written_controller_in_the_fmu_of_fig5(tmp_path: Path) -> None:
    fig5 = scenario("fig5").replace("controller", controller(tmp_path), MAPPING)
    path = fig5.to_fmu(tmp_path / "fig5.fmu")
    expected = simulate(fig5, stop_time=0.1)
    assert_same(simulate(alone(path, fig5.run_step()), stop_time=0.1), expected)
    rows = simulate(alone(path, 7 * fig5.run_step()), stop_time=700 * 7 * fig5.run_step())
    for name in expected.names:
        assert _bytes(rows[f"all.{name}"]) == _bytes(expected[name][: 700 * 7 + 1 : 7]), name


@posix
@pytest.mark.skipif(shutil.which("make") is None, reason=needs("make is not installed", "make"))
def test_the_makefile_builds_sources_of_other_tools(pair: tuple[Path, Path], tmp_path: Path) -> None:
    system = coupled(*pair)
    system.to_c(tmp_path)
    environment = {**os.environ, "CC": " ".join(QUICKEST)}
    command = ["make", "-e", f"FMI={fmi_headers()}", "STACK=", "CFLAGS=-O1 -Werror"]
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    printed = subprocess.run(["./system", "--steps", "50"], cwd=tmp_path, check=True, capture_output=True, text=True)
    header, *rows = printed.stdout.splitlines()
    columns = dict(zip(header.replace('"', "").split(","), np.array([r.split(",") for r in rows], float).T, strict=True))
    result = simulate(system, stop_time=50 * STEP)
    assert {name for name in result.names if _bytes(columns[name]) != _bytes(result[name])} == set()
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "`strcmp`, `strlen`, `strncpy`" in page
    assert "an array of 65536 bytes" in page


def free_of_library() -> dict[str, str]:
    """Sources of the small FMU without the functions of the C library that they call."""
    text = small_sources()["small.c"].replace("0.125 * (double)strlen(m->text)", "0.25")
    text = text.replace('strcmp(guid, "small") != 0', "guid[0] != 's'").replace('strcpy(m->text, "ab");', "")
    text = text.replace("strncpy(((Model *)c)->text, v[i], sizeof ((Model *)c)->text - 1);", "UNUSED(v), UNUSED(c);")
    return {"small.c": text}


@pytest.mark.skipif(shutil.which("node") is None, reason=needs("node is not installed", "nodejs"))
def test_a_module_of_an_fmu_that_needs_no_library(tmp_path: Path) -> None:
    system = replace(System.of({"a": small(tmp_path, edit=free_of_library())}).set({"a.k": 1.5}), step=STEP)
    module = system.to_wasm(tmp_path / "free.wasm")
    script = (
        "import {readFileSync} from 'node:fs'; import {load} from './free.mjs';"
        "const system = await load(readFileSync('free.wasm'), JSON.parse(readFileSync('free.json')));"
        "for (let i = 0; i < 40; ++i) { const run = system.create(); run.initialize();"
        "const rows = run.run(50, {columns: ['a.y', 'a.count', 'a.odd']});"
        "if (i == 39) console.log(JSON.stringify(['a.y', 'a.count', 'a.odd'].map(n => [...rows[n]]))); run.free(); }"
    )
    command = ["node", "--input-type=module", "-e", script]
    run = subprocess.run(command, cwd=module.parent, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    import json

    found = np.array(json.loads(run.stdout))
    result = simulate(system, stop_time=50 * STEP)
    rows = [_bytes(result[name])[8 * (len(result.time) - found.shape[1]) :] for name in ("a.y", "a.count", "a.odd")]
    assert [_bytes(row) for row in found] == rows
