"""FMUs of the PUMA 560: rules and roles, start values, and the closed loop of a controller."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from fmus.catalog import VARIANTS
from orchestration.check import Severity
from orchestration.paper.built_fmus import built
from orchestration.paper.closed_loop import paper_loop
from tests.driver import Driver
from tests.unit.fmus.test_start import PRINTED, starts
from tests.unit.orchestration.checked import check

Open = Callable[[str], Driver]
TS = 1e-4  # s
PUMA = [name for name in VARIANTS if name.endswith("Puma560")]
TRIED = "SlotineLiAdaptiveImpedancePuma560"
"""The controller that is tried in the loop of `adaptimp check`, since a ride takes its time."""


@pytest.fixture
def open_variant() -> Iterator[Open]:
    """Opens a variant by its identifier; everything opened is freed after the test."""
    drivers: list[Driver] = []

    def open_one(name: str) -> Driver:
        drivers.append(Driver(built(name)))
        return drivers[-1]

    yield open_one
    for driver in drivers:
        driver.close()


def vector(values: dict[str, float], name: str) -> np.ndarray:
    """The six elements of a vector."""
    return np.array([values[f"{name}[{i}]"] for i in range(1, 7)])


@pytest.mark.parametrize("name", PUMA)
def test_a_variant_breaks_no_rule_and_shows_finite_outputs(open_variant: Open, name: str) -> None:
    report = check(built(name), loop=paper_loop if name == TRIED else None)
    assert [finding for finding in report.findings if finding.severity is not Severity.NOTE] == []
    assert report.role is not None
    assert any(fact.startswith("Closed loop") for fact in report.facts) == (name == TRIED)
    driver = open_variant(name)
    driver.initialize()
    for k in range(3):
        driver.step(k * TS, TS)
        assert all(np.isfinite(value) for value in driver.outputs().values())
    assert not driver.messages


def test_plant_trajectory_and_controllers_start_at_one_place(open_variant: Open) -> None:
    shown: dict[str, float] = {}
    for name in ("PlantPuma560", "VirtualTrajectoryPuma560"):
        driver = open_variant(name)
        driver.initialize()
        shown |= driver.outputs()
    # q is printed with ten digits, and the arm is 1 m long
    np.testing.assert_allclose(vector(shown, "x"), vector(shown, "x_v"), rtol=0, atol=PRINTED)
    np.testing.assert_allclose(vector(shown, "dx"), vector(shown, "dx_v"), rtol=0, atol=PRINTED)
    for name in PUMA:
        if "Impedance" in name:
            inputs = starts(open_variant(name))
            for signal in ("q", "dq", "ddq", "x_v", "dx_v", "ddx_v"):
                np.testing.assert_allclose(vector(inputs, signal), vector(shown, signal), rtol=0, atol=PRINTED)
