"""The order of the error of coupled components that a time series drives, against exact solutions.

Two integrators in a row: a' = u(t), b' = a, with u from a series. With u = t the exact solution is a = t^2/2 and
b = t^3/6. A step that holds u and a errs by the first order. A step that follows the series and extrapolates a errs by
the second order: u is exact, and the straight line for a misses a parabola. A jump of u on a communication point
stays a jump, so the order stays.
"""

import numpy as np
import pytest

from orchestration import Algorithm, System, TimeSeries, simulate
from orchestration.master.algorithm import PARALLEL, SEQUENTIAL
from tests.sharing import made_once
from tests.unit.orchestration.small_models import H, build_small_models, system

STOP = 2.0
JUMP = 0.5  # s, a communication point at all levels
LEVELS = 5
FIRST = [Algorithm("sequential 0", SEQUENTIAL), Algorithm("parallel 0", PARALLEL)]
SECOND = [Algorithm("sequential 1", SEQUENTIAL, 1), Algorithm("parallel 1", PARALLEL, 1)]
RAMP = TimeSeries(np.array([0.0, STOP]), np.array([0.0, STOP]), "linear")
STEP = TimeSeries(np.array([0.0, JUMP, STOP]), np.array([0.0, 1.0, 1.0]), "held")
# The error is c h^p (1 + d h / T) with d below 3 in these sums over T / h = 16 or more steps, so the slope of the
# logarithm over four halvings is off by less than log2(1 + 3 / 16) / 4 = 0.06.
SLOPE = 0.06


@pytest.fixture(scope="module")
def row(tmp_path_factory: pytest.TempPathFactory) -> System:
    """Return two integrators in a row."""
    small = {path.stem: path for path in made_once(tmp_path_factory, "small", build_small_models).glob("*.fmu")}
    return system(small, {"a": "Integrator", "b": "Integrator"}, "a.x -> b.u")


def errors_of(row: System, algorithm: Algorithm, given: TimeSeries, exact: tuple[float, float]) -> list[float]:
    """Return the larger error of a and b at the stop time, at each level."""
    runs = [simulate(row, STOP, H / 2**level, algorithm, inputs={"a.u": given}) for level in range(LEVELS)]
    return [max(abs(float(run[name][-1]) - x) for name, x in zip(("a.x", "b.x"), exact, strict=True)) for run in runs]


def order_of(errors: list[float]) -> float:
    """Return the slope of the logarithm of the errors."""
    return -float(np.polyfit(np.arange(LEVELS), np.log2(errors), 1)[0])


@pytest.mark.parametrize("algorithm", FIRST, ids=lambda a: a.name)
def test_held_steps_have_the_first_order(row: System, algorithm: Algorithm) -> None:
    errors = errors_of(row, algorithm, RAMP, (STOP**2 / 2, STOP**3 / 6))
    assert abs(order_of(errors) - 1) <= SLOPE, errors


@pytest.mark.parametrize("algorithm", SECOND, ids=lambda a: a.name)
def test_steps_along_the_series_have_the_second_order(row: System, algorithm: Algorithm) -> None:
    errors = errors_of(row, algorithm, RAMP, (STOP**2 / 2, STOP**3 / 6))
    assert abs(order_of(errors) - 2) <= SLOPE, errors
    run = simulate(row, STOP, H, algorithm, inputs={"a.u": RAMP})
    np.testing.assert_allclose(run["a.x"], run.time**2 / 2, rtol=0, atol=1e-14)  # the series itself is exact


def test_a_jump_costs_no_order(row: System) -> None:
    """With a parallel exchange one step after the jump takes the slope of a from before, and errs by h^2 / 2 there."""
    errors = errors_of(row, SECOND[1], STEP, (STOP - JUMP, (STOP - JUMP) ** 2 / 2))
    assert order_of(errors) >= 2 - SLOPE, errors
    run = simulate(row, STOP, H, SECOND[1], inputs={"a.u": STEP})
    np.testing.assert_allclose(run["a.x"], np.maximum(0, run.time - JUMP), rtol=0, atol=1e-14)


def test_a_jump_is_exact_where_the_end_of_the_step_is_known(row: System) -> None:
    """With a sequential exchange the straight line for a leads to the value after the step."""
    run = simulate(row, STOP, H, SECOND[0], inputs={"a.u": STEP})
    behind = np.maximum(0, run.time - JUMP)
    np.testing.assert_allclose(run["a.x"], behind, rtol=0, atol=1e-14)
    np.testing.assert_allclose(run["b.x"], behind**2 / 2, rtol=0, atol=1e-14)


def test_controlled_steps_meet_their_tolerance_with_jumps_and_bends(row: System) -> None:
    times = np.array([0.0, 0.3, 0.31, 1.1, STOP])
    values = np.array([0.0, 1.0, -5.0, 2.0, 2.0])
    run = simulate(row, STOP, H, "adaptive", inputs={"a.u": TimeSeries(times, values, "linear")})
    exact_a = [np.trapezoid(np.interp(grid, times, values), grid) for grid in _grids(run.time, times)]
    np.testing.assert_allclose(run["a.x"], exact_a, rtol=0, atol=1e-13)
    assert set(times) <= set(run.time)


def _grids(ends: np.ndarray, times: np.ndarray) -> list[np.ndarray]:
    """Return for each end the points up to it at which the trapezoidal rule is exact."""
    return [np.append(times[times < end], end) if end > 0 else np.zeros(1) for end in ends]
