"""Evidence for ForceSensor: NumPy draws the same noise; it is bounded, gated, and a function of seed and tick."""

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

from fmus.sensor_reading import truncated_normal
from orchestration.fmi.codes import Status
from tests.driver import Driver
from tests.property.samples import EPS, evaluate

Open = Callable[..., Driver]
TS = 1e-3  # s
STD, BOUND = 5.0, 15.0  # N
FORCE = np.array([300.0, -40.0])  # N
NOISY = {
    "noise_std": STD,
    "noise_bound": BOUND,
    "seed": 7,
    "sample_time": TS,
    "F_ext[1]": FORCE[0],
    "F_ext[2]": FORCE[1],
}
# The force, 300 N, is added and taken off again: two roundings of it; r and the angle round to far less.
ROUNDING = 4 * EPS * 300


def drawn(seed: int, ticks: range, std: float = STD, bound: float = BOUND) -> np.ndarray:
    """The noise of the sensor, drawn with `numpy.random.Philox`, N, shape (len(ticks), 2)."""
    rows = []
    for n in ticks:
        words = np.random.Philox(key=seed, counter=(n - 1) % 2**256).random_raw(2)
        u0, u1 = ((int(word) >> 11) * 2.0**-53 + 2.0**-54 for word in words)
        r = std * np.sqrt(-2 * np.log1p(u0 * np.expm1(-((bound / std) ** 2) / 2)))
        rows.append([r * np.cos(2 * np.pi * u1), r * np.sin(2 * np.pi * u1)])
    return np.array(rows)


def errors(sensor: Driver, steps: int, h: float, first: int = 0) -> np.ndarray:
    """F_hat - F_ext after each of `steps` steps of h."""
    rows = []
    for k in range(first, first + steps):
        sensor.step(k * h, h)
        rows.append(sensor.get("F_hat[1]", "F_hat[2]") - sensor.get("F_ext[1]", "F_ext[2]"))
    return np.array(rows)


@pytest.mark.parametrize("seed", [0, 7, 2**31 - 1])
def test_noise_is_numpy_s_philox(open_fmu: Open, seed: int) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY | {"seed": seed})
    shown = sensor.get("F_hat[1]", "F_hat[2]") - FORCE
    np.testing.assert_allclose(shown, drawn(seed, range(1))[0], rtol=0, atol=ROUNDING)  # what the first tick gives
    np.testing.assert_allclose(errors(sensor, 500, TS), drawn(seed, range(500)), rtol=0, atol=ROUNDING)


def test_noise_keeps_its_bound_and_fills_the_disc(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY | {"noise_std": 8.0})
    noise = errors(sensor, 20_000, TS)
    norms = np.linalg.norm(noise, axis=1)
    assert norms.max() <= BOUND + ROUNDING
    # P(r <= x) = (1 - exp(-x^2 / 2 s^2)) / (1 - exp(-b^2 / 2 s^2)); Kolmogorov-Smirnov at 1e-6: 2.7 / sqrt(20000).
    order = np.sort(norms)
    law = -np.expm1(-(order**2) / 128) / -np.expm1(-(BOUND**2) / 128)
    assert np.abs(law - np.arange(1, 20_001) / 20_000).max() < 2.7 / np.sqrt(20_000)
    # Means of 20000 independent values below 15 N: five standard errors of 7 N / sqrt(20000).
    assert np.abs(noise.mean(axis=0)).max() < 5 * 7 / np.sqrt(20_000)
    assert abs(np.corrcoef(noise[:-1, 0], noise[1:, 0])[0, 1]) < 5 / np.sqrt(20_000)
    assert abs(np.corrcoef(noise.T)[0, 1]) < 5 / np.sqrt(20_000)


def test_truncated_normal_at_the_ends_of_the_unit_interval() -> None:
    # ((w >> 11) + 0.5) 2^-53 rounds to 1 for the largest w.
    u0, u1 = ca.SX.sym("u0"), ca.SX.sym("u1")
    function = ca.Function("noise", [u0, u1], [truncated_normal(u0, u1, ca.SX(STD), ca.SX(BOUND))])
    values = evaluate(function, np.array([[2.0**-54, 1.0]]), np.array([[0.25, 0.25]]))[..., 0]
    smallest = STD * np.sqrt(2.0**-53 * -np.expm1(-4.5))
    # Near the bound, 1 - u0 (1 - e) = e = exp(-4.5) loses EPS / e relative, r then EPS / (9 e) of 15 N.
    np.testing.assert_allclose(np.linalg.norm(values, axis=1), [smallest, BOUND], rtol=0, atol=BOUND * 100 * EPS)


@pytest.mark.parametrize("ratio", [1e4, 1e8, 1e12, 1e100])
def test_noise_far_wider_than_its_bound_is_uniform_on_the_disc(ratio: float) -> None:
    u0, u1 = ca.SX.sym("u0"), ca.SX.sym("u1")
    function = ca.Function("noise", [u0, u1], [truncated_normal(u0, u1, ca.SX(ratio * BOUND), ca.SX(BOUND))])
    draws = np.random.default_rng(5).random((1000, 2))
    values = evaluate(function, draws[None, :, 0], draws[None, :, 1])[..., 0]
    radius, angle = BOUND * np.sqrt(draws[:, 0]), 2 * np.pi * draws[:, 1]
    # With z = (bound / std)^2 / 2 the radius is that of the uniform disc times 1 + (u0 - 1) z / 4 + O(z^2), and each of
    # a dozen operations rounds once.
    error = BOUND * (1 / (8 * ratio**2) + 12 * EPS)
    np.testing.assert_allclose(values, np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), atol=error)
    # The angle of a vector of the largest norm rounds its elements.
    assert np.linalg.norm(values, axis=1).max() <= BOUND * (1 + 2 * EPS)


@pytest.mark.parametrize("std", [1e-3, 0.1, 3.0, 40.0])
def test_noise_has_the_radius_of_the_textbook(std: float) -> None:
    u0, u1 = ca.SX.sym("u0"), ca.SX.sym("u1")
    function = ca.Function("noise", [u0, u1], [truncated_normal(u0, u1, ca.SX(std), ca.SX(BOUND))])
    draws = np.random.default_rng(6).random((1000, 2))
    drawn = np.linalg.norm(evaluate(function, draws[None, :, 0], draws[None, :, 1])[..., 0], axis=1)
    # Longdouble has 11 bits more; the radius loses digits where 1 - u0 (1 - exp(...)) is small, and there
    # log1p loses as many: EPS / (1 - u0) relative.
    u, z = np.longdouble(draws[:, 0]), np.longdouble(BOUND / std) ** 2 / 2
    exact = std * np.sqrt(-2 * np.log1p(u * np.expm1(-z)))
    np.testing.assert_allclose(drawn, exact.astype(float), rtol=8 * EPS * (1 + 1 / (1 - draws[:, 0]).min()))


def test_half_steps_hold_the_noise_of_the_tick(open_fmu: Open) -> None:
    whole, halves = open_fmu("ForceSensor"), open_fmu("ForceSensor")
    whole.initialize(NOISY)
    halves.initialize(NOISY)
    expected = errors(whole, 60, TS)
    np.testing.assert_array_equal(errors(halves, 120, TS / 2), np.repeat(expected, 2, axis=0))


def test_triple_steps_end_on_the_noise_of_their_last_tick(open_fmu: Open) -> None:
    whole, triple = open_fmu("ForceSensor"), open_fmu("ForceSensor")
    whole.initialize(NOISY)
    triple.initialize(NOISY)
    np.testing.assert_array_equal(errors(triple, 20, 3 * TS), errors(whole, 60, TS)[2::3])


def test_a_rolled_back_sensor_repeats_its_noise(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY)
    errors(sensor, 10, TS)
    saved = sensor.instance.save()
    first = errors(sensor, 20, TS, first=10)
    sensor.instance.restore(saved)
    np.testing.assert_array_equal(errors(sensor, 20, TS, first=10), first)
    assert len(np.unique(first, axis=0)) == 20


@pytest.mark.parametrize("ticks", [1, 3, 10])
def test_a_held_draw_serves_the_ticks_of_its_period(open_fmu: Open, ticks: int) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY | {"noise_period": ticks * TS})
    shown = sensor.get("F_hat[1]", "F_hat[2]") - FORCE
    np.testing.assert_allclose(shown, drawn(7, range(1))[0], rtol=0, atol=ROUNDING)
    expected = np.repeat(drawn(7, range(20)), ticks, axis=0)
    np.testing.assert_allclose(errors(sensor, 20 * ticks, TS), expected, rtol=0, atol=ROUNDING)


def test_a_held_draw_survives_steps_of_any_length_and_a_rollback(open_fmu: Open) -> None:
    held = NOISY | {"noise_period": 4 * TS}
    whole, halves, triple = (open_fmu("ForceSensor") for _ in range(3))
    for sensor in (whole, halves, triple):
        sensor.initialize(held)
    expected = errors(whole, 60, TS)
    assert len(np.unique(expected, axis=0)) == 15
    np.testing.assert_array_equal(errors(halves, 120, TS / 2), np.repeat(expected, 2, axis=0))
    errors(triple, 2, 3 * TS)  # to tick 6, in the midst of a draw
    saved = triple.instance.save()
    for _ in range(2):
        np.testing.assert_array_equal(errors(triple, 18, 3 * TS, first=2), expected[8::3])
        triple.instance.restore(saved)


def test_a_period_longer_than_the_run_gives_one_draw(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY | {"noise_period": 1e300 * TS})
    assert len(np.unique(errors(sensor, 50, TS), axis=0)) == 1


@pytest.mark.parametrize("ticks", [0.4, 1e-6])
def test_a_period_shorter_than_a_tick_gives_each_tick_a_draw(open_fmu: Open, ticks: float) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY | {"noise_period": ticks * TS})
    held = errors(sensor, 50, TS)
    sensor.instance.reset()
    sensor.initialize(NOISY | {"noise_period": 0.0})
    np.testing.assert_array_equal(held, errors(sensor, 50, TS))


@pytest.mark.parametrize("ticks", [1.001, 1.5, 2.5])
def test_a_period_between_ticks_is_an_error(open_fmu: Open, ticks: float) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.set({"sample_time": TS, "noise_period": ticks * TS})
    sensor.enter()
    assert sensor.instance.status("fmi2ExitInitializationMode") == Status.ERROR
    said = "noise_period must be a whole multiple of sample_time, or shorter than one"
    assert any(said in text for text in sensor.messages)


def test_a_period_is_a_multiple_within_rounding(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    # 6e-5 / 1e-5 = 6.000000000000001.
    sensor.initialize(NOISY | {"sample_time": 1e-5, "noise_period": 6e-5})
    np.testing.assert_allclose(errors(sensor, 60, 1e-5), np.repeat(drawn(7, range(10)), 6, axis=0), atol=ROUNDING)


@pytest.mark.parametrize(("gated", "noisy"), [(True, False), (False, True)])
def test_gating_silences_the_sensor_only_while_no_force_acts(open_fmu: Open, gated: bool, noisy: bool) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize(NOISY | {"F_ext[1]": 0.0, "F_ext[2]": 0.0, "contact_gated": gated})
    free = errors(sensor, 5, TS)
    assert (free != 0).all() == noisy
    assert (free == 0).all() == (not noisy)
    sensor.set({"F_ext[2]": 1e-12})
    # Ticks went on while the sensor was silent.
    np.testing.assert_allclose(errors(sensor, 5, TS, first=5), drawn(7, range(5, 10)), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("bound", [0.0, 3.0])
def test_without_noise_it_shows_the_force(open_fmu: Open, bound: float) -> None:
    start = {"contact_gated": False, "noise_bound": bound, "F_ext[1]": FORCE[0], "F_ext[2]": FORCE[1]}
    sensor = open_fmu("ForceSensor")
    sensor.initialize(start)
    assert (errors(sensor, 3, 1e-4) == 0).all()


def test_noise_without_a_bound_is_an_error(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.set({"noise_std": 1.0})
    sensor.enter()
    assert sensor.instance.status("fmi2ExitInitializationMode") == Status.ERROR
    assert any("noise_bound must be positive" in text for text in sensor.messages)
