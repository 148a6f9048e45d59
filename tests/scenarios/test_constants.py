"""The committed constants of Figs. 5 to 7 are what the runs they come from give."""

import pytest

from orchestration.paper.calibrate import laboratory, noise_bound, torque_limits
from orchestration.paper.numbers import NOISE_BOUND, TORQUE_LIMITS

# The constants are committed to 1e-4 of their size.
TOLERANCE = 1e-3


def test_noise_bound_is_15_percent_of_the_peak_force() -> None:
    assert noise_bound(laboratory()) == pytest.approx(NOISE_BOUND, rel=TOLERANCE)


def test_torque_limits_are_75_percent_of_the_largest_commands() -> None:
    assert torque_limits(laboratory()) == pytest.approx(TORQUE_LIMITS, rel=TOLERANCE)
