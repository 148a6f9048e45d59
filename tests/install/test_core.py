"""With the core alone: systems run from the FMUs of the wheel, and what needs another part says which."""

import hashlib
import json
import re
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.install.conftest import Adaptimp, program

RUN = ("run", "fig2", "--stop", "0.02", "--record", "plant.x,controller.e", "-o")


@pytest.fixture(scope="module")
def carried(core: Path) -> Path:
    """Folder of the carried files in the environment."""
    (folder,) = core.rglob("fmus/carried")
    return folder


@contextmanager
def changed(file: Path, content: bytes) -> Iterator[None]:
    """Give a file another content for a while; the file may be a link to one in the cache of uv."""
    kept = file.with_suffix(".kept")
    file.rename(kept)
    file.write_bytes(content)
    try:
        yield
    finally:
        kept.replace(file)


def test_the_toolchain_is_not_there(core: Path) -> None:
    code = "from importlib.util import find_spec; print(*map(find_spec, ('casadi', 'ziglang', 'fmpy', 'pyarrow')))"
    said = subprocess.run([program(core, "python"), "-I", "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["None"] * 4


def test_a_run_gives_the_bytes_that_a_checkout_gives(adaptimp: Adaptimp, tmp_path: Path) -> None:
    adaptimp(*RUN, "core.csv", "--plot", "core.png")
    here = [Path(sys.executable).with_name("adaptimp"), *RUN, tmp_path / "checkout.csv"]
    subprocess.run(here, capture_output=True, check=True)
    assert (tmp_path / "core.csv").read_bytes() == (tmp_path / "checkout.csv").read_bytes()
    assert (tmp_path / "core.png").read_bytes().startswith(b"\x89PNG")
    compared = adaptimp("compare", "core.csv", "checkout.csv", "--json").stdout  # reads both without Arrow
    assert json.loads(compared)["exit_code"] == 0


def test_an_export_is_the_package_that_the_wheel_carries(adaptimp: Adaptimp, carried: Path, tmp_path: Path) -> None:
    adaptimp("export", "fig5", "--as", "ssp", "-o", "fig5.ssp")
    with tarfile.open(carried / "scenarios.tar.xz") as archive:
        member = archive.extractfile("fig5.ssp")
        assert member is not None
        assert member.read() == (tmp_path / "fig5.ssp").read_bytes()


def test_what_is_there_is_listed_and_examined(adaptimp: Adaptimp, carried: Path) -> None:
    listed = json.loads(adaptimp("list", "--json").stdout)
    assert listed["fmus"]["Plant"].startswith("Planar arm")
    assert "FailingForceSensor" in listed["variants"]
    lines = adaptimp("list").stdout.splitlines()
    lacking = [line.split()[0] for line in lines if line.endswith('; needs the part "build"')]
    assert "HoganImpedanceFull" in lacking
    assert not {"Plant3R", "FailingForceSensor"} & {*lacking}
    assert json.loads(adaptimp("info", "HoganImpedance", "--json").stdout)["runs_here"] is True
    assert "no findings" in adaptimp("check", carried / "Actuator.fmu").stdout


def test_the_shell_completes_variables(core: Path) -> None:
    code = "from orchestration.cli.completion import _paths; print(_paths(C(), 'plant.K', ('parameter',)))"
    context = "class C:\n    params, args = {'system': 'fig5'}, []\n"
    command = [program(core, "python"), "-I", "-c", context + code]  # -I: not the packages of this folder
    said = subprocess.run(command, capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "['plant.K_f']"


def test_a_sweep_runs(adaptimp: Adaptimp) -> None:
    study = ("--vary", "plant.K_f=1e4:1e6:2log", "--measure", "peak_force", "--stop", "0.01")
    assert "wrote table.csv: 2 rows" in adaptimp("sweep", "fig2", *study, "-o", "table.csv").stdout


@pytest.mark.parametrize(
    ("command", "package", "part"),
    [
        (("build",), "casadi", "build"),
        (("export", "fig2", "--as", "fmu", "-o", "fig2.fmu"), "casadi", "build"),
        (("export", "fig2", "--as", "wasm", "-o", "fig2.wasm"), "ziglang", "build"),
        (("paper",), "bokeh", "paper"),
        (("report", "fig2"), "bokeh", "report"),
        ((*RUN, "rows.parquet"), "pyarrow", "files"),
        (("sweep", "fig2", "--seeds", "1-2", "--measure", "peak_force", "--store", "runs"), "pyarrow", "files"),
    ],
)
def test_a_missing_part_is_named(adaptimp: Adaptimp, command: tuple[str, ...], package: str, part: str) -> None:
    adaptimp(*command, fails=[f"This needs {package}", f'pip install "adaptimp[{part}]"'])


@pytest.mark.parametrize(
    ("command", "why"),
    [
        (("info", "HoganImpedanceFull"), "The wheel does not carry HoganImpedanceFull.fmu."),
        (("run", "fig2", "--controller", "HoganImpedanceMobility"), "does not carry HoganImpedanceMobility.fmu."),
        (("export", "fig2", "--reals", "-o", "fig2.ssp"), "The wheel does not carry VirtualTrajectory.fmu with Reals"),
    ],
)
def test_what_is_not_carried_needs_the_part_that_builds(adaptimp: Adaptimp, command: tuple[str, ...], why: str) -> None:
    adaptimp(*command, fails=[why, "Building it needs casadi", 'pip install "adaptimp[build]"'])


def test_every_scenario_is_ready_to_run(core: Path) -> None:
    code = (
        "from orchestration import scenario\n"
        "from orchestration.paper.scenarios import ALL_SCENARIOS\n"
        "print(all(scenario(name).stop_time for name in ALL_SCENARIOS))"
    )
    said = subprocess.run([program(core, "python"), "-I", "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout == "True\n"


def test_a_changed_file_is_refused(adaptimp: Adaptimp, carried: Path) -> None:
    file = carried / "Plant.fmu"
    content = bytearray(file.read_bytes())
    stated = hashlib.sha256(content).hexdigest()
    content[1000] ^= 1
    with changed(file, bytes(content)):
        adaptimp("run", "fig2", fails=["Plant.fmu", stated, hashlib.sha256(content).hexdigest(), "install adaptimp"])


def test_other_definitions_are_built(adaptimp: Adaptimp, carried: Path) -> None:
    file = carried.parent / "plant.py"
    with changed(file, file.read_bytes() + b"# changed\n"):
        adaptimp("run", "fig2", fails=["are not those of the wheel's", "Building it needs casadi"])


def test_the_version_is_that_of_the_project(adaptimp: Adaptimp, wheel: Path) -> None:
    said = adaptimp("--version").stdout
    stated = re.search(r"adaptimp-([^-]+)-", wheel.name)
    assert stated is not None
    assert stated[1] in said
