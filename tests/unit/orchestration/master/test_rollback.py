"""A rollback leaves no trace: steps that are made, taken back and made again give the same bits."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, Result, System, simulate
from orchestration.master.algorithm import (
    FIXED_POINT,
    NEWTON,
    PARALLEL,
    SEQUENTIAL,
    Algorithm,
    Correction,
    StepControl,
    Tolerance,
)
from orchestration.master.options import Crossings
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.runs import SAMPLE_TIME, paper
from tests.unit.orchestration.small_models import mixed

STEPS = 200
LOOSE = Tolerance(1e30)  # accepts every step
Make = Callable[[str], tuple[System, float, float]]
PLAIN = {SEQUENTIAL: "gauss-seidel", PARALLEL: "jacobi"}


@pytest.fixture
def made(fmu_folder: Path, small: dict[str, Path]) -> Make:
    """Return a function that makes a system, its stop time, s, and its step, s, which is a power of two."""

    def make(name: str) -> tuple[System, float, float]:
        if name == "mixed":
            return mixed(small), 2.0, 0.125
        if name in PROBLEMS:
            step = 2.0**-11
            return PROBLEMS[name].system(step, 0.125), 0.125, step
        return paper(fmu_folder, name), STEPS * SAMPLE_TIME, SAMPLE_TIME

    return make


def assert_same(a: Result, b: Result) -> None:
    """Require the same times and rows, bit by bit, and outputs that move."""
    assert a.names == b.names
    assert a.time.tobytes() == b.time.tobytes()
    assert a.rows.tobytes() == b.rows.tobytes()
    assert (a.rows[0] != a.rows[-1]).sum() >= 2


ALL = [*PROBLEMS, "mixed", "fig2", "fig5"]


@pytest.mark.parametrize("method", [FIXED_POINT, NEWTON])
@pytest.mark.parametrize("exchange", [SEQUENTIAL, PARALLEL])
@pytest.mark.parametrize("name", ALL)
def test_one_sweep_is_the_plain_algorithm(made: Make, name: str, exchange: str, method: str) -> None:
    system, stop, step = made(name)
    once = Algorithm("once", exchange, correction=Correction(method, sweeps=1))
    assert_same(simulate(system, stop, step, once), simulate(system, stop, step, PLAIN[exchange]))


@pytest.mark.parametrize("exchange", [SEQUENTIAL, PARALLEL])
@pytest.mark.parametrize("name", ALL)
def test_watching_a_crossing_that_never_comes_changes_nothing(made: Make, name: str, exchange: str) -> None:
    system, stop, step = made(name)
    plain = simulate(system, stop, step, PLAIN[exchange])
    one_sign = (plain.rows > 0).all(axis=0) | (plain.rows < 0).all(axis=0)
    real = np.array([c.rpartition(".")[2] not in ("n", "m", "even", "odd") for c in plain.names])
    watched = Options(crossings=Crossings([plain.names[i] for i in np.flatnonzero(one_sign & real)]))
    assert watched.crossings.outputs
    assert_same(simulate(system, stop, step, PLAIN[exchange], options=watched), plain)


@pytest.mark.parametrize("sweeps", [2, 5])
@pytest.mark.parametrize("name", ["mixed", "fig2", "fig5"])
def test_repeating_a_step_with_the_same_inputs_repeats_it(made: Make, name: str, sweeps: int) -> None:
    """The only continuous component has inputs from sampled components before it, so every sweep repeats the first."""
    system, stop, step = made(name)
    assert [c.name for c in system.components if c.continuous] == ["plant"]
    again = Algorithm("again", correction=Correction(sweeps=sweeps))
    assert_same(simulate(system, stop, step, again), simulate(system, stop, step))


@pytest.mark.parametrize("correction", [None, Correction(sweeps=3), Correction()], ids=["none", "swept", "iterative"])
@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("exchange", [SEQUENTIAL, PARALLEL])
@pytest.mark.parametrize("name", ["force-displacement", "quarter car", "mixed", "fig5"])
def test_a_controlled_step_is_its_two_halves(
    made: Make, name: str, exchange: str, order: int, correction: Correction | None
) -> None:
    """The whole step that is made for the error estimate, and taken back, leaves no trace.

    Newton's method is left out, because one run takes its Jacobian from the whole step, and the other run
    from an earlier half.
    """
    system, stop, step = made(name)
    halves = Algorithm("halves", exchange, order, correction)
    control = StepControl(LOOSE, first=step, largest=step)
    controlled = simulate(system, stop, step, replace(halves, control=control))
    fine = simulate(system, stop, step / 2, halves)
    assert controlled.time.tobytes() == fine.time[::2].tobytes()
    assert controlled.rows.tobytes() == fine.rows[::2].tobytes()


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("name", ["force-displacement", "displacement-displacement", "feedthrough"])
def test_a_rejected_step_leaves_no_trace(made: Make, name: str, order: int) -> None:
    """A run whose first step is rejected goes on like a run that begins with the smaller step found then."""
    system, stop, step = made(name)

    def run(first: float) -> Result:
        control = StepControl(Tolerance(1e-4 if order == 0 else 1e-7), first=first, largest=stop)
        return simulate(system, stop, step, Algorithm("adaptive", order=order, control=control))

    rejecting = run(stop / 4)
    found = rejecting.time[1]
    assert found < stop / 4
    following = run(float(found))
    assert int(rejecting.metadata["steps_rejected"]) > int(following.metadata["steps_rejected"])
    assert_same(rejecting, following)
