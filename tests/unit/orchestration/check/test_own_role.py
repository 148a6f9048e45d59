"""A check knows no scenario: roles and the trial at the end are the caller's."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from orchestration.check import Candidate, Finding, Role, Severity, check
from orchestration.check.findings import ROLE, note
from orchestration.check.interface import COUNTED, SCALAR, Signal
from tests.unit.orchestration.checked import assert_found, compiled, misbehaving

ERROR, NOTE = Severity.ERROR, Severity.NOTE
VALVE = Role("valve", "y", {"y": Signal("", SCALAR)}, {"spare": Signal("m", SCALAR)}, {"u": Signal("", SCALAR)})
PUMP = Role("pump", "flow", {"flow": Signal("m/s", COUNTED)}, counted="stage", fewest=3)


@pytest.fixture(scope="module")
def fmu_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU with the input u and the output y."""
    folder = tmp_path_factory.mktemp("flow")
    return misbehaving(compiled(folder, "good"), folder / "good.fmu", "none")


def test_the_role_that_the_outputs_tell(fmu_file: Path) -> None:
    report = check(fmu_file, (PUMP, VALVE))
    assert report.role == "valve"
    assert [f.message for f in report.findings if f.rule == ROLE] == [
        "The output spare in m of the valve is missing; results and reports that read it cannot."
    ]
    assert check(fmu_file, (PUMP,)).role is None
    assert check(fmu_file, (VALVE, Role("tap", "y", VALVE.required))).role is None, "two roles fit"
    assert check(fmu_file).role is None


def test_a_role_that_is_not_its_own(fmu_file: Path) -> None:
    assert_found(check(fmu_file, PUMP), ROLE, ERROR, r"The output flow\[1\], flow\[2\], flow\[3\] in m/s of the pump")


def test_a_trial_comes_last_and_is_told_of_errors(fmu_file: Path) -> None:
    seen: list[Candidate] = []

    def trial(candidate: Candidate) -> tuple[Sequence[Finding], Sequence[str]]:
        seen.append(candidate)
        return [note("trial", "It leaks.")], ["It was opened once."]

    report = check(fmu_file, VALVE, mapping={"u": "u"}, trial=trial)
    assert_found(report, "trial", NOTE, "It leaks")
    assert report.facts[-1] == "It was opened once."
    check(fmu_file, PUMP, trial=trial)
    check(fmu_file, trial=trial)
    assert [(c.role.name, c.count, c.mapping, c.failed) for c in seen] == [
        ("valve", 1, {"u": "u"}, False),
        ("pump", 3, {}, True),
    ], "without a role there is nothing to try"
