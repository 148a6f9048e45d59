"""Step control with sampled components, and with components that refuse a step."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import SimulationError, System, simulate
from orchestration.master.algorithm import Algorithm, StepControl, Tolerance
from orchestration.master.kernel.codes import Column
from orchestration.master.simulate import prepare
from orchestration.master.simulation import Simulation
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.runs import ADAPTIVE, SAMPLE_TIME, paper
from tests.unit.orchestration.small_models import FIRST, H, mixed

STEPS = 64
DISCARD = 2
DO_STEP_TYPE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int)


@contextmanager
def discarding(simulation: Simulation, component: int, longest: float, status: int = DISCARD) -> Iterator[list[float]]:
    """Make a component of a run refuse steps longer than `longest`, s; yield the list of the refused steps, s."""
    table, refused = simulation._assembly.plan.table, []
    genuine = DO_STEP_TYPE(int(table[component, Column.DO_STEP]))

    def do_step(instance: int, t: float, h: float, keep: int) -> int:
        if h > longest:
            refused.append(h)
            return status
        return genuine(instance, t, h, keep)

    stand_in = DO_STEP_TYPE(do_step)
    operations = simulation._flat.operations
    steps = (operations.subject == component) & (operations.call == Column.DO_STEP)
    address = ctypes.cast(stand_in, ctypes.c_void_p).value
    table[component, Column.DO_STEP] = operations.function[steps] = address
    yield refused


@pytest.fixture
def pair() -> System:
    """Return a system of two continuous components."""
    return PROBLEMS["force-displacement"].system(H / 8, 1.0)


def test_every_tick_is_a_point(fmu_folder: Path) -> None:
    """In Fig. 2 in contact, sampled components get the same inputs as with Gauss-Seidel, whose steps are the ticks."""
    system = paper(fmu_folder, "fig2")
    stop = STEPS * SAMPLE_TIME
    tight = Algorithm("tight", order=1, control=StepControl(Tolerance(1e-9), first=SAMPLE_TIME / 8))
    result = simulate(system, stop, SAMPLE_TIME, tight)
    ticks = SAMPLE_TIME * np.arange(STEPS + 1)
    assert np.isin(ticks, result.time).all()
    assert len(result.time) > STEPS + 1
    fixed = simulate(system, stop, SAMPLE_TIME)
    for name in ("trajectory.x_v[1]", "sensor.F_hat[1]", "controller.tau_cmd[1]"):
        np.testing.assert_array_equal(result.tick_times(name), ticks[:-1])
        # The plant makes other sub-steps here. In contact, w = sqrt(1e5 N/m / 1 kg) = 316 rad/s. Runge-Kutta 4 with
        # sub-steps of 1.2e-4 s errs by (w h)^5 / 120 = 6e-10 of the state in each of 64 steps; 1 m is 1e5 N.
        np.testing.assert_allclose(result.at_ticks(name), fixed.at_ticks(name), rtol=1e-5, atol=1e-3)


def test_ticks_within_controlled_steps_are_counted_once(small: dict[str, Path]) -> None:
    control = StepControl(Tolerance(1e-3), first=H / 16, largest=H / 3)
    result = simulate(mixed(small), 2.0, H, Algorithm("adaptive", control=control))
    np.testing.assert_array_equal(result.at_ticks("source.u"), FIRST + np.arange(16))
    np.testing.assert_array_equal(result.tick_times("source.u"), H * np.arange(16))
    assert len(result.time) > 3 * 16
    # x' is held between ticks, so x(t + H) = (1 + 2 H) x(t) whatever the steps are.
    x = result["plant.x"][np.isin(result.time, H * np.arange(17))]
    np.testing.assert_allclose(x, 1.25 ** np.arange(17), rtol=1e-13)  # some 5 roundings in each of 64 steps


@pytest.mark.parametrize("component", [0, 1])
def test_a_discarded_step_is_made_smaller(pair: System, component: int) -> None:
    longest = 0.004
    with prepare(pair, algorithm=ADAPTIVE) as simulation, discarding(simulation, component, longest) as refused:
        simulation.run()
        result = simulation.result()
    assert len(refused) >= 1
    assert min(refused) > longest
    assert int(result.metadata["steps_rejected"]) >= len(refused)
    assert result.time[-1] == 1.0
    # A step is made as a whole and in two halves. The whole step is refused, too.
    assert np.diff(result.time).max() <= longest
    exact = PROBLEMS["force-displacement"].exact(result.time)
    assert all(abs(result[o][-1] - exact[o][-1]) <= 1e-3 * (1 + abs(exact[o][-1])) for o in exact)


def test_a_discarded_step_leaves_no_trace(pair: System) -> None:
    """After a discarded step, a run is the same as one that begins with the smaller step."""
    begun = replace(ADAPTIVE, control=StepControl(Tolerance(1e-2), first=0.03, largest=0.03))
    with prepare(pair, algorithm=begun) as simulation, discarding(simulation, 1, 0.029) as refused:
        simulation.run(None)
        result = simulation.result()
    assert len(refused) >= 1
    smaller = float(result.time[1])
    again = replace(begun, control=StepControl(Tolerance(1e-2), first=smaller, largest=0.03))
    with prepare(pair, algorithm=again) as simulation, discarding(simulation, 1, 0.029) as refused_again:
        simulation.run()
        expected = simulation.result()
    assert len(refused_again) == len(refused) - 1
    assert result.time.tobytes() == expected.time.tobytes()
    assert result.rows.tobytes() == expected.rows.tobytes()


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi", "iterative", "newton", Algorithm("linear", order=1)])
def test_a_discarded_step_is_an_error_where_steps_are_fixed(pair: System, algorithm: str | Algorithm) -> None:
    with prepare(pair, algorithm=algorithm) as simulation, discarding(simulation, 1, H / 16):
        with pytest.raises(SimulationError, match=r"right: fmi2DoStep returned fmi2Discard at t = 0 s") as caught:
            simulation.run()
    assert caught.value.result is not None
    assert len(caught.value.result.time) == 1


def test_a_component_that_always_discards_ends_in_an_error(pair: System) -> None:
    with prepare(pair, algorithm=ADAPTIVE) as simulation, discarding(simulation, 0, 0.0) as refused:
        with pytest.raises(SimulationError, match="steps below the smallest"):
            simulation.run()
    assert len(refused) < 20  # H / 8 to a millionth of it, a fifth at a time: 9


def test_an_error_of_a_component_is_not_a_discard(pair: System) -> None:
    with prepare(pair, algorithm=ADAPTIVE) as simulation, discarding(simulation, 0, 0.0, status=3) as refused:
        with pytest.raises(SimulationError, match=r"left: fmi2DoStep returned fmi2Error at t = 0 s"):
            simulation.run()
    assert len(refused) == 1
