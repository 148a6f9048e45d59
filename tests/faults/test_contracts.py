"""Tests of the import contracts: a forbidden import in a copy of the project breaks the right contract."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("orchestration", "fmus", "adaptimp_fmu")
KERNEL = "orchestration/master/kernel/coupling.py"
LATER = "def later() -> None:\n    import orchestration.fmi.units"
# What is planted where, the contract that breaks, and what its report names.
PLANTED = {
    "an upward import": (
        "orchestration/system/system.py",
        "import orchestration.master.simulate",
        "rooms",
        ".simulate",
    ),
    "an import sideways": ("orchestration/results/result.py", "import orchestration.ssp.read", "rooms", ".ssp.read"),
    "an import in a function": ("orchestration/sandbox/archive.py", LATER, "rooms", ".fmi.units"),
    "a folder without a place": ("orchestration/attic/__init__.py", '"""No place."""', "rooms", "orchestration.attic"),
    "a circle": ("orchestration/fmi/units.py", "import orchestration.fmi.instance", "circles", "orchestration.fmi"),
    "the system in the kernel": (KERNEL, "import orchestration.system.system", "kernel", ".kernel.coupling"),
    "fmpy in the kernel": (KERNEL, "import fmpy", "kernel", ".kernel.coupling"),
    "numba in the results": ("orchestration/results/result.py", "import numba", "compiler", ".results.result"),
    "the robot in the master": ("orchestration/master/options.py", "import fmus.plant", "robot", ".master.options"),
    "the toolchain in a check": (
        "orchestration/check/findings.py",
        "import adaptimp_fmu.package",
        "toolchain",
        ".findings",
    ),
    "a toolchain in the files": (
        "adaptimp_fmu/files/locks.py",
        "import adaptimp_fmu.names",
        "files",
        "adaptimp_fmu.files",
    ),
    "a master in the equations": ("fmus/plant.py", "import orchestration.master.options", "packages", "fmus.plant"),
}


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project's packages and contracts in a folder of their own."""
    folder = tmp_path_factory.mktemp("project")
    for package in PACKAGES:
        shutil.copytree(ROOT / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)
    return folder


def lint(folder: Path, *contracts: str) -> subprocess.CompletedProcess[str]:
    """Run import-linter on a folder, with all contracts or with the named ones."""
    chosen = [word for contract in contracts for word in ("--contract", contract)]
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as main; main()"]
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONIOENCODING": "utf-8"}
    return subprocess.run(
        [*command, "--no-cache", "pyproject.toml", *chosen],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


def test_the_walls_stand(copy: Path) -> None:
    done = lint(copy)
    assert done.returncode == 0, done.stdout
    assert "0 broken" in done.stdout


@pytest.mark.parametrize("fault", PLANTED)
def test_a_hole_is_noticed(copy: Path, fault: str) -> None:
    place, line, contract, named = PLANTED[fault]
    path = copy / place
    before = path.read_text(encoding="utf-8") if path.exists() else None
    try:
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"{before or ''}\n{line}\n", encoding="utf-8")
        done = lint(copy, contract)
    finally:
        if before is None:
            shutil.rmtree(path.parent)
        else:
            path.write_text(before, encoding="utf-8")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "1 broken" in done.stdout
    assert named in done.stdout.partition("Broken contracts")[2]
