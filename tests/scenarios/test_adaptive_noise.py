"""The sensor's noise in a closed loop: it belongs to (seed, tick), whatever the communication step."""

from functools import cache

import numpy as np
import pytest

from orchestration import Options, Result, simulate
from tests.scenarios.adaptive import system

TS = 2e-5  # s
# Sub-steps of the plant: TS / 2, so that both communication steps lead to one grid and every bit agrees.
FINE = {"plant.dt_max": TS / 2}


@cache
def noisy(name: str, seed: int, step: float) -> Result:
    """A run into the first half of the contact."""
    given = system(name, FINE | {"sensor.seed": seed})
    return simulate(given, stop_time=1.0, step=step, options=Options(strict=True))


def noise(result: Result) -> np.ndarray:
    """F_hat - F_ext at the ticks, N, shape (n, 2); F_ext of the tick's instant."""
    ratio = result.steps_per_tick["sensor"]
    F_hat = np.column_stack([result.at_ticks(f"sensor.F_hat[{i}]") for i in (1, 2)])
    return F_hat - result["plant.F_ext"][:-1:ratio]


@pytest.mark.parametrize("name", ["fig5-first", "fig7-first"])
def test_half_the_step_gives_the_same_columns(name: str) -> None:
    whole, half = noisy(name, 1, TS), noisy(name, 1, TS / 2)
    for column in whole.names:
        if column.startswith("plant."):
            assert half[column][::2].tobytes() == whole[column].tobytes(), column
        else:
            assert half.at_ticks(column).tobytes() == whole.at_ticks(column).tobytes(), column
            held = half[column][1:]  # both halves of a period show the tick's value
            assert held[::2].tobytes() == held[1::2].tobytes(), column
    seen = noise(whole)
    acting = seen.any(axis=1)
    # 0.1 s of contact is some 4000 ticks with noise of which none repeats.
    assert acting.sum() > 2000
    assert len(np.unique(seen[acting], axis=0)) == acting.sum()
    np.testing.assert_array_equal(seen[~(np.abs(whole["plant.F_ext"][:-1]) > 0).any(axis=1)], 0)


def test_a_noise_period_gives_the_noise_a_bandwidth() -> None:
    """Held for three ticks, the draws are those of the white noise of the same seed, in their order."""
    systems = (system("fig7-first", {"sensor.contact_gated": 0.0, "sensor.noise_period": n * TS}) for n in (0, 3))
    white, held = (simulate(given, stop_time=0.03, options=Options(strict=True)) for given in systems)
    expected = np.repeat(noise(white), 3, axis=0)[: len(noise(held))]
    np.testing.assert_array_equal(noise(held), expected)
    assert len(np.unique(noise(white), axis=0)) == len(noise(white))


def test_the_same_seed_repeats_and_another_does_not() -> None:
    first = noisy("fig7-first", 1, TS)
    again = noisy.__wrapped__("fig7-first", 1, TS)
    assert again.rows.tobytes() == first.rows.tobytes()
    other = noisy("fig7-first", 2, TS)
    a, b = noise(first), noise(other)
    both = a.any(axis=1) & b.any(axis=1)
    assert both.sum() > 2000
    assert (a[both] != b[both]).all()
    # Independent draws of n pairs: the correlation is below 5 / sqrt(n), five standard deviations.
    correlation = np.corrcoef(a[both, 0], b[both, 0])[0, 1]
    assert abs(correlation) <= 5 / np.sqrt(both.sum())
    touch = int(np.flatnonzero(a.any(axis=1))[0])
    np.testing.assert_array_equal(first.rows[:touch], other.rows[:touch])  # until then no noise, no difference
    assert first["controller.tau_cmd[1]"].tobytes() != other["controller.tau_cmd[1]"].tobytes()
