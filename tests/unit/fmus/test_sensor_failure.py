"""Evidence for FailingForceSensor: it is ForceSensor but in a failure, which begins and ends at its ticks."""

from collections.abc import Callable

import numpy as np
import pytest

from fmus.sensor_failure import DROPOUT, NONE, SPIKE, STUCK
from tests.driver import Driver, RefusedError
from tests.variant_files import file_of

Open = Callable[..., Driver]
TS = 1e-3  # s
STEPS = 20
NOISY = {"noise_std": 5.0, "noise_bound": 15.0, "seed": 7, "sample_time": TS, "contact_gated": False, "bias[2]": 1.5}
FIRST, LAST = 5, 11  # ticks: the failure starts with the first, and is over at the last
FAILURE = {"failure_start": FIRST * TS, "failure_duration": (LAST - FIRST) * TS}
PUSH = np.array([40.0, -7.0])  # N


def force(tick: int) -> np.ndarray:
    """Force at the tip at a tick, N, shape (2,)."""
    return np.array([100.0 + tick, -3.0 * tick])


def readings(sensor: Driver, start: dict[str, float]) -> np.ndarray:
    """F_hat of the ticks 0 to `STEPS` - 1, N, shape (STEPS, 2), under a force that moves."""
    sensor.initialize(NOISY | start | dict(zip(("F_ext[1]", "F_ext[2]"), force(0), strict=True)))
    rows = []
    for k in range(STEPS):
        sensor.set(dict(zip(("F_ext[1]", "F_ext[2]"), force(k), strict=True)))
        sensor.step(k * TS, TS)
        rows.append(sensor.get("F_hat[1]", "F_hat[2]"))
    return np.array(rows)


@pytest.fixture
def healthy(open_fmu: Open) -> np.ndarray:
    """What ForceSensor reads."""
    return readings(open_fmu("ForceSensor"), {})


def failing(open_fmu: Open, start: dict[str, float]) -> np.ndarray:
    """What FailingForceSensor reads."""
    return readings(open_fmu(file_of("FailingForceSensor")), start)


@pytest.mark.parametrize(
    "start",
    [
        {},
        FAILURE,
        {"failure": SPIKE, "failure_force[1]": 1e3, "failure_start": 0.004},
        {"failure": STUCK, "failure_start": 1e3, "failure_duration": 1.0},
    ],
)
def test_without_a_failure_it_is_the_force_sensor(open_fmu: Open, healthy: np.ndarray, start: dict[str, float]) -> None:
    np.testing.assert_array_equal(failing(open_fmu, start), healthy)


def test_a_dropout_reads_zero(open_fmu: Open, healthy: np.ndarray) -> None:
    expected = healthy.copy()
    expected[FIRST:LAST] = 0
    np.testing.assert_array_equal(failing(open_fmu, {**FAILURE, "failure": DROPOUT}), expected)


def test_a_stuck_sensor_holds_its_last_reading(open_fmu: Open, healthy: np.ndarray) -> None:
    expected = healthy.copy()
    expected[FIRST:LAST] = healthy[FIRST - 1]
    np.testing.assert_array_equal(failing(open_fmu, {**FAILURE, "failure": STUCK}), expected)


def test_a_sensor_that_sticks_at_once_holds_the_force_of_the_start(open_fmu: Open) -> None:
    stuck = {"failure": STUCK, "failure_start": 0.0, "failure_duration": 1.0}
    np.testing.assert_array_equal(failing(open_fmu, stuck), np.tile(force(0), (STEPS, 1)))


def test_a_spike_adds_its_force_within_the_range(open_fmu: Open, healthy: np.ndarray) -> None:
    spike = {**FAILURE, "failure": SPIKE, "failure_force[1]": PUSH[0], "failure_force[2]": PUSH[1], "range": 130.0}
    expected = healthy.copy()
    expected[FIRST:LAST] += PUSH
    # The force is added before another sum is rounded: a few units in the last place of 150 N.
    np.testing.assert_allclose(failing(open_fmu, spike), np.clip(expected, -130, 130), rtol=0, atol=1e-13)


def test_it_tells_that_it_fails(open_fmu: Open) -> None:
    sensor = open_fmu(file_of("FailingForceSensor"))
    sensor.initialize(NOISY | FAILURE | {"failure": DROPOUT})
    told = []
    for k in range(STEPS):
        sensor.step(k * TS, TS)
        told.append(sensor.get("failed")[0])
    np.testing.assert_array_equal(np.flatnonzero(told), np.arange(FIRST, LAST))


def test_a_rolled_back_sensor_keeps_the_reading_that_it_holds(open_fmu: Open) -> None:
    sensor = open_fmu(file_of("FailingForceSensor"))
    sensor.initialize(NOISY | FAILURE | {"failure": STUCK, "F_ext[1]": 50.0})
    for k in range(FIRST + 1):
        sensor.step(k * TS, TS)
    held, saved = sensor.get("F_hat[1]", "F_hat[2]"), sensor.instance.save()
    for _ in range(2):
        sensor.set({"F_ext[1]": 70.0})
        sensor.step((FIRST + 1) * TS, TS)
        np.testing.assert_array_equal(sensor.get("F_hat[1]", "F_hat[2]"), held)
        sensor.instance.restore(saved)


@pytest.mark.parametrize("kind", [NONE - 1, SPIKE + 1])
def test_an_unknown_kind_is_refused(open_fmu: Open, kind: int) -> None:
    sensor = open_fmu(file_of("FailingForceSensor"))
    with pytest.raises(RefusedError, match=r"failure = .* must be from 0 to 3"):
        sensor.initialize(NOISY | {"failure": kind})
