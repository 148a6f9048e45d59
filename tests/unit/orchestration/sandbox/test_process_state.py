"""What a library can change of its process is seen, named and put back."""

import ctypes
import locale
import os
import platform
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from orchestration.sandbox.process_state import ProcessState

SOURCE = """
#include <fenv.h>
void precision(void) {
    unsigned short word;
    __asm__ volatile("fnstcw %0" : "=m"(word));
    word &= ~0x0300;
    __asm__ volatile("fldcw %0" : : "m"(word));
}
void traps(void) {
    unsigned int word;
    __asm__ volatile("stmxcsr %0" : "=m"(word));
    word &= ~0x0200;  /* of a division by 0 */
    __asm__ volatile("ldmxcsr %0" : : "m"(word));
}
"""


@pytest.fixture
def moved(tmp_path: Path) -> Iterator[Path]:
    """The working directory, which is another one for a while."""
    before = Path.cwd()
    (tmp_path / "here").mkdir()
    os.chdir(tmp_path / "here")
    yield tmp_path / "here"
    os.chdir(before)


def test_folder_and_handlers_are_put_back(moved: Path) -> None:
    before = ProcessState.now()
    handler = signal.getsignal(signal.SIGUSR1)
    os.chdir("/")
    signal.signal(signal.SIGUSR1, signal.SIG_IGN)
    expected = {"the working directory": " to /", "the handlers of signals": " (SIGUSR1)"}
    try:
        assert before.changes(ProcessState.now()) == expected
        assert before.restore() == expected
        assert before.restore() == {}
        assert Path.cwd() == moved
    finally:
        signal.signal(signal.SIGUSR1, handler)


def test_what_cannot_be_put_back_is_no_error(moved: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: int, name: str | None = None) -> str:
        if name is not None:
            msg = "unsupported locale setting"
            raise locale.Error(msg)
        return next(names)

    names = iter(["old", "new"])
    monkeypatch.setattr(locale, "setlocale", refused)
    before = ProcessState.now()
    os.chdir("/")
    moved.rmdir()
    assert before.restore() == {"the locale": " to new", "the working directory": " to /"}


def test_another_thread_leaves_the_process_alone(moved: Path) -> None:
    before = ProcessState.now()
    os.chdir("/")
    found: list[ProcessState] = []
    put_back: list[dict[str, str]] = []

    def work() -> None:
        found.append(ProcessState.now())
        put_back.extend([found[0].restore(), before.restore()])

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert put_back == [{}, {}]
    assert found[0].restore() == {}
    assert Path.cwd() == Path("/")
    assert (found[0].folder, found[0].locale, found[0].handlers) == ("", "", ())
    assert found[0].arithmetic == before.arithmetic
    assert before.restore() == {"the working directory": " to /"}
    assert Path.cwd() == moved


@pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"), reason="only these processors have an x87 unit"
)
@pytest.mark.parametrize(
    ("function", "name"), [("precision", "the precision of the x87 unit"), ("traps", "the traps of arithmetic")]
)
def test_precision_and_traps_are_named_and_put_back(tmp_path: Path, function: str, name: str) -> None:
    (tmp_path / "unit.c").write_text(SOURCE)
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", str(tmp_path / "unit.c")]
    subprocess.run([*command, "-o", str(tmp_path / "unit.so")], check=True, capture_output=True)
    library, before = ctypes.CDLL(str(tmp_path / "unit.so")), ProcessState.now()
    library[function]()
    assert before.arithmetic_differs()
    assert before.restore() == {name: ""}
    assert before.restore() == {}
