"""Evidence that Figs. 2 to 4 run: strict, without a warning, on numbers whose origin is written down."""

import math
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, Result, System, simulate
from orchestration.paper.scenarios import SCENARIOS, Scenario

NAMES = ("fig2", "fig3", "fig4")
ORDER = ("trajectory", "sensor", "controller", "actuator", "plant")
STATED = {  # section V
    "plant.m[1]": 2.0,
    "plant.m[2]": 1.0,
    "plant.l[1]": 1.0,
    "plant.l[2]": 1.0,
    "plant.K_f": 1e5,
    "trajectory.semi_axis[1]": 1.5,
    "trajectory.semi_axis[2]": 1.0,
    "trajectory.period": 2.0,
    "controller.M[1]": 2.0,
    "controller.M[2]": 2.0,
    "controller.K[1]": 4000.0,
    "controller.K[2]": 4000.0,
    "controller.B[1]": 2 * math.sqrt(2 * 4000),
    "controller.B[2]": 2 * math.sqrt(2 * 4000),
    "controller.p_start[1]": 2.0,
}


@pytest.fixture(scope="module")
def systems(fmu_folder: Path) -> dict[str, System]:
    """The systems by the names of their figures."""
    chosen = [SCENARIOS[name] for name in NAMES]
    return {
        s.name: s.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in s.models.values()})
        for s in chosen
    }


@pytest.fixture(scope="module")
def results(systems: dict[str, System]) -> dict[str, Result]:
    """Their runs; an unconnected input is an error, and so is any warning."""
    return {name: simulate(system, options=Options(strict=True)) for name, system in systems.items()}


@pytest.mark.parametrize("name", NAMES)
def test_run_is_complete(results: dict[str, Result], systems: dict[str, System], name: str) -> None:
    result, system = results[name], systems[name]
    assert tuple(c.name for c in system.components) == ORDER
    assert system.notices == ()
    assert system.unconnected_inputs() == []
    assert result.time[0] == 0.0
    assert result.time[-1] == pytest.approx(2.0, abs=np.spacing(2.0))  # one product of an integer and the step
    assert len(result.time) == round(2.0 / system.run_step()) + 1
    assert np.isfinite(result.rows).all()
    assert set(result.steps_per_tick.values()) == {1}


@pytest.mark.parametrize("name", NAMES)
def test_stated_numbers_are_the_paper_s(systems: dict[str, System], name: str) -> None:
    stated = {**STATED, "controller.p_start[2]": 2.5 if name == "fig4" else 1.0}
    for path, number in stated.items():
        component, variable = path.split(".")
        assert systems[name].component(component).start[variable] == number, path


@pytest.mark.parametrize("scenario", SCENARIOS.values(), ids=SCENARIOS.keys())
def test_every_assumed_number_has_its_reason(scenario: Scenario) -> None:
    assert any(value.assumed for value in scenario.values.values())
    for path, value in scenario.values.items():
        if value.assumed:
            reason = value.origin.removeprefix("assumed: ")
            assert reason != value.origin, path
            assert len(reason.split()) >= 3, path
        else:
            assert value.origin == "V" or value.origin.startswith(("V: ", "(")), path  # section or equation


@pytest.mark.parametrize("name", NAMES)
def test_numbers_reach_the_system(systems: dict[str, System], name: str) -> None:
    for path, value in SCENARIOS[name].values.items():
        component, variable = path.split(".")
        assert systems[name].component(component).start[variable] == value.number


def test_figs_2_and_3_are_one_run_and_fig_4_another(results: dict[str, Result]) -> None:
    assert results["fig2"].rows.tobytes() == results["fig3"].rows.tobytes()
    assert (results["fig2"].rows != results["fig4"].rows).any()
    for name in ("trajectory.x_v[1]", "trajectory.x_v[2]"):  # V: only m2_hat differs
        np.testing.assert_array_equal(results["fig2"][name], results["fig4"][name])


def test_a_second_run_gives_the_same_bits(results: dict[str, Result], systems: dict[str, System]) -> None:
    assert simulate(systems["fig4"]).rows.tobytes() == results["fig4"].rows.tobytes()
