"""The objective of the calibration: excesses of known trials, and their cost."""

import math
from dataclasses import replace

import numpy as np
import pytest

from orchestration.paper.studies.calibration.objective import broken, cost, excesses, visibly_worse
from tests.unit.orchestration.paper.studies.calibration.summaries import GOOD, RATIOS, trial

HALF = math.log(0.5)


def test_half_of_a_limit_has_the_excess_of_a_half() -> None:
    found = excesses(trial())
    for name in ("C4 settled, fig5", "C4 at contact, fig6", "C5 deviation, fig7", "C6 recovery, fig5"):
        assert found[name] == pytest.approx(HALF)
    for name in ("C5 fluctuation, fig5", "C7 bounded", "C7 end", "C9 start", "C9 free", "C16 m2_hat"):
        assert found[name] == pytest.approx(HALF)
    assert found["C9 against a fixed mass"] == pytest.approx(HALF)
    assert found["C10 slightly larger tracking"] == pytest.approx(math.log(2e-5 / 5e-4))
    assert found["C10 slightly larger force"] == pytest.approx(math.log(2.0 / 30))


def test_larger_errors_count_by_their_effect() -> None:
    logarithms = np.log(RATIOS)
    expected = 1 - logarithms.mean() / logarithms.std() / 0.5
    for name in ("C7 larger tracking", "C7 larger force", "C10 larger tracking", "C10 larger force"):
        assert excesses(trial())[name] == pytest.approx(expected)


def test_torques_count_by_their_distance() -> None:
    found = excesses(trial())
    assert found["C8 ratio"] == pytest.approx((0.6 - 0.75) / 0.1)
    assert found["C8 within"] == pytest.approx((0.8 - 1) / 0.1)


def test_all_hold_and_the_smallest_margin_is_the_cost() -> None:
    assert broken(trial()) == ()
    assert cost(excesses(trial())) == pytest.approx(HALF)


@pytest.mark.parametrize(
    ("changes", "claims"),
    [
        ({"m2_settled": 0.5}, ("C4",)),
        ({"m2_in_contact": 0.21}, ("C5",)),
        ({"m2_fluctuation": 0.04}, ("C5",)),
        ({"m2_recovery": 0.11}, ("C6",)),
        ({"torque": np.array([80.0, 30.0])}, ("C8",)),
        ({"e_start": 5.1e-3}, ("C9",)),
        ({"force_error": 10.0}, ("C10",)),
        ({"force_error": 41.0, "e_free": 2e-4}, ("C9", "C10")),
    ],
)
def test_what_breaks_is_named_and_adds_to_the_cost(changes: dict[str, float], claims: tuple[str, ...]) -> None:
    found = trial(**changes)
    assert broken(found) == claims
    beyond = [value for value in excesses(found).values() if value > 0]
    assert cost(excesses(found)) == pytest.approx(sum(beyond))


def test_a_figure_that_is_never_saturated_is_no_worse() -> None:
    """Equal errors are not larger ones."""
    given = trial()
    same = replace(given, runs={**given.runs, "fig6": [GOOD] * 3})
    assert broken(same) == ("C7",)
    assert excesses(same)["C7 larger force"] == 1


def test_a_reader_sees_ten_percent() -> None:
    assert visibly_worse(trial())
    given = trial()
    slightly = [replace(one, force_error=1.05 * GOOD.force_error) for one in given.runs["fig6"]]
    assert not visibly_worse(replace(given, runs={**given.runs, "fig6": slightly}))


def test_one_seed_alone() -> None:
    assert trial().alone(2).runs["fig6"] == [trial().runs["fig6"][2]]
    assert len(trial().alone(2).runs["spong-ortega"]) == 1
    assert broken(trial().alone(0)) == ()
