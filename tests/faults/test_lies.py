"""An FMU that declares what it does not keep: no run can see that, and `check` does."""

from pathlib import Path

import pytest

from orchestration.check import check
from orchestration.check.findings import Severity
from tests.faults.shim.codes import Fault
from tests.faults.shim.fmus import misbehaving

LIES = {
    "states are not restored": (Fault.IDLE, "fmi2SetFMUstate", "13", "Rollback: "),
    "states are not saved": (Fault.IDLE, "fmi2GetFMUstate", "13", "Rollback: "),
    "states are refused": (Fault.ERROR, "fmi2GetFMUstate", "13", "fmi2GetFMUstate returns fmi2Error"),
    "states are not read": (Fault.IDLE, "fmi2DeSerializeFMUstate", "13", "Serialization: "),
    "nothing is reset": (Fault.IDLE, "fmi2Reset", "13", "Reset: "),
    "derivatives are none": (Fault.NAN, "fmi2GetDirectionalDerivative", "16", "d y / d u is nan"),
    "steps are pending": (Fault.PENDING, "fmi2DoStep", "11", "fmi2DoStep returns fmi2Pending"),
    "statuses are unknown": (Fault.UNKNOWN, "fmi2DoStep", "11", "fmi2DoStep returns status 77"),
    "the end is refused": (Fault.ERROR, "fmi2Terminate", "10", "fmi2Terminate returns fmi2Error"),
}


def errors(path: Path) -> list[tuple[str, str]]:
    """Rules and messages of the errors that the check finds."""
    return [(f.rule, f.message) for f in check(path).findings if f.severity == Severity.ERROR]


@pytest.mark.parametrize("lie", LIES)
def test_the_check_finds_lies(lie: str, tmp_path: Path) -> None:
    fault, function, rule, words = LIES[lie]
    found = errors(misbehaving(tmp_path, fault, function))
    assert any(number == rule and words in message for number, message in found), found


def test_the_shim_itself_is_honest(tmp_path: Path) -> None:
    assert errors(misbehaving(tmp_path)) == []
