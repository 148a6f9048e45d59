"""Runs with step control keep the accepted error, and end exactly at the stop time."""

from dataclasses import replace

import numpy as np
import pytest

from orchestration import SimulationError, simulate
from orchestration.master.algorithm import PARALLEL, Algorithm, Correction, StepControl, Tolerance
from tests.reference.problems import PROBLEMS

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)


def controlled(tolerance: float, order: int = 1, **steps: float) -> Algorithm:
    """Return an algorithm with step control and sequential exchange."""
    return Algorithm("adaptive", order=order, control=StepControl(Tolerance(tolerance), **steps))


@pytest.mark.parametrize("name", ["force-displacement", "displacement-displacement"])
def test_the_error_at_the_end_is_the_tolerance(name: str) -> None:
    """The error at the stop time is half the tolerance, within a factor 2 and over three decades of tolerances.

    The controller aims at 0.9^(2 / 0.7) = 0.74 of the tolerance (or 0.9^(2 / 0.3), where its proportional part is at
    rest). In oscillations the errors of steps partly cancel.
    """
    problem = PROBLEMS[name]
    stop = problem.span[0]
    found = []
    for tolerance in TOLERANCES:
        result = simulate(problem.system(1e-3, stop), algorithm=controlled(tolerance))
        exact = problem.exact(result.time)
        errors = [abs(result[o][-1] - exact[o][-1]) for o in exact if not o.endswith(".F")]
        found.append(max(errors) / tolerance)
        # A second-order error of 30 h^2 (w^2 = 37/s^2, over 1 s) takes sqrt(30 / tolerance) steps, 1700 at 1e-5
        assert len(result.time) < 1700
    assert all(1 / 4 <= ratio <= 1 for ratio in found), found


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", PROBLEMS)
def test_steps_end_on_the_stop_time(name: str, order: int) -> None:
    problem = PROBLEMS[name]
    stop = problem.span[0] / 3  # not a short binary fraction
    result = simulate(problem.system(1e-3, stop), algorithm=controlled(1e-3, order))
    assert result.time[-1] == stop
    assert (np.diff(result.time) > 0).all()
    assert np.ptp(np.diff(result.time)) > 0


@pytest.mark.parametrize("method", [Correction(), Correction("newton")], ids=["iterative", "newton"])
def test_corrected_steps_are_controlled_too(method: Correction) -> None:
    problem = PROBLEMS["force-displacement"]
    stop = problem.span[0]
    algorithm = replace(controlled(1e-4), exchange=PARALLEL, correction=method)
    result = simulate(problem.system(1e-3, stop), algorithm=algorithm)
    exact = problem.exact(result.time)
    for output in exact:
        assert abs(result[output][-1] - exact[output][-1]) <= 1e-4 * (1 + abs(exact[output][-1]))


def test_a_step_below_the_smallest_names_the_output() -> None:
    problem = PROBLEMS["quarter car"]
    with pytest.raises(
        SimulationError, match=r"(body|wheel)\.\w at t = 0 s .*steps below the smallest, 0\.01 s"
    ) as error:
        simulate(problem.system(1e-2, 0.5), algorithm=controlled(1e-9, smallest=1e-2))
    assert error.value.result is not None
    assert len(error.value.result.time) == 1


def test_steps_stay_within_the_largest() -> None:
    problem = PROBLEMS["force-displacement"]
    result = simulate(problem.system(1e-3, 1.0), algorithm=controlled(1.0, largest=0.03))
    # Steps of 0.03 s reach 0.99 s after 33 steps. The last two steps share the rest.
    assert np.diff(result.time).max() <= 0.03 * (1 + 1e-12)
    assert len(result.time) <= 40
