"""The committed constants of Figs. 5 to 7 are what the runs they come from give, to the digits that they have."""

from orchestration.paper.calibrate import laboratory, noise_bound, torque_limits
from orchestration.paper.numbers import NOISE_BOUND, TORQUE_LIMITS

DIGITS = 2  # behind the point


def test_noise_bound_is_15_percent_of_the_peak_force() -> None:
    assert round(noise_bound(laboratory()), DIGITS) == NOISE_BOUND


def test_torque_limits_are_75_percent_of_the_largest_commands() -> None:
    one, two = torque_limits(laboratory())
    assert (round(one, DIGITS), round(two, DIGITS)) == TORQUE_LIMITS
