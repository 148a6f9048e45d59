"""Tests of rules 8 to 16: binaries that misbehave in one way each are found out, in a process of their own."""

import subprocess
from pathlib import Path
from typing import Any

import pytest

from adaptimp_fmu.toolchain import host_platform
from orchestration.check import Severity, check
from orchestration.check.dynamic import supervision
from orchestration.sandbox import process
from orchestration.sandbox.process import Ending
from tests.unit.orchestration.checked import PATIENT, assert_found, compiled, hasty, misbehaving, swap

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE

WRONG: dict[str, tuple[str, Severity, str]] = {
    "refuse": ("9", ERROR, "Instantiation: fmi2Instantiate returns no instance, and logs no message"),
    "exit": ("9", ERROR, "fmi2Instantiate ends the process with exit code 7 during .*'instantiation'"),
    "initialization": ("11", ERROR, r'fmi2EnterInitializationMode returns fmi2Error at t = 0 s \("3 of four"\)'),
    "nan at start": ("11", ERROR, "not finite after initialization with the start values: y = inf"),
    "nan": ("11", ERROR, "not finite at t = 2 s: y = nan"),
    "step": ("11", ERROR, "Stepping: fmi2DoStep returns fmi2Error at t = 0 s"),
    "crash": ("11", ERROR, "fmi2DoStep dies of SIG.* during the experiment 'stepping'"),
    "hang": ("11", ERROR, "fmi2DoStep does not return within [0-9.]+ s during the experiment 'stepping'"),
    "stdout": ("9", WARNING, 'writes to standard output: "hello from the FMU'),
    "chatter": ("9", WARNING, 'writes to standard output: "step'),
    "reset": ("13", ERROR, "After fmi2Reset, y is 12 in row 0; in a fresh instance it is 0"),
    "state": ("13", ERROR, "After fmi2SetFMUstate, y is .* in row 0; when the state was saved it is"),
    "no state": ("13", ERROR, "Rollback: fmi2GetFMUstate returns fmi2Error"),
    "serialization": ("13", ERROR, "With its state deserialized, y is"),
    "huge state": ("13", ERROR, "fmi2SerializedFMUstateSize says 9223372036854775807 bytes"),
    "torn": ("13", WARNING, "accepts 24 of 48 bytes of a state"),
    "shared": ("13", WARNING, "memory that instances share"),
    "random": ("13", WARNING, "random numbers without a seed"),
    "split": ("14", WARNING, "With each step split in two, y is 2 in row 0; with whole steps it is 1"),
    "lives": ("14", ERROR, "fmi2Instantiate dies of SIGABRT during the experiment '50 lives'"),
    "derivative": ("16", ERROR, "d y / d u is -1 as a derivative, 1 as a difference"),
    "reference": ("10", WARNING, "unknown value reference 4294967294 returns fmi2OK; an error is due"),
    "crash on reference": ("10", WARNING, "fmi2GetReal dies of SIGABRT during the experiment 'unknown reference'"),
    "crash on NaN": ("11", ERROR, "fmi2SetReal dies of SIGABRT during the experiment 'NaN as input'"),
    "any step": ("11", WARNING, "fmi2DoStep with h = -0.5 s returns fmi2OK; an error is due"),
    "hang on negative step": ("11", WARNING, "fmi2DoStep does not return within [0-9.]+ s .* 'step of NaN'"),
    "settable": ("12", WARNING, "fmi2SetReal of the fixed parameter p after initialization returns fmi2OK"),
    "terminate": ("10", ERROR, "Termination: fmi2Terminate returns fmi2Error"),
}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The binary that misbehaves as its GUID says."""
    return compiled(tmp_path_factory.mktemp("misbehaving"), "Misbehaving")


def test_one_that_behaves(library: Path, tmp_path: Path) -> None:
    report = check(misbehaving(library, tmp_path / "good.fmu", "none"), timeout=PATIENT)
    assert report.findings == ()
    assert report.role is None


@pytest.mark.parametrize("fault", list(WRONG))
def test_one_that_misbehaves(library: Path, tmp_path: Path, fault: str) -> None:
    rule, severity, message = WRONG[fault]
    patience = hasty() if fault.startswith("hang") else PATIENT
    report = check(misbehaving(library, tmp_path / "wrong.fmu", fault), timeout=patience)
    assert_found(report, rule, severity, message)
    assert all(finding.rule != "1" for finding in report.findings)
    if severity == WARNING:
        assert not report.failed, "such an FMU can be used"


def test_one_that_takes_any_guid(tmp_path: Path) -> None:
    report = check(misbehaving(compiled(tmp_path, "any", "-DANY_GUID"), tmp_path / "any.fmu", "none"), timeout=PATIENT)
    assert_found(report, "9", WARNING, "accepts a wrong GUID")
    assert not report.failed


def test_what_a_mistake_damages_is_not_held_against_right_calls(library: Path, tmp_path: Path) -> None:
    """The FMU dies 20 instances after a value reference that it does not have: in no call of ours."""
    report = check(misbehaving(library, tmp_path / "damaged.fmu", "damage"), timeout=PATIENT)
    assert report.findings == ()


@pytest.mark.skipif(host_platform().extension != ".so", reason="reads ELF files")
@pytest.mark.parametrize("declared", [False, True])
def test_one_that_needs_an_interpreter(tmp_path: Path, declared: bool) -> None:
    library = compiled(tmp_path, "python", "-DPYTHON", "-Wl,--allow-shlib-undefined", "-Wl,-z,lazy")
    edit = swap("modelIdentifier=", 'needsExecutionTool="true" modelIdentifier=') if declared else lambda xml: xml
    report = check(misbehaving(library, tmp_path / "python.fmu", "none", edit), timeout=PATIENT)
    assert_found(report, "8", NOTE if declared else WARNING, "so calls PyList_New of a Python interpreter that the imp")
    assert not report.failed


def test_a_missing_function(tmp_path: Path) -> None:
    library = compiled(tmp_path, "incomplete", "-DINCOMPLETE")
    report = check(misbehaving(library, tmp_path / "wrong.fmu", "none"), timeout=PATIENT)
    assert_found(report, "8", ERROR, "not export fmi2GetRealOutputDerivatives; co-simulation needs all 34")
    assert len(report.findings) == 1


def test_one_that_takes_no_other_inputs(library: Path, tmp_path: Path) -> None:
    report = check(misbehaving(library, tmp_path / "picky.fmu", "picky"), timeout=PATIENT)
    assert report.findings == ()
    assert any("kept at their start values" in fact for fact in report.facts)


def test_what_is_not_promised_is_not_tried(library: Path, tmp_path: Path) -> None:
    """An FMU without states, derivatives or variable steps, of which there is but one."""
    edit = swap(
        r"canHandleVariable.*?/>",
        'canHandleVariableCommunicationStepSize="false" canBeInstantiatedOnlyOncePerProcess="true"/>',
    )
    for fault in ("no state", "derivative", "split"):
        report = check(misbehaving(library, tmp_path / "less.fmu", fault, edit), timeout=PATIENT)
        assert report.findings == (), fault


def test_a_hang_costs_one_timeout_and_ends(library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One worker waits in vain, no later one tries the same again, and none is left behind."""
    started, endings, patience = [], [], hasty()

    class Recorded(subprocess.Popen[bytes]):
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            started.append(self)

    def recorded(*arguments: Any, **options: Any) -> Ending:
        endings.append(process.work(*arguments, **options))
        return endings[-1]

    monkeypatch.setattr(subprocess, "Popen", Recorded)
    monkeypatch.setattr(supervision, "work", recorded)
    check(misbehaving(library, tmp_path / "wrong.fmu", "hang"), timeout=patience)
    assert [ending.how for ending in endings].count(f"does not return within {patience:g} s") == 1
    assert len(started) == len(endings)
    assert all(worker.returncode is not None for worker in started)
