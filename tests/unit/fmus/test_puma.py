"""FMUs of the PUMA 560: rules and roles, start values, and the closed loop of a controller."""

import pytest

from fmus.catalog import VARIANTS
from orchestration.check import Severity
from orchestration.paper.closed_loop import paper_loop
from tests.unit.fmus.test_start import PRINTED
from tests.unit.fmus.variants import SIGNALS, Open, require_finite_outputs, require_one_start
from tests.unit.orchestration.checked import check
from tests.variant_files import file_of

PUMA = [name for name in VARIANTS if name.endswith("Puma560")]
TRIED = "SlotineLiAdaptiveImpedancePuma560"
"""The controller that is tried in the loop of `adaptimp check`, since a ride takes its time."""


@pytest.mark.parametrize("name", PUMA)
def test_a_variant_breaks_no_rule_and_shows_finite_outputs(open_variant: Open, name: str) -> None:
    report = check(file_of(name), loop=paper_loop if name == TRIED else None)
    assert [finding for finding in report.findings if finding.severity is not Severity.NOTE] == []
    assert report.role is not None
    assert any(fact.startswith("Closed loop") for fact in report.facts) == (name == TRIED)
    require_finite_outputs(open_variant(name))


def test_plant_trajectory_and_controllers_start_at_one_place(open_variant: Open) -> None:
    """Start values are printed with ten digits, and the arm is 1 m long."""
    controllers = [name for name in PUMA if "Impedance" in name]
    places = ("PlantPuma560", "VirtualTrajectoryPuma560")
    require_one_start(open_variant, places, controllers, PRINTED, SIGNALS)
