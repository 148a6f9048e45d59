"""A container FMU with FMUs of other tools inside shows what the master shows, and promises only the states it has."""

from dataclasses import replace
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from orchestration import Fmu, System, scenario, simulate
from orchestration.check import check
from orchestration.errors import SignalError, SimulationError
from orchestration.fmi.codes import ONE_INSTANCE, SAVES_STATE, SERIALIZES_STATE
from orchestration.fmi.description import read_description
from tests.interop.foreign.builders import MAPPING, without_compiler
from tests.strangers.contained.fmus import controller, small
from tests.strangers.contained.test_runs import STEP, coupled

pytestmark = [
    pytest.mark.filterwarnings("ignore::orchestration.UnconnectedInputWarning"),
    pytest.mark.filterwarnings("ignore::orchestration.FormalityWarning"),
]


def assert_same_rows(path: Path, system: System, steps: int, every: int = 1) -> None:
    """Our master gets the same bits from the container, stepped by several inner steps at once, and from its parts."""
    step = system.run_step()
    expected = simulate(system, stop_time=steps * step)
    found = simulate(System.of({"c": path}), steps * step, every * step)
    assert [name.removeprefix("c.") for name in found.names] == list(expected.names)
    assert found.rows.tobytes() == expected.rows[::every].tobytes()


@pytest.mark.skipif(without_compiler() is not None, reason=str(without_compiler()))
def test_a_hand_written_controller_in_fig5(tmp_path: Path) -> None:
    """Its angles are degrees and its torques N.mm: the container shows each variable in the unit of its component."""
    system = scenario("fig5").replace("controller", controller(tmp_path), MAPPING)
    path = system.to_fmu(tmp_path / "fig5.fmu")
    assert validate_fmu(str(path)) == []
    assert_same_rows(path, system, 48_000, 1000)
    description = read_description(path)
    for name, variable in system["controller"].description.variables.items():
        if f"controller.{name}" in description.variables:
            assert description.variables[f"controller.{name}"].unit == variable.unit


@pytest.mark.parametrize("every", [1, 5])
def test_two_small_fmus_of_three_components(pair: tuple[Path, Path], tmp_path: Path, every: int) -> None:
    system = coupled(*pair)
    assert_same_rows(system.to_fmu(tmp_path / "three.fmu"), system, 100, every)


def test_a_state_can_be_set_in_its_instance_only(pair: tuple[Path, Path], tmp_path: Path) -> None:
    path = coupled(*pair).to_fmu(tmp_path / "three.fmu")
    description = read_description(path)
    assert description.can(SAVES_STATE)
    assert not description.can(SERIALIZES_STATE)
    with Fmu(path) as one, Fmu(path) as other:
        one.step(5 * STEP)
        saved, shown = one.save(), one.outputs()
        assert not isinstance(saved, bytes)
        rows = []
        for _ in range(2):
            one.step(7 * STEP)
            rows.append(one.outputs())
            one.restore(saved)
            assert one.outputs() == shown
        assert rows[0] == rows[1]
        assert rows[0] != shown
        with pytest.raises(SignalError, match="of another FMU, or damaged"):
            other.restore(saved)


def test_without_states_of_all_parts_there_are_none(pair: tuple[Path, Path], tmp_path: Path) -> None:
    system = coupled(pair[0], small(tmp_path, "Forgetful", flags=""))
    path = system.to_fmu(tmp_path / "three.fmu")
    description = read_description(path)
    assert not description.can(SAVES_STATE)
    assert not description.can(SERIALIZES_STATE)
    assert_same_rows(path, system, 50)


def test_a_check_finds_nothing(pair: tuple[Path, Path], tmp_path: Path) -> None:
    report = check(coupled(*pair).to_fmu(tmp_path / "three.fmu"))
    assert [finding.message for finding in report.findings if finding.severity == "error"] == []


def test_one_instance_in_a_process_is_declared(tmp_path: Path) -> None:
    alone = small(tmp_path, "Alone", flags='canBeInstantiatedOnlyOncePerProcess="true"')
    system = replace(System.of({"a": alone, "b": alone}), step=STEP)
    assert read_description(system.to_fmu(tmp_path / "two.fmu")).can(ONE_INSTANCE)


def test_a_failure_names_the_component_and_its_message(pair: tuple[Path, Path], tmp_path: Path) -> None:
    path = replace(System.of({"a": pair[0]}).set({"a.fault": 3}), step=STEP).to_fmu(tmp_path / "one.fmu")
    with pytest.raises(
        SimulationError, match=r"a: fmi2DoStep returned fmi2Error; its last message: \\?\"the tank is 3 %"
    ):
        simulate(System.of({"c": path}), 1.0, STEP)


def test_a_container_is_contained_again(pair: tuple[Path, Path], tmp_path: Path) -> None:
    inner = replace(coupled(*pair), name="inner").to_fmu(tmp_path / "inner.fmu")
    system = replace(System.of({"c": inner, "d": pair[0]}, "outer").connect("c.a.y -> d.u"), step=STEP)
    assert_same_rows(system.to_fmu(tmp_path / "outer.fmu"), system, 50)
