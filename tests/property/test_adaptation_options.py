"""Tests that update_divisor, projection, dead_zone and freeze_when_saturated act on p_hat.

The plain step of p_hat is compared with the paper's formulas in test_adaptation_ticks.py; here it is the
yardstick.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.driver import Driver, Value
from tests.property.samples import EPS
from tests.property.ticks import CONTROLLERS, SHOWN, Sample, answer, elements, run, samples, show

SIZE, TICKS = 4, 8
DRAWN = list(samples(SIZE, TICKS, seed=1991))
# Relative to what p_hat moves in a tick; the worst rounding of such samples in test_adaptation_ticks.py.
RELATIVE = 1e-6


@pytest.fixture(scope="module", params=CONTROLLERS)
def controlled(fmu_folder: Path, request: pytest.FixtureRequest) -> Iterator[tuple[str, Driver]]:
    """A controller's name, and an instance."""
    driver = Driver(fmu_folder / f"{request.param}.fmu")
    yield request.param, driver
    driver.close()


def estimates(controlled: tuple[str, Driver], sample: Sample, **more: Value) -> np.ndarray:
    """P_hat at all ticks, shape (TICKS, 6)."""
    controller, driver = controlled
    return np.array([tick.p_hat for tick in run(driver, controller, sample, **more)])


def steps(controlled: tuple[str, Driver], sample: Sample, **more: Value) -> tuple[np.ndarray, np.ndarray]:
    """Rates dp_hat/dt by the paper's formulas and the filtered errors' norms at all ticks of a run."""
    controller, driver = controlled
    rates, errors = [], []
    for tick in run(driver, controller, sample, **more):
        rates.append(answer(controller, tick, sample.gains).rate)
        errors.append(np.linalg.norm(show(driver, SHOWN[controller])))
    return np.array(rates), np.array(errors)


def require_steps(p_hat: np.ndarray, expected: np.ndarray) -> None:
    """P_hat moves by the expected steps, shape (TICKS - 1, 6), and stays where those are zero."""
    moves = np.diff(p_hat, axis=0)
    np.testing.assert_array_equal(moves[expected == 0], 0)
    tolerance = RELATIVE * np.abs(expected).max(axis=1, keepdims=True) + 8 * EPS * np.abs(p_hat).max()
    assert (np.abs(moves - expected) <= tolerance).all(), (moves, expected)


@pytest.mark.parametrize("divisor", [1, 3])
def test_every_nth_tick_moves_p_hat_by_n_steps(controlled: tuple[str, Driver], divisor: int) -> None:
    for sample in DRAWN:
        p_hat = estimates(controlled, sample, update_divisor=divisor)
        rates, _ = steps(controlled, sample, update_divisor=divisor)
        updates = np.arange(TICKS - 1) % divisor == 0  # at ticks 0, n, 2 n: seen at ticks 1, n + 1, ...
        expected = np.where(updates[:, None], divisor * sample.gains.sample_time * rates[:-1], 0)
        require_steps(p_hat, expected)
        assert np.count_nonzero(expected) >= 5 * updates.sum()


def test_projection_clips_to_the_bounds(controlled: tuple[str, Driver]) -> None:
    clipped = 0
    for sample in DRAWN:
        free = estimates(controlled, sample)
        low, high = (free[0] + share * np.abs(free - free[0]).max(axis=0) for share in (-0.3, 0.2))
        bounds: dict[str, Value] = {**elements("p_min", low), **elements("p_max", high)}
        p_hat = estimates(controlled, sample, **bounds, projection=True)
        rates, _ = steps(controlled, sample, **bounds, projection=True)
        expected = np.clip(p_hat[:-1] + sample.gains.sample_time * rates[:-1], low, high)
        np.testing.assert_allclose(p_hat[1:], expected, rtol=RELATIVE * 0.2 + 8 * EPS)
        # phi_hat = p_start - p_hat rounds: the fixed-inverse variant misses a bound by an ulp.
        assert (p_hat >= low * (1 - 2 * EPS)).all()
        assert (p_hat <= high * (1 + 2 * EPS)).all()
        clipped += np.count_nonzero(np.abs(p_hat - low) <= 2 * EPS * low)
        clipped += np.count_nonzero(np.abs(p_hat - high) <= 2 * EPS * high)
        np.testing.assert_array_equal(estimates(controlled, sample, **bounds), free)  # without projection they are idle
    assert clipped >= 5 * SIZE


def test_dead_zone_holds_p_hat_while_the_error_is_small(controlled: tuple[str, Driver]) -> None:
    held = 0
    for sample in DRAWN:
        errors = steps(controlled, sample)[1]
        zone = float(np.median(errors[:-1]))
        # The errors do not depend on p_hat, so they are those of the run before; a median of seven is one of
        # them.
        zone *= 1 + 1e-9
        p_hat, (rates, _) = estimates(controlled, sample, dead_zone=zone), steps(controlled, sample, dead_zone=zone)
        active = errors[:-1] > zone
        require_steps(p_hat, np.where(active[:, None], sample.gains.sample_time * rates[:-1], 0))
        held += np.count_nonzero(~active)
        assert active.any()
    assert held == 4 * SIZE


@pytest.mark.parametrize("flags", [(True, False), (False, True), (True, True)])
def test_adaptation_freezes_while_an_actuator_is_saturated(
    controlled: tuple[str, Driver], flags: tuple[bool, bool]
) -> None:
    saturated: dict[str, Value] = {f"saturated[{i + 1}]": flag for i, flag in enumerate(flags)}
    for sample in DRAWN:
        free = estimates(controlled, sample)
        assert (free[1:] != free[0]).any()
        frozen = estimates(controlled, sample, freeze_when_saturated=True, **saturated)
        np.testing.assert_array_equal(frozen, np.tile(free[0], (TICKS, 1)))
        np.testing.assert_array_equal(estimates(controlled, sample, **saturated), free)  # off: the flags are not seen
        np.testing.assert_array_equal(estimates(controlled, sample, freeze_when_saturated=True), free)
