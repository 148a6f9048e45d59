"""Tests of what a hostile library tries during a check: nothing leaves its process, and the report says what it was."""

import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from orchestration.check import Report, Severity, check
from tests.unit.orchestration.checked import PATIENT, assert_found, compiled, hasty, misbehaving, swap

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE
pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="what Linux denies")

# What the library does in a step: rule, severity, message.
FOUND: dict[str, tuple[str, Severity, str]] = {
    "writes": ("18", NOTE, "leaves files in its working directory: home.txt, left.txt"),
    "forks": ("18", WARNING, "fmi2DoStep asks the system for another process or program"),
    "kills": ("18", WARNING, r"fmi2DoStep asks the system for power over another process.* \(kill, tgkill\); a che"),
    "owns": ("18", WARNING, r"power over another process, or over its own bounds \(fcntl\)"),
    "outlives": ("18", WARNING, r"power over another process, or over its own bounds \(prctl\)"),
    "runs": ("18", WARNING, "fmi2DoStep asks the system for another process or program"),
    "becomes": ("18", WARNING, r"fmi2DoStep asks the system for another process or program \(execve\)"),
    "connects": ("18", WARNING, r"fmi2DoStep asks the system for a socket \(socket\); a check denies it"),
    "prints": ("9", WARNING, "The binary writes to standard output: "),
    "forges": ("18", ERROR, "writes to descriptors that it did not open: to the check's own report"),
    "eats": ("11", ERROR, "fmi2DoStep dies of SIGABRT during the experiment 'stepping'"),
    "opens": ("11", ERROR, "fmi2DoStep dies of SIGABRT during the experiment 'stepping'"),
    "threads": ("11", ERROR, "fmi2DoStep dies of SIGABRT during the experiment 'stepping'"),
    "leaves": ("11", ERROR, "fmi2DoStep ends the process with exit code 0 during the experiment 'stepping'"),
    "closes": ("11", ERROR, "ends the process with exit code 1 during the experiment 'stepping'"),
    "stops": ("11", ERROR, "fmi2DoStep does not return within [0-9.]+ s during the experiment 'stepping'"),
    "rounds": ("17", ERROR, "fmi2DoStep changes the rounding mode: all that this process computes from then on"),
    "flushes": ("17", ERROR, r"fmi2DoStep changes the treatment of tiny numbers \(flush to zero\)"),
    "locale": ("17", WARNING, "fmi2DoStep changes the locale to "),
    "moves": ("17", WARNING, "fmi2DoStep changes the working directory to / of its host"),
    "signals": ("17", WARNING, r"fmi2DoStep changes the handlers of signals \(SIGINT\) of its host"),
    "overwrites": ("17", ERROR, "fmi2SetReal writes into the values, which it is given to read"),
    "exceeds": ("17", ERROR, "fmi2GetReal writes beyond the values that it is asked for"),
    "renumbers": ("17", ERROR, "fmi2SetReal writes into the value references, which it is given to read"),
}
NEEDS_SECCOMP = ("forks", "kills", "owns", "outlives", "runs", "becomes", "connects")
ESCAPED = "adaptimp-escaped"  # how the files begin that the library tries to write outside


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The binary that does what its GUID says."""
    flags = ("-DHOSTILE", "-pthread", "-D_GNU_SOURCE")
    return compiled(tmp_path_factory.mktemp("hostile"), "Hostile", *flags)


def report_on(library: Path, folder: Path, fault: str) -> Report:
    """The report on the FMU with a fault."""
    patience = hasty() if fault == "stops" else PATIENT
    return check(misbehaving(library, folder / "hostile.fmu", fault), timeout=patience)


def test_this_system_confines(library: Path, tmp_path: Path) -> None:
    report = report_on(library, tmp_path, "none")
    assert report.findings == ()
    assert {"session", "parent", "memory", "file size", "files", "time"} <= set(report.confinement)
    assert '"confinement": [' in report.json()


@pytest.mark.parametrize("fault", list(FOUND))
def test_a_hostile_library(library: Path, tmp_path: Path, fault: str) -> None:
    report = report_on(library, tmp_path, fault)
    if fault in NEEDS_SECCOMP and "told" not in report.confinement:
        pytest.skip("this kernel does not tell of denied calls")
    if fault == "flushes" and os.uname().machine != "x86_64":
        pytest.skip("written for one processor")
    assert_found(report, *FOUND[fault])
    assert not [finding.message for finding in report.findings if finding.message == "forged"]
    if "folders" in report.confinement:
        assert not list(Path(tempfile.gettempdir()).glob(f"{ESCAPED}*"))


def test_each_change_is_told_once_with_the_call_that_made_it(library: Path, tmp_path: Path) -> None:
    report = report_on(library, tmp_path, "moves")
    assert [finding.rule for finding in report.findings] == ["17"]


def test_arithmetic_that_loading_changes(tmp_path: Path) -> None:
    """A library that is linked with -ffast-math does so before the first call; here a constructor does."""
    library = compiled(tmp_path, "Fast", "-DHOSTILE", "-pthread", "-D_GNU_SOURCE", "-DON_LOADING")
    report = check(misbehaving(library, tmp_path / "fast.fmu", "none"), timeout=PATIENT)
    assert_found(report, "17", ERROR, "^Loading the library changes the rounding mode: ")
    assert len(report.findings) == 1


def test_one_instance_per_process(library: Path, tmp_path: Path) -> None:
    """Each experiment has a process of its own; a second instance would be refused."""
    edit = swap("modelIdentifier=", 'canBeInstantiatedOnlyOncePerProcess="true" modelIdentifier=')
    report = check(misbehaving(library, tmp_path / "once.fmu", "once", edit), timeout=PATIENT)
    assert report.findings == ()
    wrong = check(misbehaving(library, tmp_path / "state.fmu", "state", edit), timeout=PATIENT)
    assert_found(wrong, "13", ERROR, "After fmi2SetFMUstate, y is .* in row 0; when the state was saved it is")
    wrong = check(misbehaving(library, tmp_path / "reset.fmu", "reset", edit), timeout=PATIENT)
    assert_found(wrong, "13", ERROR, "After fmi2Reset, y is 12 in row 0; in a fresh instance it is 0")
    undeclared = check(misbehaving(library, tmp_path / "twice.fmu", "once"), timeout=PATIENT)
    assert_found(undeclared, "11", ERROR, r'fmi2Instantiate returns no instance \("There is one already')


def test_a_state_that_only_an_initialized_instance_takes(library: Path, tmp_path: Path) -> None:
    report = report_on(library, tmp_path, "early")
    assert_found(report, "13", NOTE, "A state can be restored in an initialized instance only")
    assert len(report.findings) == 1


def test_steps_that_nobody_proposes(library: Path, tmp_path: Path) -> None:
    edit = swap(' stepSize="0.5"', "")
    report = check(misbehaving(library, tmp_path / "own.fmu", "own step", edit), timeout=PATIENT)
    assert_found(report, "11", NOTE, "proposes no step, and a step of 0.001 s is refused; steps of 0.1 s were tried")
    none = check(misbehaving(library, tmp_path / "none.fmu", "no step at all", edit), timeout=PATIENT)
    assert_found(none, "11", ERROR, "and steps of 0.001, .* s are refused: fmi2DoStep returns fmi2Error")


def test_a_check_has_a_time_in_all(library: Path, tmp_path: Path) -> None:
    """Each call returns soon enough, but there are hundreds of them."""
    path = misbehaving(library, tmp_path / "slow.fmu", "slow")
    report = check(path, timeout=PATIENT, total=hasty() + 2)
    assert any(fact.startswith(f"Not tried within {hasty() + 2:g} s: ") for fact in report.facts), report.facts
    assert not report.failed


def test_a_check_that_is_ended_leaves_no_worker(library: Path, tmp_path: Path) -> None:
    """SIGTERM ends the command, while the FMU hangs; the worker holds the end of a pipe as long as it lives."""
    path = misbehaving(library, tmp_path / "hang.fmu", "hang")
    imports = "from pathlib import Path; from orchestration.check import check"
    program = f"{imports}; check(Path({str(path)!r}), timeout=3600)"
    checking = subprocess.Popen([sys.executable, "-c", program])
    watch = -1
    try:
        watch = os.pidfd_open(worker_of(checking.pid))
        checking.send_signal(signal.SIGTERM)
        assert checking.wait(PATIENT) == -signal.SIGTERM
        assert select.select([watch], [], [], PATIENT)[0], "the worker lives on"
    finally:
        checking.kill()
        checking.wait()
        if watch >= 0:
            os.close(watch)


def worker_of(parent: int) -> int:
    """Id of the child of a process, once it is there."""
    children = Path(f"/proc/{parent}/task/{parent}/children")
    for _ in range(int(PATIENT / 0.1)):
        if found := children.read_text().split():
            return int(found[0])
        time.sleep(0.1)
    msg = "no worker was started"
    raise AssertionError(msg)
