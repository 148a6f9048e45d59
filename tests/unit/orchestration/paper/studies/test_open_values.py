"""The space of the open values: ranges with the chosen values inside, filled evenly, the same points everywhere."""

import hashlib

import numpy as np
import pytest

from orchestration.paper.numbers import GAMMA_EPS, K_D, PSI, WALL_OFFSET
from orchestration.paper.scenarios import SCENARIOS
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
    assert value.low <= value.chosen <= value.high
    if value.choices:
        assert value.chosen in value.choices
    else:
        assert value.at(np.array(value.share_of(value.chosen))) == pytest.approx(value.chosen, rel=1e-14)
    assert value.low <= EARLIER[value.name] <= value.high
    assert value.reason
    assert value.claims


def test_chosen_values_are_those_of_the_scenarios() -> None:
    given = SCENARIOS["fig5"].values
    assert CHOSEN["Psi_1"] == given["controller.Psi[1]"].number == PSI
    assert CHOSEN["gamma_eps"] == given["controller.gamma_eps"].number == GAMMA_EPS
    assert CHOSEN["wall_offset"] == given["plant.wall_offset"].number == WALL_OFFSET
    assert CHOSEN["K_d"] == SCENARIOS["fig7"].values["controller.K_d[1]"].number == K_D
    assert CHOSEN["sample_time"] == SCENARIOS["fig5"].step
    assert CHOSEN["noise_hold"] == CHOSEN["sample_time"], "the noise of the scenarios is drawn at every tick"
    bound, std = (given[f"sensor.noise_{name}"].number for name in ("bound", "std"))
    assert CHOSEN["noise_ratio"] == pytest.approx(bound / std, rel=1e-15)


def test_every_range_is_filled_evenly() -> None:
    points = settings(256)
    for value in OPEN_VALUES:
        if value.choices:
            for choice in set(value.choices):
                expected = 256 * value.choices.count(choice) // len(value.choices)
                assert (points[value.name] == choice).sum() == expected
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
    assert hashlib.sha256(" ".join(rounded).encode()).hexdigest()[:16] == "ed5229cf00a39799"


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
