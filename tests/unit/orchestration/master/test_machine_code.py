"""Machine code is kept between processes, and is never older than its source."""

import ast
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from numba import njit, types

import orchestration
from orchestration.fmi import kept_code, machine_code
from orchestration.fmi.kept_code import keep_machine_code
from orchestration.fmi.native_calls import SOURCES
from orchestration.master import kernel
from tests.unit.orchestration.small_models import mixed

PACKAGE = Path(orchestration.__file__).parent
CALLEE = "orchestration/master/kernel/flat_system.py"  # of the loop in fixed_step.py
RECORDED = "plan.discretes[index[j, 0]]"
RUN = """
import sys
import numpy as np
from orchestration import System, simulate
np.save(sys.argv[2], simulate(System.read(sys.argv[1])).rows)
"""


@pytest.fixture
def run(small: dict[str, Path], tmp_path: Path) -> Callable[..., subprocess.CompletedProcess]:
    """Runs a small system in a process of its own, from a copy of the package."""
    shutil.copytree(PACKAGE, tmp_path / "tree" / "orchestration", ignore=shutil.ignore_patterns("__pycache__"))
    system = mixed(small).write(tmp_path / "mixed.ssp")

    def start(**variables: str) -> subprocess.CompletedProcess:
        environment = {**os.environ, "PYTHONPATH": str(tmp_path / "tree"), "ADAPTIMP_CACHE": str(tmp_path / "cache")}
        command = [sys.executable, "-W", "ignore", "-c", RUN, str(system), str(tmp_path / "rows.npy")]
        return subprocess.run(
            command, cwd=tmp_path, env=environment | variables, capture_output=True, text=True, check=False
        )

    return start


def test_a_changed_callee_acts(run: Callable[..., subprocess.CompletedProcess], tmp_path: Path) -> None:
    """What the loop calls from another file changes: the next process records what that file says now."""
    first = run()
    assert first.returncode == 0, first.stderr
    before = np.load(tmp_path / "rows.npy")
    callee = tmp_path / "tree" / CALLEE
    text = callee.read_text(encoding="utf-8")
    assert text.count(RECORDED) == 1
    callee.write_text(text.replace(RECORDED, f"{RECORDED} + 1000"), encoding="utf-8")
    second = run()
    assert second.returncode == 0, second.stderr
    change = np.load(tmp_path / "rows.npy") - before
    assert len(change) > 2
    assert set(np.unique(change[1:])) == {0.0, 1000.0}  # Real columns, and discrete ones
    assert (change == change[0]).all()


def test_a_second_process_compiles_nothing(run: Callable[..., subprocess.CompletedProcess], tmp_path: Path) -> None:
    assert run().returncode == 0
    kept = {path: path.stat().st_mtime_ns for path in (tmp_path / "cache" / "kernel").rglob("*.nb?")}
    assert kept
    second = run(NUMBA_DEBUG_CACHE="1")
    assert second.returncode == 0, second.stderr
    assert "data loaded" in second.stdout
    assert "data saved" not in second.stdout
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "cache" / "kernel").rglob("*.nb?")} == kept


def test_a_cache_that_cannot_be_written_does_not_break_a_run(
    run: Callable[..., subprocess.CompletedProcess], tmp_path: Path
) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "kernel").write_text("not a folder", encoding="utf-8")
    (tmp_path / "temporary").mkdir()
    done = run(ADAPTIMP_CACHE=str(tmp_path / "other"), TMPDIR=str(tmp_path / "temporary"))
    assert done.returncode == 0, done.stderr
    assert not list((tmp_path / "tree").rglob("*.nb?"))
    assert list((tmp_path / "temporary").rglob("*.nbc"))


def test_a_damaged_cache_is_compiled_again(run: Callable[..., subprocess.CompletedProcess], tmp_path: Path) -> None:
    assert run().returncode == 0
    damaged = list((tmp_path / "cache" / "kernel").rglob("*.nb?"))
    for path in damaged:
        path.write_bytes(path.read_bytes()[:40])
    second = run()
    assert second.returncode == 0, second.stderr


def test_a_changed_byte_in_machine_code_is_noticed(tmp_path: Path) -> None:
    """Machine code that is not as it was written would end the process, or compute something else."""

    def made() -> Any:
        def tripled(x: float) -> float:
            return 3.0 * x

        return keep_machine_code(cast("Any", njit)(tripled), tripled, tmp_path)

    assert made()(2.0) == 6.0
    files = {path: path.read_bytes() for path in tmp_path.iterdir()}
    assert {path.suffix for path in files} == {".nbi", ".nbc"}
    for path, whole in files.items():
        for place in range(0, len(whole), max(1, len(whole) // 50)):
            path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x15]) + whole[place + 1 :])
            assert loaded(made()) is None, (path.suffix, place)
        assert made()(2.0) == 6.0  # it is compiled and kept anew
        assert loaded(made()) is not None


def loaded(function: Any) -> Any:
    """The machine code that is kept of a function of a float64."""
    return function._cache.load_overload((types.float64,), function.targetctx)


def test_every_imported_module_of_the_kernel_is_hashed() -> None:
    """What the kernel imports from the project, directly or not, is among the sources of its folder's name."""
    folder = Path(kernel.__path__[0])
    hashed = {*folder.glob("*.py"), *SOURCES}
    not_compiled = {Path(machine_code.__file__), Path(kept_code.__file__)}
    for file in hashed:
        for name in _imports(file):
            imported = Path(str(import_module(name).__file__))
            assert imported in hashed | not_compiled, f"{file.name} imports {name}, which is not hashed"


def _imports(file: Path) -> set[str]:
    """Modules of the project that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("orchestration"):
            found.add(str(node.module))
    return found


def test_folder_is_named_by_sources_and_versions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    source = tmp_path / "a.py"
    source.write_text("x = 1", encoding="utf-8")
    first = machine_code.code_folder([source])
    assert first is not None
    assert first.is_dir()
    assert machine_code.code_folder([source]) == first
    source.write_text("x = 2", encoding="utf-8")
    assert machine_code.code_folder([source]) != first
    source.write_text("x = 1", encoding="utf-8")
    monkeypatch.setattr(machine_code.importlib.metadata, "version", lambda _: "another")
    assert machine_code.code_folder([source]) != first


def test_folders_that_are_not_used_go(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    source, folders = tmp_path / "a.py", []
    for k in range(3):
        source.write_text(f"x = {k}", encoding="utf-8")
        folders.append(machine_code.code_folder([source]))
        assert folders[-1] is not None
        if k == 0:
            old = time.time() - (machine_code.UNUSED_DAYS + 1) * 86400
            os.utime(folders[0], (old, old))
    assert [folder.exists() for folder in folders] == [False, True, True]


def test_no_source_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    assert machine_code.code_folder([tmp_path / "missing.py"]) is None
