"""A system as a folder of C: compilers find nothing, Make builds it, and it prints the rows of the master."""

import hashlib
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result, System, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import ALL_SCENARIOS, SCENARIOS
from tests.untested import needs

ZIG = (sys.executable, "-m", "ziglang", "cc")
COMPILERS = {"gcc": ("gcc",), "clang": ("clang",), "zig cc": ZIG}
# What the rules of MISRA C ask for and compilers can see: conversions, hidden names, missing prototypes, fall-throughs.
STRICT = (
    *("-std=c11", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wconversion", "-Wshadow", "-Wundef", "-Wvla"),
    *("-Wstrict-prototypes", "-Wmissing-prototypes", "-Wmissing-declarations", "-Wold-style-definition"),
    *("-Wcast-qual", "-Wcast-align", "-Wwrite-strings", "-Wredundant-decls", "-Wnested-externs"),
    *("-Wswitch-default", "-Wswitch-enum", "-Wnull-dereference", "-Wdouble-promotion", "-Wformat=2"),
)
LIBRARY = re.compile(r"\b(malloc|calloc|realloc|free|printf|fprintf|fopen|exit|abort|longjmp)\s*\(")
needs_make = pytest.mark.skipif(
    any(shutil.which(tool) is None for tool in ("make", "cc", "awk")), reason=needs("no make or cc", "make")
)


@cache
def fig5() -> System:
    scenario = SCENARIOS["fig5"]
    return scenario.system(fmus(scenario.models.values()))


@cache
def run() -> Result:
    return simulate(fig5(), stop_time=0.02)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fig5().to_c(tmp_path_factory.mktemp("c") / "fig5")


def sources(folder: Path) -> list[str]:
    return ["main.c", "step.c", *(str(file.relative_to(folder)) for file in sorted((folder / "fmus").glob("*.c")))]


@pytest.mark.parametrize("compiler", COMPILERS)
def test_no_compiler_finds_anything(compiler: str, folder: Path, tmp_path: Path) -> None:
    if shutil.which(COMPILERS[compiler][0]) is None:
        pytest.skip(f"{compiler} is not installed")
    for source in sources(folder):
        command = [*COMPILERS[compiler], *STRICT, "-c", source, "-o", str(tmp_path / "x.o")]
        outcome = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert (outcome.returncode, outcome.stderr) == (0, ""), source


@pytest.mark.parametrize(("target", "cpu"), [("thumb-freestanding-eabihf", "cortex_m4"), ("wasm32-freestanding", "")])
def test_it_compiles_without_a_library(target: str, cpu: str, folder: Path, tmp_path: Path) -> None:
    for source in sources(folder)[1:]:
        command = [*ZIG, "-target", target, *([f"-mcpu={cpu}"] if cpu else ()), "-std=c11", "-O2", "-ffp-contract=off"]
        outcome = subprocess.run(
            [*command, "-c", source, "-o", str(tmp_path / "x.o")],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        assert (outcome.returncode, outcome.stderr) == (0, ""), source


def test_nothing_allocates_or_writes_but_the_example(folder: Path) -> None:
    included = set()
    for source in sources(folder)[1:]:
        listing = subprocess.run([*ZIG, "-MM", source], cwd=folder, capture_output=True, text=True, check=True).stdout
        included |= {folder / name for name in listing.replace("\\\n", " ").partition(":")[2].split()}
    texts = {path.relative_to(folder): path.read_text(encoding="utf-8") for path in included}
    assert {Path("step.c"), Path("fmus/Plant/contained.c"), Path("fmus/Plant/equations.h")} <= set(texts)
    assert [str(path) for path, text in texts.items() if LIBRARY.search(text)] == []


@needs_make
def test_make_builds_the_example_and_says_its_sizes(folder: Path) -> None:
    outcome = subprocess.run(["make"], cwd=folder, capture_output=True, text=True, check=False)
    assert (outcome.returncode, outcome.stderr) == (0, "")
    stack, size = re.findall(r"^(\d+) bytes", outcome.stdout, re.MULTILINE)
    assert f"{stack} bytes of stack at the most" in outcome.stdout
    assert f"{size} bytes in fig5_System" in outcome.stdout
    assert 1000 < int(size) < 10_000
    assert 500 < int(stack) < 10_000

    def said(*arguments: str, code: int = 0) -> str:
        ended = subprocess.run([folder / "fig5", *arguments], capture_output=True, text=True, check=False)
        assert ended.returncode == code
        return ended.stdout + ended.stderr

    hash_ = hashlib.sha256(np.ascontiguousarray(run().rows).tobytes()).hexdigest()
    assert said("--stop", "0.02", "--hash") == f"{hash_}\n"
    header, *rows = said("--steps", "2000", "--every", "500").splitlines()
    assert header == ",".join(f'"{name}"' for name in ("time", *run().names))
    numbers = np.array([[float(text) for text in row.split(",")] for row in rows])
    assert numbers[:, 0].tobytes() == run().time[::500].tobytes()
    assert numbers[:, 1:].tobytes() == np.ascontiguousarray(run().rows[::500]).tobytes()

    changed = simulate(fig5().set({"controller.K[1]": 3000.0}), stop_time=0.02)
    hash_ = hashlib.sha256(np.ascontiguousarray(changed.rows).tobytes()).hexdigest()
    assert said("controller.K[1]=3000", "--stop", "0.02", "--hash") == f"{hash_}\n"
    assert said("plant.K_f=-1", code=1) == "plant: K_f = -1 must be at least 0 N/m.\n"
    assert said("plant.K_f=nan", code=1) == "plant: K_f = nan is not finite.\n"
    assert said("plant.K=1", code=1) == "plant.K: there is no variable of this name; step.c lists all names.\n"
    assert "write NAME=VALUE" in said("plant.K_f", code=1)
    assert "--help: there is no such option; there are --stop T" in said("--help", code=1)
    assert said("--every", "0", code=1) == "--every: a number of at least 1 is needed.\n"
    assert said("--steps", "2.5", code=1) == "--steps: 2.5 is not a whole number.\n"
    assert "a number of at least 0 is needed" in said("--stop", "soon", code=1)
    assert said("plant.wall_normal[1]=3", code=1).startswith("plant: wall_normal must have length 1 (value -")


@needs_make
def test_an_arm_in_space_gives_the_rows_of_the_master(tmp_path: Path) -> None:
    """Two thirds of the run of the PUMA 560, so that its tool has met the table."""
    scenario = ALL_SCENARIOS["puma"]
    system, stop = scenario.system(fmus(scenario.models.values())), "1.3"
    folder = system.to_c(tmp_path / "puma")
    subprocess.run(["make"], cwd=folder, capture_output=True, check=True)
    result = simulate(system, stop_time=float(stop))
    assert (result["plant.gap"] > 0).any()
    command = [folder / "puma", "--stop", stop, "--hash"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert said == f"{hashlib.sha256(np.ascontiguousarray(result.rows).tobytes()).hexdigest()}\n"


@needs_make
def test_the_example_stops_at_the_time_that_was_asked_for(tmp_path: Path) -> None:
    folder = replace(fig5(), start_time=1.0).to_c(tmp_path / "later")
    subprocess.run(["make", "CFLAGS=-O0"], cwd=folder, capture_output=True, check=True)
    command = [folder / "fig5", "--stop", "1.0002", "--every", "5"]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    times = [float(row.split(",")[0]) for row in ended.stdout.splitlines()[1:]]
    assert times == [1.0 + k * 1e-5 for k in (0, 5, 10, 15, 20)]


@needs_make
def test_make_says_if_the_compiler_does_not_tell_the_stack(folder: Path) -> None:
    command = ["make", "-B", "objects", "STACK=", "WARNINGS=-Wall -Wextra -Werror", "CFLAGS=-O1"]
    for file in folder.rglob("*.su"):
        file.unlink()
    outcome = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (outcome.returncode, outcome.stderr) == (0, "")
    assert "The compiler does not tell how much stack a step needs." in outcome.stdout


def test_the_page_says_what_the_program_is_made_of(folder: Path) -> None:
    page = (folder / "README.md").read_text(encoding="utf-8")
    for component in fig5().components:
        assert f"| {component.name} | {component.description.model_name} | {component.path.name} |" in page
        assert hashlib.sha256(component.path.read_bytes()).hexdigest() in page
    assert "gauss-seidel" in page


def test_the_same_system_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    again = fig5().to_c(tmp_path / "again")
    written = {str(p.relative_to(again)): p.read_bytes() for p in again.rglob("*") if p.is_file()}
    assert written == {name: (folder / name).read_bytes() for name in written}
