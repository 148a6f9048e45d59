"""The compiler that reads a stranger's sources is bounded, and what it wrote is read with care."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import ContainerError, System
from orchestration.containers.plan import plan_of
from orchestration.sandbox import limited
from orchestration.sandbox.elf import ElfError
from orchestration.sandbox.landlock import write_only_below
from orchestration.sandbox.limited import Outcome, run_limited
from orchestration.sandbox.object_file import Names, read_names
from tests.strangers.contained.fmus import small
from tests.strangers.contained.program import ZIG
from tests.untested import needs

posix = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limits of this kind")
TEXT = "int counted, *shared; static int own; int other(void); int more(void) { return other() + counted + own; }\n"


def object_of(folder: Path, text: str) -> bytes:
    (folder / "text.c").write_text(text, encoding="utf-8")
    command = [*ZIG, "-fno-sanitize=all", "-target", "x86_64-linux-gnu", "-c", "text.c", "-o", "text.o"]
    subprocess.run(command, cwd=folder, check=True)
    return (folder / "text.o").read_bytes()


def run_python(text: str, folder: Path) -> Outcome:
    return run_limited([sys.executable, "-c", text], folder, folder)


def test_names_of_an_object(tmp_path: Path) -> None:
    assert read_names(object_of(tmp_path, TEXT)) == Names(
        defined=frozenset({"counted", "shared", "more"}), undefined=frozenset({"other"})
    )


def test_damaged_objects_are_refused_or_read(tmp_path: Path) -> None:
    """No damage of the tables raises anything but an ElfError."""
    data = object_of(tmp_path, TEXT)
    refused = 0
    for place in [*range(64), *range(len(data) - 400, len(data))]:
        for byte in (0, 0x7F, 0xFF):
            try:
                read_names(data[:place] + bytes([byte]) + data[place + 1 :])
            except ElfError:
                refused += 1
    assert refused > 20
    for length in (0, 4, 63, 64, len(data) // 2):
        with pytest.raises(ElfError):
            read_names(data[:length])


@posix
def test_processor_time_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limited, "TIME", 2.0)
    assert run_python("while True: pass", tmp_path).how in ("dies of SIGXCPU", "dies of SIGKILL")


@posix
def test_memory_is_bounded(tmp_path: Path) -> None:
    outcome = run_python(f"bytearray({limited.MEMORY})", tmp_path)
    assert outcome.how == "ends with exit code 1"
    assert "MemoryError" in outcome.errors


def test_a_program_that_succeeds_says_so(tmp_path: Path) -> None:
    assert run_python("import sys; sys.stderr.write('fine')", tmp_path) == Outcome("", "fine")


def test_files_elsewhere_are_safe(tmp_path: Path) -> None:
    own, other = tmp_path / "own", tmp_path / "other"
    own.mkdir()
    other.mkdir()
    outcome = run_python(f"open({str(own / 'a')!r}, 'w').close(); open({str(other / 'a')!r}, 'w').close()", own)
    assert (own / "a").exists()
    if not _has_landlock():
        pytest.skip(needs("the kernel has no Landlock", "Linux 5.13"))
    assert not (other / "a").exists()
    assert outcome.how == "ends with exit code 1"


def _has_landlock() -> bool:
    """Whether a child process can give up writing."""
    module, function = write_only_below.__module__, write_only_below.__name__
    text = f"import ctypes; from pathlib import Path; from {module} import {function} as f; c = ctypes.CDLL(None)"
    text += "; c.prctl(38, 1, 0, 0, 0); raise SystemExit(0 if f([Path('.')], c) else 1)"
    return sys.platform == "linux" and subprocess.run([sys.executable, "-c", text], check=False).returncode == 0


@posix
def test_sources_that_grow_without_end_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each macro doubles the one before it."""
    monkeypatch.setattr(limited, "MEMORY", 1024**3)
    monkeypatch.setattr(limited, "TIME", 20.0)
    growing = "".join(f"#define A{i + 1} A{i}, A{i}\n" for i in range(40))
    gain = f"#define A0 1\n{growing}static int grows[] = {{A40}};\n#define GAIN 1\n"
    path = small(tmp_path, "Odd", binary=False, edit={"gain.h": gain})
    with pytest.raises(ContainerError, match=r"^odd: the sources of Odd\.fmu do not compile by themselves: "):
        plan_of(replace(System.of({"odd": path}), step=0.01))
