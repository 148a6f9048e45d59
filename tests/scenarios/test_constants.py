"""The committed constants of Figs. 5 to 7 are what the runs they come from give, to the digits that they have."""

import pytest

from orchestration.paper.calibrate import laboratory, noise_bound, torque_limits
from orchestration.paper.calibrations import CALIBRATIONS, Calibration

EVERY = pytest.mark.parametrize("calibration", CALIBRATIONS.values(), ids=lambda calibration: calibration.name)

DIGITS = 2  # behind the point


@EVERY
def test_noise_bound_is_15_percent_of_the_peak_force(calibration: Calibration) -> None:
    assert round(noise_bound(laboratory(), calibration), DIGITS) == calibration.noise_bound


@EVERY
def test_torque_limits_are_75_percent_of_the_largest_commands(calibration: Calibration) -> None:
    one, two = torque_limits(laboratory(), calibration)
    assert (round(one, DIGITS), round(two, DIGITS)) == calibration.torque_limits
