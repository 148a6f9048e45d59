"""Gauss-Seidel and Jacobi give exactly the rows that are predicted for chains of counting components.

A source shows 3 + k at tick k. Relay i of a chain shows 2^i times the value that the source showed d
ticks before, where d counts the connections that delay by a step. In Gauss-Seidel in the order of the
signals no connection delays; in Jacobi every connection does. All numbers are integers, so every
comparison is exact.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, SystemDescriptionError, simulate
from tests.unit.orchestration.small_models import FIRST, H, chain, mixed, system

STEPS = 16
LENGTH = 3
FORWARD = ("source", "relay1", "relay2", "relay3")
TICKS = np.maximum(np.arange(STEPS + 1) - 1, 0)  # the tick that a sampled column shows in row k: 0, 0, 1, 2, ...


def expected(result_names: Sequence[str], delays: Sequence[int]) -> np.ndarray:
    """Return the rows of the chain if relay i lags the source by `delays[i - 1]` ticks in all."""
    columns = {}
    for i, delay in enumerate((0, *delays)):
        k = np.maximum(TICKS - delay, 0)
        negated = (k + i) % 2 == 0
        if i == 0:
            columns |= {"source.u": FIRST + k, "source.n": k, "source.even": negated}
        else:
            columns |= {f"relay{i}.y": 2.0**i * (FIRST + k), f"relay{i}.m": k + i, f"relay{i}.odd": negated}
    return np.column_stack([columns[name] for name in result_names]).astype(float)


@pytest.mark.parametrize(
    ("algorithm", "order", "delays"),
    [
        ("gauss-seidel", FORWARD, (0, 0, 0)),
        ("gauss-seidel", ("relay1", "source", "relay2", "relay3"), (1, 1, 1)),
        ("gauss-seidel", ("source", "relay2", "relay1", "relay3"), (0, 1, 1)),
        ("gauss-seidel", FORWARD[::-1], (1, 2, 3)),
        ("jacobi", FORWARD, (1, 2, 3)),
        ("jacobi", FORWARD[::-1], (1, 2, 3)),
    ],
)
def test_delay_is_one_step_per_connection_against_the_order(
    small: dict[str, Path], algorithm: str, order: tuple[str, ...], delays: tuple[int, ...]
) -> None:
    result = simulate(chain(small, LENGTH, steps=STEPS), algorithm=algorithm, order=order)
    np.testing.assert_array_equal(result.rows, expected(result.names, delays))


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_order_argument_equals_a_reordered_system(small: dict[str, Path], algorithm: str) -> None:
    forward = mixed(small)
    order = ("plant", "switch", "relay", "source")
    argument = simulate(forward, algorithm=algorithm, order=order)
    reordered = simulate(forward.ordered(order), algorithm=algorithm)
    assert argument.names == reordered.names
    assert argument.rows.tobytes() == reordered.rows.tobytes()


def test_jacobi_ignores_the_order(small: dict[str, Path]) -> None:
    forward = simulate(mixed(small), algorithm="jacobi")
    backward = simulate(mixed(small), algorithm="jacobi", order=("plant", "switch", "relay", "source"))
    for name in forward.names:
        np.testing.assert_array_equal(forward[name], backward[name])


def test_signs_follow_the_boolean(small: dict[str, Path]) -> None:
    result = simulate(mixed(small, steps=STEPS))
    # relay: m = n + 1, odd = not even; switch: m where n is odd, else -m
    signed = np.where(TICKS % 2 == 1, TICKS + 1, -(TICKS + 1))
    np.testing.assert_array_equal(result["switch.y"], signed)


def test_row_shows_a_plant_at_its_end_and_a_sampled_component_at_its_start(small: dict[str, Path]) -> None:
    held = system(small, {"source": "Source", "plant": "Integrator"}, "source.u -> plant.u", steps=STEPS)
    result = simulate(held)
    np.testing.assert_array_equal(result.time, np.arange(STEPS + 1) * H)
    np.testing.assert_array_equal(result["source.u"], FIRST + TICKS)
    # x(t_k) = H (u_0 + ... + u_(k-1)). RK4 sums H/6 (u + 2u + 2u + u), which is off by at most an ulp in each step.
    integral = H * np.concatenate(([0.0], np.cumsum(FIRST + np.arange(STEPS))))
    np.testing.assert_allclose(result["plant.x"], integral, rtol=STEPS * np.finfo(float).eps, atol=0)


def test_time_comes_from_the_index(small: dict[str, Path]) -> None:
    result = simulate(chain(small, 1).with_sample_time(0.1), 3.0)
    assert result.time.tolist() == [k * 0.1 for k in range(31)]  # a sum of 0.1 would miss most of these times


@pytest.mark.parametrize("ratio", [1, 2, 5])
def test_at_ticks_realigns(small: dict[str, Path], ratio: int) -> None:
    held = system(small, {"source": "Source", "plant": "Integrator"}, "source.u -> plant.u")
    result = simulate(held.set({"source.sample_time": ratio * H}), stop_time=20 * H)
    assert result.steps_per_tick == {"source": ratio}
    n_ticks = -(-20 // ratio)
    np.testing.assert_array_equal(result.at_ticks("source.u"), FIRST + np.arange(n_ticks))
    np.testing.assert_array_equal(result.tick_times("source.u"), np.arange(n_ticks) * ratio * H)
    np.testing.assert_array_equal(result.at_ticks("plant.x"), result["plant.x"][:-1])
    np.testing.assert_array_equal(result.tick_times("plant.x"), result.time[:-1])


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_given_times_equal_a_step(small: dict[str, Path], algorithm: str) -> None:
    by_step = simulate(mixed(small, steps=STEPS), algorithm=algorithm)
    by_times = simulate(mixed(small), algorithm=algorithm, times=np.arange(STEPS + 1) * H)
    assert by_times.time.tobytes() == by_step.time.tobytes()
    assert by_times.rows.tobytes() == by_step.rows.tobytes()


def test_times_need_not_be_uniform(small: dict[str, Path]) -> None:
    plant = system(small, {"plant": "Integrator"}).set({"plant.u": 2.0})
    times = np.array([1.0, 1.125, 1.625, 1.75, 3.0])
    with pytest.warns(UserWarning, match=r"plant\.u"):
        result = simulate(plant, times=times)
    np.testing.assert_array_equal(result.time, times)
    np.testing.assert_allclose(result["plant.x"], 2 * (times - 1), rtol=1e-14, atol=0)  # 24 sub-steps of an ulp


def test_start_time_moves_the_rows(small: dict[str, Path]) -> None:
    moved = simulate(chain(small, 1), 5.0, options=Options(start_time=4.0))
    plain = simulate(chain(small, 1), 1.0)
    np.testing.assert_array_equal(moved.time, 4.0 + plain.time)
    np.testing.assert_array_equal(moved.rows, plain.rows)


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([0.0], "at least two"),
        ([0.0, H, H], "increasing"),
        ([0.0, np.inf], "finite"),
        ([[0.0, H]], "at least two"),
        ([0.0, H, 3 * H], r"sample time 0\.125 s is not a multiple of the step 0\.25 s"),
    ],
)
def test_unfit_times_are_refused(small: dict[str, Path], times: list, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        simulate(chain(small, 1), times=np.array(times))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"step": 0.05, "stop_time": 1.0},
            r"source: sample time 0\.125 s is not a multiple of the step 0\.05 s",
        ),
        (
            {"step": 0.25},
            r"source: sample time 0\.125 s is not a multiple of the step 0\.25 s; use a step of 0\.125",
        ),
        ({"step": 0.0}, "The step is 0 s; it must be positive"),
        ({"step": -H}, "The step is -0.125 s; it must be positive"),
        ({"step": np.nan}, "The step is nan; give a finite number, in s"),
        ({"stop_time": 0.3}, r"from 0 s to 0\.3 s is not a multiple of the step 0\.125 s; stop at 0\.25 s"),
        ({"stop_time": 0.0}, r"The stop time 0 s is not after the start time 0 s; give a later"),
        ({"stop_time": -1.0}, r"The stop time -1 s is not after the start time 0 s"),
        ({"stop_time": np.inf}, r"The stop time is inf; give a finite number, in s"),
        ({"algorithm": "leapfrog"}, r"no algorithm 'leapfrog'; there are gauss-seidel, jacobi"),
        ({"order": ["source"]}, r"order source must name each of source, relay1 once"),
        ({"order": ["source", "source"]}, r"order source, source must name each"),
        (
            {"order": ["source", "relay1", "x"]},
            r"order source, relay1, x: there is no component x; there are",
        ),
    ],
)
def test_impossible_requests_are_refused(small: dict[str, Path], arguments: dict, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        simulate(chain(small, 1), **arguments)


def test_a_larger_step_runs_on_stale_inputs_when_asked(small: dict[str, Path]) -> None:
    result = simulate(chain(small, 1), 1.0, 2 * H, options=Options(allow_stale_inputs=True))
    assert result.steps_per_tick == {}
    # Each step holds two ticks, and a row shows the last of the two: 1, 3, 5, 7.
    np.testing.assert_array_equal(result["source.n"], [0, 1, 3, 5, 7])


def test_whole_multiples_survive_rounding(small: dict[str, Path]) -> None:
    tenth = chain(small, 1).with_sample_time(0.1)
    result = simulate(tenth, 0.3)  # 0.3 / 0.1 = 2.9999999999999996
    np.testing.assert_array_equal(result["source.n"], [0, 0, 1, 2])
