"""The space of the open values: ranges with the chosen values inside, filled evenly, the same points everywhere."""

import hashlib
from collections.abc import Mapping

import numpy as np
import pytest

from orchestration.paper import settings as start_values
from orchestration.paper.calibrations import (
    CALIBRATIONS,
    CHOSEN_CALIBRATION,
    EACH_JOINT,
    FIRST,
    LARGEST,
    NORM,
    Calibration,
)
from orchestration.paper.scenarios import AT_FIRST, SCENARIOS, VARIANTS, Scenario
from orchestration.paper.studies.fixed_values import FIXED
from orchestration.paper.studies.open_values import (
    CHOSEN,
    EARLIER,
    OPEN_VALUES,
    OpenValue,
    setting_at,
    settings,
    settings_near,
)

BY_NAME = {value.name: value for value in OPEN_VALUES}


@pytest.mark.parametrize("value", OPEN_VALUES, ids=lambda value: value.name)
def test_chosen_values_lie_in_their_ranges(value: OpenValue) -> None:
    for given in (value.chosen, EARLIER[value.name], FIRST.values[value.name]):
        assert value.low <= given <= value.high
        if value.choices:
            assert given in value.choices
        else:
            assert value.at(np.array(value.share_of(given))) == pytest.approx(given, rel=1e-14)
    assert value.reason
    assert value.claims


@pytest.mark.parametrize("calibration", CALIBRATIONS.values(), ids=lambda calibration: calibration.name)
def test_a_calibration_has_a_number_for_every_open_value(calibration: Calibration) -> None:
    assert set(calibration.values) == {value.name for value in OPEN_VALUES}


def test_fixed_values_have_reasons_and_are_none_of_the_open_ones() -> None:
    assert all(fixed.value and fixed.reason and fixed.claims for fixed in FIXED)
    names = [fixed.name for fixed in FIXED]
    assert len(set(names)) == len(names)
    assert not set(names) & {value.name for value in OPEN_VALUES}


@pytest.mark.parametrize(
    ("calibration", "runs"),
    [(CHOSEN_CALIBRATION, {**SCENARIOS, **VARIANTS}), (FIRST, AT_FIRST)],
    ids=["section-v", "first"],
)
def test_scenarios_have_the_numbers_of_their_calibration(
    calibration: Calibration, runs: Mapping[str, Scenario]
) -> None:
    setting, bound = calibration.values, calibration.noise_bound
    by_figure = {name.removesuffix("-first"): scenario for name, scenario in runs.items()}
    gains = {
        "fig5": start_values.craig(setting, bound),
        "fig6": start_values.craig(setting, bound) | start_values.limits(calibration.torque_limits),
        "fig7": start_values.slotine_li(setting) | start_values.limits(calibration.torque_limits),
        "spong-ortega": start_values.fixed_inverse(setting, bound),
    }
    for name, scenario in by_figure.items():
        expected = start_values.place(setting)
        if name in gains:
            expected |= start_values.sensor(setting, bound) | gains[name]
            assert scenario.step == setting["sample_time"]
        given = {path: value.number for path, value in scenario.values.items()}
        assert expected.items() <= given.items(), name


def test_the_earlier_calibration_is_kept() -> None:
    """Its results stay as they are, bit for bit, so its numbers do."""
    rounded = {path: value.number for path, value in AT_FIRST["fig6-first"].values.items()}
    assert AT_FIRST["fig6-first"].step == 2e-5
    expected = {
        "plant.q_start[1]": -0.7227342478,
        "plant.dq_start[1]": 2.0943951024,
        "plant.wall_offset": 1.45,
        "trajectory.depth": 0.01,
        "sensor.noise_bound": 91.12,
        "sensor.noise_std": 91.12 / 3,
        "sensor.noise_period": 0.0,
        "controller.Psi[2]": 100.0,
        "controller.Gamma[2]": 5.0,
        "controller.noise_bound": 91.12,
        "controller.gamma_margin": 1.5,
        "controller.gamma_eps": 1e-4,
        "actuator.tau_max[1]": 533.61,
        "actuator.tau_max[2]": 306.83,
    }
    assert expected.items() <= rounded.items()
    fig7 = {path: value.number for path, value in AT_FIRST["fig7-first"].values.items()}
    assert (fig7["controller.Gamma[2]"], fig7["controller.K_d[1]"], fig7["controller.Psi[1]"]) == (4.0, 100.0, 100.0)


@pytest.mark.parametrize(("reading", "expected"), [(EACH_JOINT, (75, 30)), (LARGEST, (75, 75)), (NORM, (78, 78))])
def test_readings_of_the_largest_torque(reading: float, expected: tuple[float, float]) -> None:
    found = start_values.torque_limits(np.array([100.0, 40.0]), 104.0, reading)
    np.testing.assert_allclose(found, expected, rtol=1e-15)


def test_either_elbow_puts_the_tip_at_the_start_with_the_same_velocity() -> None:
    for elbow in (1.0, -1.0):
        given = start_values.place({**CHOSEN, "elbow": elbow, "starts_moving": 1.0})
        q1, q2 = (given[f"plant.q_start[{i}]"] for i in (1, 2))
        dq1, dq2 = (given[f"plant.dq_start[{i}]"] for i in (1, 2))
        tip = np.exp(1j * q1) + np.exp(1j * (q1 + q2))
        velocity = 1j * dq1 * np.exp(1j * q1) + 1j * (dq1 + dq2) * np.exp(1j * (q1 + q2))
        # Angles and rates are rounded to ten digits.
        assert tip == pytest.approx(1.5, abs=1e-9)
        assert velocity == pytest.approx(1j * np.pi, abs=1e-9)
    rest = start_values.place({**CHOSEN, "starts_moving": 0.0})
    assert rest["plant.dq_start[1]"] == rest["plant.dq_start[2]"] == 0


@pytest.mark.parametrize(
    ("hold", "sample_time", "period"), [(2e-5, 2e-5, 0.0), (6e-5, 1e-5, 6e-5), (7.2e-5, 2e-5, 8e-5), (1e-5, 1e-4, 0.0)]
)
def test_noise_is_held_for_whole_ticks(hold: float, sample_time: float, period: float) -> None:
    found = start_values.noise_period({**CHOSEN, "noise_hold": hold, "sample_time": sample_time})
    assert found == pytest.approx(period, rel=1e-12)


def test_every_range_is_filled_evenly() -> None:
    points = settings(256)
    for value in OPEN_VALUES:
        if value.choices:
            for choice in set(value.choices):
                expected = 256 * value.choices.count(choice) / len(value.choices)
                assert abs((points[value.name] == choice).sum() - expected) < 1
        else:
            shares = [value.share_of(x) for x in points[value.name]]
            # Sobol points: 256 of them put exactly one into each 256th part of every range.
            np.testing.assert_array_equal(np.sort((np.array(shares) * 256).astype(int)), np.arange(256))


def test_a_longer_sequence_begins_with_a_shorter_one() -> None:
    short, long = settings(5), settings(100)
    for name, values in short.items():
        assert values.tobytes() == long[name][:5].tobytes()


def test_points_are_those_of_the_table() -> None:
    """The rows of docs/robustness.csv belong to these points, whatever version of SciPy makes them."""
    rounded = [f"{x:.12g}" for values in settings(64).values() for x in values]
    assert hashlib.sha256(" ".join(rounded).encode()).hexdigest()[:16] == "fa4c03f7813a2a31"


def test_neighbours_stay_in_their_box_and_in_the_space() -> None:
    setting = {**CHOSEN, "Psi_1": 160.0}
    near = settings_near(setting, 64, 0.2)
    for value in OPEN_VALUES:
        if value.choices:
            assert (near[value.name] == setting[value.name]).all()
        else:
            middle = value.share_of(setting[value.name])
            shares = np.array([value.share_of(x) for x in near[value.name]])
            assert (np.abs(shares - middle) <= 0.1 + 1e-12).all()
            assert shares.min() >= -1e-12
            assert shares.max() <= 1 + 1e-12
    assert len(np.unique(near["K_d"])) == 64
    assert setting_at(near, 3)["depth"] == near["depth"][3]
