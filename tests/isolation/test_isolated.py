"""What an isolated FMU does ends its run with a sentence, and changes nothing in the process of the run."""

import locale
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest

from orchestration import Isolation, RunInterrupted, SimulationError, System, SystemDescriptionError, prepare, simulate
from orchestration.errors import ArchiveError, InitializationError
from tests.isolation.conftest import Unruly

Found = TypeVar("Found")
UNDEFINED = "a status that FMI does not define"
WHERE = "at t = 0.5 s (step 5)"
SMALL = 600 * 2**20  # bytes, which an interpreter takes many times over in addresses, and a bomb in a second


_BEFORE: set[str] = set()
"""Processes of this one when a test began: other tests leave the helpers of multiprocessing, which live on."""


def _all_children() -> list[str]:
    task = Path(f"/proc/self/task/{threading.get_native_id()}/children")
    return task.read_text().split()


def children() -> list[str]:
    """Processes of this one that the test has begun and that have not been waited for."""
    return [child for child in _all_children() if child not in _BEFORE]


@pytest.fixture(autouse=True)
def _know_other_children() -> None:
    _BEFORE.clear()
    _BEFORE.update(_all_children())


@pytest.mark.parametrize(
    ("deed", "how"),
    [
        ("crash", "died of SIGSEGV"),
        ("exit", "ended its process with exit code 0"),
        ("end", "ended its process with exit code 0"),
        ("abort", "died of SIGABRT"),
    ],
)
def test_the_end_of_the_process_is_an_error_with_the_rows_before(unruly: Unruly, deed: str, how: str) -> None:
    with pytest.raises(SimulationError) as failed:
        simulate(unruly(f"step {deed}"), 1.0, 0.1, isolate=True)
    assert str(failed.value) == f"m: fmi2DoStep {how} {WHERE}; it logged nothing."
    assert failed.value.result is not None
    np.testing.assert_allclose(failed.value.result["m.y"], np.linspace(0, 0.5, 6))
    assert failed.value.result.status == "failed"
    assert children() == []


@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize(
    ("deed", "error", "message"),
    [
        ("step minus one", SimulationError, f"m: fmi2DoStep returned {UNDEFINED} {WHERE}; its last message: "),
        ("step lowest", SimulationError, f"m: fmi2DoStep returned {UNDEFINED} {WHERE}; its last message: "),
        ("step hundred", SimulationError, f"m: fmi2DoStep returned {UNDEFINED} {WHERE}; its last message: "),
        ("get minus one", InitializationError, f"m: fmi2GetReal returned {UNDEFINED} during initialization; it"),
        ("terminate minus one", SimulationError, "m: fmi2Terminate returned status -1; it logged nothing"),
    ],
)
def test_a_status_that_fmi_does_not_define_is_a_failure(
    unruly: Unruly, deed: str, error: type[Exception], message: str, *, isolated: bool
) -> None:
    with pytest.raises(error, match=re.escape(message)):
        simulate(unruly(deed), 1.0, 0.1, isolate=isolated)


def test_a_call_that_does_not_return_is_ended(unruly: Unruly) -> None:
    with pytest.raises(SimulationError, match=r"did not return within 1 s at t = 0\.5 s") as failed:
        simulate(unruly("step hang"), 1.0, 0.1, isolate=Isolation(time_limit=1.0))
    assert failed.value.result is not None
    assert len(failed.value.result.time) == 6
    assert children() == []


def test_a_call_may_take_long(unruly: Unruly) -> None:
    result = simulate(unruly("step sleep"), 1.0, 0.1, isolate=True)
    np.testing.assert_array_equal(result["m.y"], simulate(unruly("step none"), 1.0, 0.1)["m.y"])


def test_memory_is_limited(unruly: Unruly) -> None:
    with pytest.raises(
        SimulationError, match=r"went beyond its memory limit of 600 MiB \(died of SIGABRT\) at t = 0.5"
    ):
        simulate(unruly("step memory"), 1.0, 0.1, isolate=Isolation(memory_limit=SMALL))


def test_open_files_are_limited(unruly: Unruly) -> None:
    with pytest.raises(SimulationError, match="this cannot be done"):
        simulate(unruly("step files"), 1.0, 0.1, isolate=Isolation(descriptor_limit=64))


@pytest.mark.parametrize(
    ("deed", "error", "message"),
    [
        ("load crash", ArchiveError, "cannot be loaded: loading it died of SIGSEGV"),
        ("load exit", ArchiveError, "cannot be loaded: loading it ended its process with exit code 0"),
        ("instantiate crash", InitializationError, "m: fmi2Instantiate died of SIGSEGV"),
        ("instantiate exit", InitializationError, "m: fmi2Instantiate ended its process with exit code 0"),
        ("step close", SimulationError, "m: fmi2Terminate ended its process with exit code 1"),
        ("terminate crash", SimulationError, "m: fmi2Terminate died of SIGSEGV; it logged nothing"),
    ],
)
def test_other_calls_are_named(unruly: Unruly, deed: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        simulate(unruly(deed), 1.0, 0.1, isolate=True)
    assert children() == []


def test_what_an_fmu_changes_stays_in_its_process(unruly: Unruly, capfd: pytest.CaptureFixture[str]) -> None:
    before = os.getcwd(), locale.setlocale(locale.LC_ALL), signal.getsignal(signal.SIGINT), 1.0 + 2.0**-53
    for deed in ("folder", "locale", "rounding", "flush", "signals", "print"):
        simulate(unruly(f"step {deed}"), 1.0, 0.1, isolate=True)
    now = os.getcwd(), locale.setlocale(locale.LC_ALL), signal.getsignal(signal.SIGINT), np.add(1.0, 2.0**-53)
    assert now == before
    assert np.float64(5e-324) * 1.0 == 5e-324
    assert capfd.readouterr() == ("", "")


def test_others_are_ended_as_usual_after_a_crash(unruly_file: Callable[[str], Path]) -> None:
    both = System.of({"good": unruly_file("step talk"), "bad": unruly_file("step crash")})
    with pytest.raises(SimulationError, match="bad: fmi2DoStep died of SIGSEGV"):
        simulate(both, 1.0, 0.1, isolate=True)
    assert children() == []


def test_messages_arrive(unruly: Unruly) -> None:
    with pytest.raises(SimulationError, match=r'its last message: "this cannot be done at t = 0\.5 s"'):
        simulate(unruly("step files"), 1.0, 0.1, isolate=True)


def end(processes: list[str]) -> None:
    for process in processes:
        os.kill(int(process), signal.SIGKILL)


def test_ctrl_c_ends_a_call_that_does_not_return(unruly: Unruly) -> None:
    with prepare(unruly("step hang"), 1.0, 0.1, isolate=Isolation(time_limit=None)) as run:
        pressed = threading.Timer(1.0, os.kill, [os.getpid(), signal.SIGINT])
        lost = threading.Timer(120.0, end, [children()])  # then the test fails, and the others go on
        pressed.start()
        lost.start()
        with pytest.raises(RunInterrupted) as interrupt:
            run.run()
        lost.cancel()
        pressed.join()
    assert len(interrupt.value.result.time) == 6
    assert children() == []


def test_nothing_is_left_when_the_run_is_killed(unruly: Unruly, tmp_path: Path) -> None:
    path = unruly("step hang").component("m").description.path
    script = tmp_path / "run.py"
    script.write_text(
        "from orchestration import System, simulate\n"
        f"simulate(System.of({{'m': {str(path)!r}}}), 1.0, 0.1, isolate=True)\n"
    )
    process = subprocess.Popen([sys.executable, str(script)])
    try:
        child = _waited_for(lambda: _children_of(process.pid))[0]
    finally:
        process.kill()
        process.wait()
    _waited_for(lambda: not Path(f"/proc/{child}").exists())


def _children_of(pid: int) -> list[str]:
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


def _waited_for(found: Callable[[], Found]) -> Found:
    """What a function returns at last; a minute is enough on a machine that is busy."""
    for _ in range(600):
        if value := found():
            return value
        time.sleep(0.1)
    raise AssertionError(found)


def test_names_are_checked(unruly: Unruly) -> None:
    with pytest.raises(SystemDescriptionError, match="isolate names 'n', which is no component; there are m"):
        simulate(unruly("step none"), 1.0, 0.1, isolate=["n"])
