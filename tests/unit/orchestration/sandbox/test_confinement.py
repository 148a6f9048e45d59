"""A confined process keeps its folder, its threads and its files, and reaches nothing else."""

import ctypes
import json
import os
import re
import select
import signal
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from orchestration.sandbox import landlock, system_calls
from orchestration.sandbox.confinement import end, environment, seal, starting
from tests.unit.orchestration.sandbox import confined

PATIENT = 600.0  # s
pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="Landlock and seccomp are Linux's")

ALLOWED = (*("write below its folder", "rename below its folder", "read elsewhere", "a thread", "to signal itself"),)
NEEDS = {
    **dict.fromkeys(("write elsewhere", "overwrite elsewhere", "truncate elsewhere", "remove elsewhere"), "folders"),
    "link elsewhere": "folders",
    **dict.fromkeys(("change a mode elsewhere", "change a time elsewhere", "a socket", "a local socket"), "calls"),
    **dict.fromkeys(("another process", "another process by clone", "a program", "to own a signal"), "calls"),
    **dict.fromkeys(("to ask whether the parent is there", "to signal its group", "a session of its own"), "calls"),
    "a file too large": "file size",
    "too many files": "files",
    **dict.fromkeys(("too much memory", "too many threads"), "memory"),
}


def command(folder: Path, parent: int, *more: str) -> list[str]:
    """The command line of the child."""
    for name in ("inside", "outside"):
        (folder / name).mkdir(exist_ok=True)
    (folder / "outside" / "there").write_text("as it was")
    return [sys.executable, "-m", confined.__name__, str(folder), str(parent), *more]


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """What became of each attempt of a confined child."""
    folder = tmp_path_factory.mktemp("confined")
    given = command(folder, os.getpid())
    path = os.pathsep.join(filter(None, (str(Path(__file__).parents[4]), os.environ.get("PYTHONPATH"))))
    variables = environment(folder / "inside", {"PYTHONPATH": path})
    ended = subprocess.run(
        given, capture_output=True, text=True, check=True, timeout=PATIENT, env=variables, **starting()
    )
    found = json.loads(ended.stdout)
    assert (folder / "outside" / "there").read_text() == "as it was" or "folders" not in found["measures"]
    return found


@pytest.mark.parametrize("name", list(confined.attempts(Path(), Path())))
def test_an_attempt(tried: dict, name: str) -> None:
    needed = NEEDS.get(name)
    if needed is None:
        assert name in ALLOWED
        assert tried["attempts"][name] == ""
    elif needed not in tried["measures"]:
        pytest.skip(f"this system does not offer the measure {needed}")
    else:
        assert tried["attempts"][name] in ("PermissionError", "OSError", "MemoryError", "RuntimeError")


def test_all_measures_that_need_no_kernel_of_today(tried: dict) -> None:
    assert {"session", "parent", "memory", "file size", "files", "time"} <= set(tried["measures"])


def test_a_child_ends_with_its_parent(tmp_path: Path) -> None:
    """The parent is killed and has no chance to clean up."""
    program = (
        "import os, subprocess, sys\n"
        "child = subprocess.Popen([*sys.argv[1:3], sys.argv[3], sys.argv[4], str(os.getpid()), 'wait'],"
        " stdout=subprocess.PIPE, start_new_session=True)\n"
        "print(child.stdout.readline().decode().strip(), flush=True)\n"
        "child.wait()\n"
    )
    given = command(tmp_path, 0)[:4]
    parent = subprocess.Popen([sys.executable, "-c", program, *given], stdout=subprocess.PIPE)
    assert parent.stdout is not None
    with parent:
        child = int(parent.stdout.readline())
        watch = os.pidfd_open(child)
        parent.kill()
    try:
        ended, _, _ = select.select([watch], [], [], PATIENT)
        assert ended, "the child lives on"
    finally:
        os.close(watch)


def test_the_session_is_ended_as_a_whole(tmp_path: Path) -> None:
    """A process that the child started, and that waits for nobody, ends too."""
    program = (
        "import subprocess, time; p = subprocess.Popen(['sleep', '3600']); print(p.pid, flush=True); time.sleep(3600)"
    )
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, cwd=tmp_path, **starting())
    assert child.stdout is not None
    with child:
        watch = os.pidfd_open(int(child.stdout.readline()))
        end(child.pid)
        assert child.wait(PATIENT) == -signal.SIGKILL
    try:
        assert select.select([watch], [], [], PATIENT)[0], "the grandchild lives on"
    finally:
        os.close(watch)


def test_what_the_system_lacks_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a processor whose calls have no numbers here, and on another system, nothing is done and nothing is said."""
    monkeypatch.setattr(system_calls.platform, "machine", lambda: "riscv64")
    assert not system_calls.deny_reaching_out(ctypes.CDLL(None))
    monkeypatch.setattr(sys, "platform", "darwin")
    assert seal([]) == []


def test_an_old_kernel_has_no_landlock() -> None:
    class Old(ctypes.CDLL):
        def __init__(self) -> None:
            super().__init__(None)
            self.syscall = lambda *_: -1

    assert not landlock.write_only_below([], Old())


def test_environment_has_no_secrets(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("API_TOKEN", "secret")
    monkeypatch.setenv("LC_TIME", "C")
    found = environment(tmp_path, {"ALSO": "this"})
    assert "API_TOKEN" not in found
    assert (found["HOME"], found["TMPDIR"], found["LC_TIME"], found["ALSO"]) == (str(tmp_path),) * 2 + ("C", "this")


@pytest.mark.parametrize(("column", "header"), [(0, "x86-linux-any"), (1, "aarch64-linux-any")])
def test_numbers_of_calls_are_those_of_the_kernels_headers(column: int, header: str) -> None:
    spec = find_spec("ziglang")
    assert spec is not None
    assert spec.origin is not None
    text = (Path(spec.origin).parent / "lib/libc/include" / header / "asm/unistd_64.h").read_text()
    known = {m[1]: int(m[2]) for m in re.finditer(r"#define __NR(?:3264)?_(\w+)\s+(\d+)", text)}
    ours = {**system_calls.DENIED, **system_calls.JUDGED}
    assert {name: numbers[column] for name, numbers in ours.items()} == {name: known.get(name) for name in ours}
