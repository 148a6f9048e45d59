"""The space of the search: settings and shares of ranges, few digits, and small changes."""

import numpy as np
import pytest

from orchestration.paper.calibrations import CHOSEN_CALIBRATION, FIRST, LARGEST
from orchestration.paper.numbers import LARGEST_PSI
from orchestration.paper.studies.calibration.space import (
    NOISE_HOLD,
    PERTURBATION,
    SAMPLE_TIME,
    SEARCHED,
    perturbed,
    rounded,
    setting_at,
    shares_of,
    starts,
)
from orchestration.paper.studies.open_values import EARLIER, OPEN_VALUES

CONTINUOUS = [value.name for value in OPEN_VALUES if not value.choices]


def test_shares_and_settings_are_one_the_inverse_of_the_other() -> None:
    shares = shares_of(EARLIER)
    found = setting_at(shares)
    for name in SEARCHED:
        assert found[name] == pytest.approx(EARLIER[name], rel=1e-12)
    assert (found["sample_time"], found["noise_hold"], found["torque_reading"]) == (SAMPLE_TIME, NOISE_HOLD, LARGEST)
    assert found["mu"] == FIRST.values["mu"]
    np.testing.assert_allclose(shares_of(found), shares, rtol=1e-12)


def test_the_ends_of_the_cube_are_in_the_ranges() -> None:
    ranges = {value.name: (value.low, value.high) for value in OPEN_VALUES}
    for shares in (np.zeros(len(SEARCHED)), np.ones(len(SEARCHED))):
        for name, number in setting_at(shares).items():
            low, high = ranges[name]
            assert low <= number <= high * (1 + 1e-12), name


def test_a_rounded_setting_has_few_digits() -> None:
    found = rounded({**FIRST.values, "Psi_1": 123.456, "wall_offset": 1.43871, "depth": 0.01537, "noise_hold": 5.1e-5})
    expected = {"Psi_1": 120.0, "wall_offset": 1.439, "depth": 0.0155, "noise_hold": 6e-5, "noise_share": 0.15}
    assert expected.items() <= found.items()
    assert rounded(found) == found


def test_the_chosen_calibration_has_few_digits() -> None:
    assert rounded(CHOSEN_CALIBRATION.values) == CHOSEN_CALIBRATION.values


def test_small_changes_change_every_continuous_value_by_a_little() -> None:
    found = list(perturbed(EARLIER, 64))
    assert len(found) == 64
    for name in CONTINUOUS:
        if name == "wall_offset":
            changes = [(1.5 - one[name]) / (1.5 - EARLIER[name]) for one in found]
        else:
            changes = [one[name] / EARLIER[name] for one in found]
        assert max(changes) <= 1 + PERTURBATION + 1e-12
        assert min(changes) >= 1 - PERTURBATION - 1e-12
        assert np.ptp(changes) > 1.9 * PERTURBATION  # 64 Sobol points leave no more than 1/64 of the range at its ends
    for name in set(EARLIER) - set(CONTINUOUS):
        assert {one[name] for one in found} == {EARLIER[name]}


def test_psi_of_algorithm_1_stays_below_its_limit() -> None:
    assert max(one["Psi_1"] for one in perturbed({**EARLIER, "Psi_1": 168.0}, 64)) < LARGEST_PSI


def test_starts_are_known_settings_their_neighbours_and_points_anywhere() -> None:
    found = starts((EARLIER, FIRST.values), anywhere=8, around=4, width=0.3)
    assert found.shape == (2 + 2 * 4 + 8, len(SEARCHED))
    np.testing.assert_array_equal(found[0], shares_of(EARLIER))
    assert (np.abs(found[2:6] - found[0]) <= 0.15 + 1e-12).all()
    assert np.ptp(found[10:], axis=0).min() > 0.6
    assert found.min() >= 0
    assert found.max() <= 1
