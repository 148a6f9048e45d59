"""What the rows of the claims say beside their verdict follows from their numbers."""

import math

import numpy as np
import pytest

from orchestration.paper.claims.adaptive import by_how_much, drift, ranges, slight_in_length
from orchestration.paper.claims.motion import pressed
from orchestration.paper.claims.theory import bounded, order, steps, where_s_is_large


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ([5, 4, 3, 2, 1], "s falls at each step"),
        ([5, 4, 3, 2, 4], "s does not fall from K_d = 1000 to 3000"),
        ([5, 6, 3, 2, 4], "s does not fall from K_d = 30 to 100 and from K_d = 1000 to 3000"),
    ],
)
def test_c14c_names_the_steps_at_which_s_does_not_fall(sizes: list[float], expected: str) -> None:
    assert steps(sizes) == expected


def test_c14a_has_an_order_where_v_c_no_longer_rises() -> None:
    assert order(0.08, 0.02) == 2.0
    assert order(0.08, 0.0) == math.inf
    assert math.isnan(order(0.08, math.nan))


def test_c14b_says_that_nothing_is_known_of_large_s_if_s_is_small() -> None:
    assert where_s_is_large(0, 0.0).startswith("no tick has |s| >= delta/k_d")
    assert where_s_is_large(3, 0.02) == "V_s rises by at most 2.0e-02 of V_s(0) at the 3 ticks with |s| >= delta/k_d"


def test_c17_calls_its_bound_true_only_if_it_is() -> None:
    assert bounded(np.array([1e-7, 2e-3])).endswith("is true, and says next to nothing about the size of gamma")
    assert bounded(np.array([0.5, 0.9])).endswith("the bound is true")
    assert bounded(np.array([0.5, 1.1])).endswith("the bound is not true")
    assert bounded(np.array([])).startswith("no tick is in case (c)")


def test_c3b_says_which_force_is_larger() -> None:
    assert "presses no harder" in pressed((600.0, 500.0), (60.0, 58.0))
    assert pressed((600.0, 500.0), (60.0, 61.0)) == ": with the heavier model the mean force is larger"
    assert pressed((600.0, 700.0), (60.0, 61.0)) == ": with the heavier model the peak and the mean force are larger"


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (16.629, "in the median 17 times as large, clearly larger"),
        (1.322, "in the median larger by 32.2 %, clearly larger"),
        (1.001, "in the median larger by 0.1 %, not clearly larger"),
        (0.9, "in the median not larger, but smaller by 10.0 %"),
        (1.0, "in the median neither larger nor smaller"),
    ],
)
def test_c7_and_c10_say_by_how_much(ratio: float, expected: str) -> None:
    assert by_how_much(ratio) == expected


def test_c10_says_that_a_small_length_may_be_a_large_ratio() -> None:
    assert "17 times that of fig5" in slight_in_length(2.27e-5, 3.88e-4)
    assert slight_in_length(2e-4, 3e-4) == ""


def test_a_drift_is_taken_from_the_range_of_the_estimate() -> None:
    times = np.linspace(0.9, 1.1, 201)
    ripple = 0.01 * np.cos(np.arange(201) * np.pi)
    whole, rest = ranges(times, 0.5 * times + ripple)
    assert whole == pytest.approx(0.12, abs=0.01)
    assert rest == pytest.approx(0.02, abs=1e-3)
    assert drift(whole, rest).endswith("(mostly a drift)")
    assert drift(0.088, 0.093).endswith("(not mostly a drift)")
