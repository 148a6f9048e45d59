"""Parameters, inputs and locals in the rows of a run: which names choose them, and which values they show."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from orchestration import (
    Algorithm,
    Component,
    Result,
    System,
    SystemDescriptionError,
    prepare,
    simulate,
)
from tests.unit.orchestration.runs import ADAPTIVE, ALGORITHMS
from tests.unit.orchestration.small_models import H, mixed, system

FIXED = {name: algorithm for name, algorithm in ALGORITHMS.items() if algorithm.control is None}
every_fixed = pytest.mark.parametrize("algorithm", FIXED.values(), ids=FIXED.keys())


def test_a_name_chooses_any_causality_and_a_pattern_outputs(fig2: System) -> None:
    made = simulate(fig2, 1e-3, record=["plant.x", "controller.K", "plant.tau[2]", "controller.e*", "plant.x[1]"])
    names = ["plant.x", "controller.K", "controller.e"]
    assert made.names == (
        *("plant.x[1]", "plant.x[2]", "controller.K[1]", "controller.K[2]", "plant.tau[2]"),
        *("controller.e[1]", "controller.e[2]"),
    )
    assert [made.unit(name) for name in (*names, "plant.tau[2]")] == ["m", "N/m", "m", "N.m"]
    np.testing.assert_array_equal(made["controller.K"], 4000.0)


def test_an_output_has_the_same_bits_beside_other_variables(fig2: System) -> None:
    plain = simulate(fig2, 0.02)
    more = simulate(fig2, 0.02, record=["*", "controller.K", "controller.q", "plant.tau", "actuator.tau_cmd"])
    for name in plain:
        assert more[name].tobytes() == plain[name].tobytes()


@every_fixed
def test_an_input_shows_what_its_component_was_given(small: dict[str, Path], algorithm: Algorithm) -> None:
    """Of a sampled component: the value for the step that ends at the row; row 0 that of the initialization."""
    inputs = ["relay.u", "relay.n", "relay.even", "switch.n", "switch.flag", "relay.offset"]
    result = simulate(mixed(small).set({"relay.offset": 1.0}), algorithm=algorithm, record=["*", *inputs])
    np.testing.assert_array_equal(result["relay.offset"], 1.0)
    np.testing.assert_array_equal(2 * result["relay.u"] + 1.0, result["relay.y"])
    np.testing.assert_array_equal(result["relay.n"] + 1, result["relay.m"])
    np.testing.assert_array_equal(1 - result["relay.even"], result["relay.odd"])
    signed = np.where(result["switch.flag"] == 1, result["switch.n"], -result["switch.n"])
    np.testing.assert_array_equal(signed, result["switch.y"])
    assert result["relay.u"][0] == result["plant.x"][0]


def test_in_a_controlled_run_an_input_shows_what_the_second_half_was_given(small: dict[str, Path]) -> None:
    """The tick had the value at the start of the first half; x' = 2 x + 1 is 3 there, so x is 3/16 larger after it."""
    result = simulate(mixed(small).set({"relay.offset": 1.0}), algorithm=ADAPTIVE, record=["relay.y", "relay.u"])
    assert result["relay.y"][1] == 2 * 1.0 + 1.0
    assert result["relay.u"][1] == 1.0 + 3.0 * H / 2


@pytest.mark.parametrize("order", [0, 1])
def test_an_input_that_moves_shows_its_value_at_the_start_of_the_step(small: dict[str, Path], order: int) -> None:
    made = system(small, {"plant": "Integrator"})
    given = {"plant.u": (np.array([0.0, 2.0]), np.array([1.0, 5.0]))}
    result = simulate(made, algorithm=Algorithm("either", order=order), inputs=given, record="plant.u")
    np.testing.assert_array_equal(result["plant.u"], [1.0, *(1.0 + 2.0 * result.time[:-1])])


def test_an_input_is_in_its_own_unit_where_a_connection_scales(small: dict[str, Path]) -> None:
    made = mixed(small)
    scaled = [replace(c, factor=-0.5, offset=0.25) if c.target == "plant" else c for c in made.connections]
    result = simulate(replace(made, connections=tuple(scaled)), record=["relay.y", "plant.u"])
    np.testing.assert_array_equal(result["plant.u"][1:], -0.5 * result["relay.y"][1:] + 0.25)


def test_a_changed_parameter_shows_from_its_step_on(fig2: System) -> None:
    with prepare(fig2, 2e-3, options=None, changes={1e-3: {"controller.K[1]": 1.0}}) as run:
        run.run()
        everything = run.result()
    assert "controller.K[1]" not in everything
    result = simulate(fig2, 2e-3, record="controller.K[1]", changes={1e-3: {"controller.K[1]": 1.0}})
    np.testing.assert_array_equal(result["controller.K[1]"], np.where(np.arange(21) <= 10, 4000.0, 1.0))


def test_inputs_of_a_sampled_component_are_found_at_its_ticks(fig2: System) -> None:
    result = simulate(fig2, 2e-3, record=["controller.q", "plant.q"])
    np.testing.assert_array_equal(result.at_ticks("controller.q"), result.at_ticks("plant.q"))


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_files_and_plots_have_them(fig2: System, tmp_path: Path, suffix: str) -> None:
    result = simulate(fig2, 1e-3, record=["controller.K", "plant.tau", "plant.x"])
    result.write(tmp_path / f"x.{suffix}")
    again = Result.read(tmp_path / f"x.{suffix}")
    assert (again.names, again.rows.tobytes()) == (result.names, result.rows.tobytes())
    assert len(result.plot()) == 3  # a panel for each unit


def test_a_local_variable_is_recorded(tmp_path: Path) -> None:
    model = SampledModel("Local", "Shows its input later", sample_time=H)
    u = model.input("u", 1.0, unit="m", description="A Real")
    model.output("y", 3 * u, unit="m", description="3 u", scalar=True)
    fmu = build(model, tmp_path)
    component = Component.read(fmu, "a")
    hidden = replace(component.description.variables["y"], causality="local")
    description = replace(component.description, variables={**component.description.variables, "y": hidden})
    made = System("s", (replace(component, description=description),), step=H, stop_time=4 * H)
    result = simulate(made, record="a.y", changes={2 * H: {"a.u": 5.0}})
    np.testing.assert_array_equal(result["a.y"], [3.0, 3.0, 3.0, 15.0, 15.0])
    assert result.unit("a.y") == "m"


def test_what_cannot_be_recorded_is_refused(small: dict[str, Path]) -> None:
    made = system(small, {"plant": "Integrator", "source": "Source"}, "source.u -> plant.u")
    with pytest.raises(SystemDescriptionError, match=r"record: no output fits 'plant\.u\*'"):
        simulate(made, record="plant.u*")
    with pytest.raises(SystemDescriptionError, match=r"plant has no variable v"):
        simulate(made, record="plant.v")
