"""Multirate runs: one step of a slow component takes several communication steps."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, SystemDescriptionError, simulate
from orchestration.master.algorithm import SEQUENTIAL, Algorithm
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.runs import SAMPLE_TIME, paper
from tests.unit.orchestration.small_models import FIRST, H, mixed

SLOW = 5
STEPS = 200


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("names", [("sensor",), ("sensor", "controller"), ("trajectory", "sensor", "controller")])
def test_a_slow_sampled_component_steps_from_tick_to_tick(
    fmu_folder: Path, names: tuple[str, ...], algorithm: str
) -> None:
    """Between ticks a sampled component does nothing, so one step of five gives the same as five steps."""
    system = paper(fmu_folder, "fig5").set({f"{name}.sample_time": SLOW * SAMPLE_TIME for name in names})
    stop = STEPS * SAMPLE_TIME
    fine = simulate(system, stop, SAMPLE_TIME, algorithm)
    slow = simulate(system, stop, SAMPLE_TIME, algorithm, options=Options(ratios=dict.fromkeys(names, SLOW)))
    assert slow.time.tobytes() == fine.time.tobytes()
    if algorithm == "gauss-seidel":
        assert slow.rows.tobytes() == fine.rows.tobytes()
    for name in slow.names:
        np.testing.assert_array_equal(slow[name], fine[name], err_msg=name)
    assert (np.diff(slow["sensor.F_hat[1]"]) != 0).sum() == STEPS // SLOW - 1  # noise, once a tick


def test_outputs_of_a_slow_sampled_component_hold(small: dict[str, Path]) -> None:
    system = mixed(small).set({"source.sample_time": 4 * H})
    result = simulate(system, 2.0, H, options=Options(ratios={"source": 4}))
    np.testing.assert_array_equal(result["source.u"], FIRST + np.concatenate(([0], np.repeat(np.arange(4), 4))))


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi", Algorithm("linear", SEQUENTIAL, 1)])
@pytest.mark.parametrize("slow", ["left", "right"])
def test_a_slow_continuous_component_has_order_one(slow: str, algorithm: str | Algorithm) -> None:
    problem = PROBLEMS["force-displacement"]
    stop, step = problem.span
    options = Options(ratios={slow: 4})
    errors = []
    for level in range(1, 5):
        result = simulate(problem.system(step / 2**level, stop), algorithm=algorithm, options=options)
        exact = problem.exact(result.time[-1:])
        errors.append(max(abs(result[o][-1] - exact[o][0]) for o in exact))
    # As in `test_orders_known`, with delays up to those of steps four times as long: the next term is at most 0.1 4 / 2
    # of the first and halves with the step, which gives log2(1.2 / 1.1) = 0.13 in the first slope.
    assert -np.polyfit(np.arange(4), np.log2(errors), 1)[0] == pytest.approx(1, abs=0.13), errors


def test_a_slow_continuous_component_shows_what_is_past(small: dict[str, Path]) -> None:
    """The output of a slow continuous component changes when the end of its step is reached, not before."""
    result = simulate(mixed(small), 2.0, H, options=Options(ratios={"plant": 4}))
    expected = np.repeat(2.0 ** np.arange(5), 4)[:17]  # x + 4 H 2 x = 2 x
    np.testing.assert_allclose(result["plant.x"], expected, rtol=1e-14)  # Runge-Kutta 4 rounds some 5 times


@pytest.mark.parametrize(
    ("ratios", "message"),
    [
        ({"sensor": 3}, "sensor: steps of 3 communication steps must fit its sample time and the run of 200 equal"),
        ({"plant": 3}, "plant: steps of 3 communication steps must fit its sample time and the run of 200 equal"),
        ({"sensor": 2}, "sensor: steps of 2 communication steps must fit"),  # a tick in between
        ({"sensor": 0}, "sensor: the ratio 0 of its step to the communication step is not a positive integer"),
        ({"sensor": 2.5}, "sensor: the ratio 2.5 of its step to the communication step is not a positive integer"),
        ({"nobody": 2}, "nobody"),
    ],
)
def test_ratios_that_do_not_fit_are_refused(fmu_folder: Path, ratios: dict, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        simulate(paper(fmu_folder, "fig2"), STEPS * SAMPLE_TIME, SAMPLE_TIME, options=Options(ratios=ratios))


@pytest.mark.parametrize("algorithm", ["iterative", "newton", "adaptive"])
def test_ratios_exclude_going_back(small: dict[str, Path], algorithm: str) -> None:
    with pytest.raises(SystemDescriptionError, match="Steps of several lengths do not go together with algorithm"):
        simulate(mixed(small), algorithm=algorithm, options=Options(ratios={"plant": 2}))
