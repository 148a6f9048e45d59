"""Programs of small systems against the master: types, conversions, orders, free inputs, initialization, failures."""

import platform
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, Type, build
from orchestration import Connection, SimulationError, System, simulate
from orchestration.containers.c.program import c_sources
from orchestration.containers.plan import plan_of
from tests.reference.containers.program import Program, RefusedError
from tests.unit.orchestration.small_models import LAST_TICK, H, chain, mixed, system

STEPS = 16
FREE = pytest.mark.filterwarnings("ignore:Unconnected inputs")


def assert_equal_rows(tested: System, folder: Path, algorithm: str = "gauss-seidel") -> None:
    expected = simulate(tested, algorithm=algorithm)
    program = Program.of(tested, folder, algorithm)
    program.initialize()
    rows = program.rows([1] * (len(expected.time) - 1))
    assert program.names == expected.names
    assert rows.tobytes() == np.ascontiguousarray(expected.rows).tobytes()
    assert program.shown().tobytes() == expected.rows[-1].tobytes()


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_all_types_and_a_feedback(small: dict[str, Path], tmp_path: Path, algorithm: str) -> None:
    assert_equal_rows(mixed(small), tmp_path, algorithm)


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_initial_values_pass_a_chain_against_the_order(small: dict[str, Path], tmp_path: Path, algorithm: str) -> None:
    forwards = chain(small, 5, steps=STEPS)
    backwards = forwards.ordered(list(reversed([*forwards])))
    assert_equal_rows(backwards, tmp_path, algorithm)


@pytest.mark.parametrize(("factor", "offset"), [(0.1, 0.3), (1.0, -1 / 3), (-3.0, 0.0), (1e-3, 273.15)])
def test_conversions_round_as_in_the_master(
    small: dict[str, Path], tmp_path: Path, factor: float, offset: float
) -> None:
    open_ = system(small, {"source": "Source", "plant": "Integrator", "relay": "Relay"}, steps=STEPS)
    links = [
        Connection("source", "u", "plant", "u", factor=factor, offset=offset),
        Connection("plant", "y", "relay", "u", factor=1 / factor, offset=offset / 7),
        Connection("source", "n", "relay", "n"),
        Connection("source", "even", "relay", "even"),
    ]
    assert_equal_rows(open_.connect(*links).set({"plant.through": 1 / 3}), tmp_path)


def test_two_components_of_one_fmu_are_two_states(small: dict[str, Path], tmp_path: Path) -> None:
    two = system(
        small,
        {"left": "Integrator", "source": "Source", "right": "Integrator"},
        "source.u -> right.u\nright.x -> left.u",
    )
    assert_equal_rows(two.set({"left.x_start": 2.0, "right.through": 0.5}), tmp_path)


def test_a_component_may_drive_itself(small: dict[str, Path], tmp_path: Path) -> None:
    assert_equal_rows(
        system(small, {"plant": "Integrator"}, "plant.x -> plant.u").set({"plant.x_start": 1.0}), tmp_path
    )


def test_a_period_may_be_several_steps(small: dict[str, Path], tmp_path: Path) -> None:
    slow = mixed(small).set({"source.sample_time": 4 * H, "switch.sample_time": 2 * H})
    assert_equal_rows(slow, tmp_path)


def test_names_that_c_does_not_allow(small: dict[str, Path], tmp_path: Path) -> None:
    names = {"for": "Integrator", "an arm": "Source", "an-arm": "Integrator", "run": "Integrator", '*/"\\': "Source"}
    odd = system(small, names, 'an arm.u -> for.u\nfor.x -> run.u\n*/"\\.u -> an-arm.u')
    assert_equal_rows(replace(odd, name='two "arms" */ \\'), tmp_path)


def test_names_of_macros(small: dict[str, Path], tmp_path: Path) -> None:
    names = {"DBL_DIG": "Source", "FLT_RADIX": "Integrator", "INT32_MAX": "Source"}
    assert_equal_rows(system(small, names, "DBL_DIG.u -> FLT_RADIX.u"), tmp_path)


@FREE
def test_free_inputs_are_inputs_of_the_program(small: dict[str, Path], tmp_path: Path) -> None:
    free = system(small, {"plant": "Integrator", "relay": "Relay"}, "plant.y -> relay.u").set({"plant.through": 1.0})
    expected = simulate(free, changes={0.5: {"plant.u": 2.5, "relay.n": 7, "relay.even": True}})
    program = Program.of(free, tmp_path)
    assert {name for name in program.index if name not in program.names} >= {"plant.u", "relay.n", "relay.even"}
    program.initialize()
    first = program.rows([1] * 4)
    program.set({"plant.u": 2.5, "relay.n": 7, "relay.even": 1})
    assert np.concatenate([first, program.rows([1] * 12)[1:]]).tobytes() == expected.rows.tobytes()


@FREE
def test_get_shows_fresh_outputs_during_initialization(small: dict[str, Path], tmp_path: Path) -> None:
    free = system(small, {"relay": "Relay", "plant": "Integrator"}, "plant.y -> relay.u").set({"plant.through": 1.0})
    program = Program.of(free, tmp_path)
    program.begin()
    assert program["relay.y"] == 0
    program.set({"plant.u": 3.0, "plant.x_start": 1.5, "relay.offset": 0.25})
    assert program["plant.y"] == 4.5
    assert program["relay.y"] == 9.25
    program.finish()
    assert program["relay.y"] == 9.25


def test_a_boolean_is_one_whatever_was_given(small: dict[str, Path], tmp_path: Path) -> None:
    program = Program.of(system(small, {"relay": "Relay"}), tmp_path)
    program.set({"relay.even": -2.0})
    assert program["relay.even"] == 1
    assert np.isnan(program._library.program_get(program._state, 10_000))


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"plant.x": 1.0}, "An output cannot be set; set a parameter or an input."),
        ({"relay.offset": np.nan}, "relay: offset = nan is not finite."),
        ({"relay.offset": -np.inf}, "relay: offset = -inf is not finite."),
        ({"relay.sample_time": -1.0}, "relay: sample_time = -1 must be at least "),
        ({"relay.n": 0.5}, "relay: n = 0.5 is not an Integer."),
        ({"relay.n": 2.0**31}, "relay: n = 2147483648 is not an Integer."),
    ],
)
def test_a_value_that_cannot_be_is_refused_and_changes_nothing(
    small: dict[str, Path], tmp_path: Path, values: Mapping[str, float], sentence: str
) -> None:
    program = Program.of(system(small, {"relay": "Relay", "plant": "Integrator"}), tmp_path)
    before = program.snapshot()
    with pytest.raises(RefusedError) as caught:
        program.set(values)
    assert str(caught.value).startswith(sentence)
    assert program.snapshot().tobytes() == before.tobytes()


def test_a_fixed_parameter_is_refused_after_initialization(small: dict[str, Path], tmp_path: Path) -> None:
    program = Program.of(system(small, {"relay": "Relay"}), tmp_path)
    program.initialize()
    with pytest.raises(
        RefusedError, match=r"relay: offset is a fixed parameter; it can be set until initialization ends\."
    ):
        program.set({"relay.offset": 1.0})


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_free_input_that_is_not_finite_is_refused_before_any_component_steps(
    small: dict[str, Path], tmp_path: Path, value: float
) -> None:
    program = Program.of(system(small, {"source": "Source", "plant": "Integrator"}), tmp_path)
    program.initialize()
    program.set({"plant.u": value})
    before = program.snapshot()
    with pytest.raises(RefusedError, match=rf"plant: Input u is {value:g}; it must be finite\."):
        program.step(3)
    assert program.snapshot().tobytes() == before.tobytes()
    program.set({"plant.u": 1.0})
    program.step(3)
    assert program["source.n"] == 2


def test_calls_in_a_wrong_order_are_refused(small: dict[str, Path], tmp_path: Path) -> None:
    program = Program.of(system(small, {"source": "Source"}), tmp_path)
    with pytest.raises(RefusedError, match="cannot step before its initialization"):
        program.step()
    with pytest.raises(RefusedError, match="was not reset"):
        program.finish()
    program.initialize()
    with pytest.raises(RefusedError, match="was not reset"):
        program.initialize()
    program.reset()
    with pytest.raises(RefusedError, match=r"The start time is not finite\."):
        program.initialize(np.nan)


@pytest.mark.parametrize("period", [1.5 * H, H / 2, 1e300])
def test_a_period_that_no_longer_fits_the_step_is_refused(
    small: dict[str, Path], tmp_path: Path, period: float
) -> None:
    program = Program.of(mixed(small), tmp_path)
    program.set({"relay.sample_time": period})
    with pytest.raises(RefusedError) as caught:
        program.initialize()
    assert str(caught.value) == f"relay: sample_time = {period:.17g} s is not a multiple of the step {H} s."


def test_an_integer_that_is_none_is_not_converted(small: dict[str, Path], tmp_path: Path) -> None:
    """C does not say what its conversion to 32 bits would give."""
    model = SampledModel("Huge", "Shows a number", sample_time=H)
    model.output(
        "n", model.parameter("p", 3e9, description="A number"), type=Type.INTEGER, description="p", scalar=True
    )
    fmus = {**small, "Huge": build(model, tmp_path)}
    program = Program.of(system(fmus, {"relay": "Relay", "huge": "Huge"}, "huge.n -> relay.n"), tmp_path)
    with pytest.raises(RefusedError, match=r"huge: Output n is 3000000000"):
        program.initialize()
    assert not np.isin([-(2.0**31), 3e9 - 2.0**32], program.snapshot()).any()


@pytest.mark.skipif(shutil.which("gcc") is None or platform.machine() != "x86_64", reason="there is no gcc for x86-64")
def test_a_compiler_may_not_contract_links_and_times(small: dict[str, Path], tmp_path: Path) -> None:
    """GCC rounds a product and a sum once if it may, and does so unless it is told otherwise."""
    linked = system(small, {"source": "Source", "plant": "Integrator"}).connect(
        Connection("source", "u", "plant", "u", factor=0.1, offset=0.3)
    )
    for name, text in c_sources(plan_of(linked)).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    command = ["gcc", "-std=gnu11", "-O2", "-mfma", "-S", "step.c", "-o", "-"]
    found = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert "mulsd" in found
    assert "vfm" not in found


def failure_of_program(tested: System, folder: Path, steps: int) -> str:
    program = Program.of(tested, folder)
    try:
        program.initialize()
        program.step(steps)
    except RefusedError as refused:
        return str(refused)
    return "nothing failed"


def failure_of_master(tested: System, **given: Any) -> tuple[str, str]:
    """Name of the component, and the FMU's last message."""
    with pytest.raises(SimulationError) as caught:
        simulate(tested, **given)
    name, _, rest = str(caught.value).partition(": ")
    return name, rest.rpartition('message: "')[2].partition('"')[0]


def test_a_component_that_fails_says_what_the_fmu_says(small: dict[str, Path], tmp_path: Path) -> None:
    tested = system(small, {"source": "Source", "box": "Fragile"}, steps=LAST_TICK + 10)
    name, sentence = failure_of_master(tested)
    assert failure_of_program(tested, tmp_path, LAST_TICK + 10) == f"{name}: {sentence}"
    assert sentence.startswith("k must stay small (value -0.5")


def test_a_conversion_that_overflows_is_refused_as_by_the_fmu(small: dict[str, Path], tmp_path: Path) -> None:
    two = system(small, {"source": "Source", "plant": "Integrator"})
    tested = two.connect(
        Connection("source", "u", "plant", "u", factor=5e307, offset=-1.5e308)
    )  # 0, then 4 times 5e307
    name, sentence = failure_of_master(tested)
    assert (
        failure_of_program(tested, tmp_path, STEPS)
        == f"{name}: {sentence}"
        == "plant: Input u is inf; it must be finite."
    )


@pytest.mark.filterwarnings("ignore::orchestration.DifferentWallsWarning")  # one of the walls is wrong on purpose
@pytest.mark.parametrize(
    "values",
    [
        {"plant.wall_normal": [-1.0, 0.5]},
        {"controller.K": 1e8},
        {"plant.q_start": [0.5, 0.0]},
        {"sensor.noise_std": 1.0},
    ],
)
def test_failures_of_the_paper_loop_are_those_of_the_fmus(fig2: System, tmp_path: Path, values: dict[str, Any]) -> None:
    tested = fig2.set(values)
    name, sentence = failure_of_master(tested)
    assert failure_of_program(tested, tmp_path, 20_000) == f"{name}: {sentence}"


def test_a_failed_program_can_be_read_but_not_stepped(small: dict[str, Path], tmp_path: Path) -> None:
    program = Program.of(system(small, {"box": "Fragile"}), tmp_path)
    program.initialize()
    with pytest.raises(RefusedError, match="k must stay small"):
        program.step(LAST_TICK + 2)
    assert program["box.k"] == LAST_TICK + 1
    for _ in range(2):
        with pytest.raises(RefusedError, match="or after a failure"):
            program.step()
    with pytest.raises(RefusedError, match="must be reset"):
        program.set({"box.sample_time": H})
    program.reset()
    program.initialize()
    program.step(3)
