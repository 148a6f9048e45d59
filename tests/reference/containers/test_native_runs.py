"""Runs of a native library have the bits of `simulate`: what is recorded, what is reduced, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from orchestration import Options, OrchestrationError, System, scenario, simulate
from orchestration.containers.native.program import NativeProgram
from orchestration.paper.scenarios import SCENARIOS, VARIANTS
from orchestration.results.measures.reduction import reduced
from tests.reference.containers.native_runs import reductions_of, require_same_bits

FORCE, ERROR, CONTACT = "norm(plant.F_ext)", "norm(controller.e)", "norm(plant.F_ext) > 0"
OF_NUMBERS = ("max", "min", "mean", "rms", "integral", "initial", "final", "time_of_max", "time_of_min")
OF_CONDITIONS = ("duration", "share", "first_time", "last_time")
FORMULAS = (
    *(f"{kind}({value})" for kind in OF_NUMBERS for value in (FORCE, ERROR)),
    *(f"{kind}({value}, where={CONTACT})" for kind in OF_NUMBERS for value in (FORCE, ERROR)),
    *(f"{kind}({CONTACT})" for kind in OF_CONDITIONS),
    *(f"{kind}({CONTACT}, where={where})" for kind in OF_CONDITIONS for where in ("time >= 0.9", f"since({CONTACT})")),
    f"max({ERROR}, where=before({CONTACT}))",
    "final(controller.p_hat[2])",
    "min(plant.gap)",
    "mean(plant.K_f)",
    "max(controller.K[1], where=time > 100)",
    "share(actuator.saturated[1] == 1)",
)
VARIED = ("plant.K_f", "plant.q_start[1]", "sensor.seed", "sensor.contact_gated")
VALUES = np.array([[1e4, -0.7227342478, 1.0, 1.0], [1e5, -0.7, 2.0, 0.0]])
RECORD = ("plant.x[1]", "controller.e[2]", "plant.K_f", "actuator.saturated[1]", "sensor.F_hat[1]")


def program_of(system: System, order: str = "gauss-seidel", varied: tuple[str, ...] = VARIED) -> NativeProgram:
    reductions = reductions_of(system, *FORMULAS)
    return NativeProgram.of(system, order, varied=varied, reductions=reductions, record=RECORD)


@pytest.mark.parametrize("order", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("name", [*SCENARIOS, *VARIANTS])
def test_reductions_and_rows_have_the_bits_of_the_master(name: str, order: str) -> None:
    program = program_of(scenario(name), order)
    steps = np.full(len(VALUES), program.system.run_step())
    require_same_bits(program, VALUES, steps, 1.2, order)


def test_steps_and_sampling_periods_differ_from_run_to_run() -> None:
    system = scenario("fig7")
    periods = tuple(f"{name}.sample_time" for name in system.sample_times)
    program = program_of(system, varied=periods)
    values = np.array([[1e-4] * 4, [2e-4] * 4, [1e-4, 2e-4, 2e-4, 4e-4], [5e-5] * 4])
    require_same_bits(program, values, np.array([1e-4, 1e-4, 1e-4, 2.5e-5]), 0.9)


def test_a_short_run_has_the_bits_of_the_master() -> None:
    program = program_of(scenario("spong-ortega"))
    require_same_bits(program, VALUES, np.full(2, program.system.run_step()), program.system.run_step())


def test_unvaried_values_of_the_system_are_in_force() -> None:
    system = scenario("fig5-first").set({"controller.K": 3000.0, "plant.m[2]": 1.7})
    program = program_of(system)
    require_same_bits(program, VALUES, np.full(2, 2e-5), 0.7)
    assert program.identity == program_of(scenario("fig5-first")).identity


@pytest.mark.filterwarnings("ignore:Unconnected inputs keep")
def test_an_unconnected_input_can_be_varied() -> None:
    fig2 = scenario("fig2")
    system = System.of({"plant": fig2["plant"]}, "arm alone")
    reductions = reductions_of(system, "max(plant.x[1])", "mean(plant.tau[2])")
    program = NativeProgram.of(system, varied=("plant.tau[2]",), reductions=reductions, record=("plant.q[1]",))
    require_same_bits(program, np.array([[0.0], [3.0]]), np.full(2, 1e-3), 0.3)


def test_a_result_is_that_of_the_master() -> None:
    system = scenario("fig5")
    found = program_of(system).result(VALUES[1], 1e-5, 0.3)
    given: dict[str, float] = dict(zip(VARIED, VALUES[1].tolist(), strict=True))
    expected = simulate(system.set(given), step=1e-5, stop_time=0.3, record=RECORD)
    assert found == replace(expected, metadata={})


def test_a_result_knows_the_sampling_periods_of_its_run() -> None:
    system = scenario("fig2")
    program = NativeProgram.of(system, varied=("sensor.sample_time",), record=("sensor.F_hat[1]", "plant.gap"))
    found = program.result(np.array([4e-4]), 1e-4, 0.1)
    expected = simulate(system.set({"sensor.sample_time": 4e-4}), stop_time=0.1, record=program.record)
    assert found == replace(expected, metadata={})
    assert (found.steps_per_tick["sensor"], found.sample_times["sensor"]) == (4, 4e-4)


def test_a_run_may_begin_at_another_time() -> None:
    system = scenario("fig2")
    reductions = reductions_of(system, "first_time(norm(plant.F_ext) > 0)", "integral(norm(controller.e))")
    program = NativeProgram.of(system, reductions=reductions, record=("plant.x[1]",))
    expected = simulate(system, stop_time=1.2, options=Options(start_time=0.3))
    runs = program.runs(np.empty((1, 0)), np.array([1e-4]), 1.2, 0.3)
    assert runs.reduced[0].tolist() == [reduced(reduction, expected) for reduction in reductions]
    found = program.result(np.empty(0), 1e-4, 1.2, 0.3)
    assert found.time.tobytes() == expected.time.tobytes()
    assert found["plant.x[1]"].tobytes() == expected["plant.x[1]"].tobytes()


SHORT = {f"{name}.sample_time": 2e-5 for name in ("trajectory", "sensor", "controller", "actuator")}
REFUSED = {
    "a value out of range": ({"plant.K_f": -1.0}, 1e-4),
    "not finite": ({"plant.K_f": float("inf")}, 1e-4),
    "not a number": ({"plant.K_f": float("nan")}, 1e-4),
    "no Integer": ({"sensor.seed": 1.5}, 1e-4),
    "values that contradict": ({"sensor.noise_std": 1.0, "sensor.noise_bound": 0.0}, 1e-4),
    "a singular start": ({"plant.q_start[2]": 0.0}, 1e-4),
    "a step that fails": ({"plant.q_start[1]": 1e300, **SHORT}, 2e-5),
    "a period that does not fit": ({"sensor.sample_time": 3.3e-4}, 1e-4),
    "a step that does not fit": ({}, 7e-5),
    "a negative step": ({}, -1e-4),
    "no step": ({}, float("nan")),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_run_that_fails_says_what_the_master_says(name: str) -> None:
    system = scenario("fig7-first").with_sample_time(1e-4)
    given, step = REFUSED[name]
    with pytest.raises(OrchestrationError) as refused:
        simulate(system.set(given), step=step, stop_time=0.8)
    program = NativeProgram.of(system, varied=tuple(given), reductions=reductions_of(system, "max(plant.gap)"))
    good = [1e4 if name == "plant.K_f" else float(system.resolve(name)[1].start or 0) for name in given]
    good = [1e-4 if path.endswith("sample_time") else value for path, value in zip(given, good, strict=True)]
    values = np.array([list(given.values()), good]).reshape(2, len(given))
    runs = program.runs(values, np.array([step, 1e-4]), 0.8)
    assert runs.messages == (str(refused.value), "")
    assert np.isnan(runs.reduced[0]).all()
    assert np.isfinite(runs.reduced[1]).all()
