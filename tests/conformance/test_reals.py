"""Tests of FMUs with Reals in the place of Booleans and Integers: the same bits, and other numbers are refused."""

import ctypes as ct
import math
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import fmpy
import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, DefinitionError, Limits, Model, SampledModel, Type, build
from adaptimp_fmu.reals import as_reals
from fmus.catalog import MODELS
from orchestration import System
from tests.conformance.binary import ERROR, OK, Binary, Instance, array, require_ok
from tests.conformance.calls import assert_refused
from tests.conformance.scenes import H, run, scene

Load = Callable[[str], Binary]
Create = Callable[..., Instance]
CHANGED = {
    "ForceSensor",
    "CraigAdaptiveImpedance",
    "SlotineLiAdaptiveImpedance",
    "SpongOrtegaAdaptiveImpedance",
    "Actuator",
    "Actuator3R",
}


def described(path: Path) -> list[dict[str, object]]:
    """Attributes of the variables, without types and what only a Real or only a Boolean has."""
    rows = fmpy.read_model_description(str(path)).modelVariables
    keys = ("name", "valueReference", "causality", "variability", "initial", "unit", "description")
    return [{key: getattr(row, key) for key in keys} for row in rows]


def test_an_fmu_without_booleans_and_integers_is_the_same_file(fmu_folder: Path, reals_folder: Path) -> None:
    same = {name for name in MODELS if _bytes(fmu_folder, name) == _bytes(reals_folder, name)}
    assert same == set(MODELS) - CHANGED


def _bytes(folder: Path, name: str) -> bytes:
    return (folder / f"{name}.fmu").read_bytes()


@pytest.mark.parametrize("name", sorted(CHANGED))
def test_only_types_guid_and_description_differ(name: str, fmu_folder: Path, reals_folder: Path) -> None:
    usual, reals = (fmpy.read_model_description(str(folder / f"{name}.fmu")) for folder in (fmu_folder, reals_folder))
    assert {v.type for v in reals.modelVariables} == {"Real"} != {v.type for v in usual.modelVariables}
    assert described(fmu_folder / f"{name}.fmu") == described(reals_folder / f"{name}.fmu")
    assert reals.guid != usual.guid
    assert reals.modelName == usual.modelName == name
    assert str(reals.description).startswith(f"{usual.description}. Booleans are Reals of 0 and 1")
    for old, new in zip(usual.modelVariables, reals.modelVariables, strict=True):
        start = {"true": "1", "false": "0"}.get(str(old.start), old.start)
        assert new.start == start, new.name
        assert (new.min, new.max) == (("0", "1") if old.type == "Boolean" else (old.min, old.max)), new.name
        stands_for = {"Boolean": "BooleanAsReal", "Integer": "IntegerAsReal"}.get(old.type)
        assert stands_for in (None, new.declaredType.name if new.declaredType else None)


@pytest.mark.parametrize("name", ["Actuator", "CraigAdaptiveImpedance"])
def test_the_outputs_are_the_same_bits(name: str, load: Load, create: Create) -> None:
    rows = []
    for binary in (load(name), load(f"reals/{name}")):
        rows.append(run(create(binary, start=scene(binary)).initialize(), seed=3))
    assert rows[0].tobytes() == rows[1].tobytes()
    assert len(np.unique(rows[0], axis=0)) > 1


@pytest.mark.parametrize("value", [0.3, 2.0, -1.0, 1 + 2**-52, math.inf, math.nan])
@pytest.mark.parametrize("phase", ["instantiated", "initialization mode"])
def test_a_parameter_that_is_neither_0_nor_1_is_refused_when_set(
    load: Load, create: Create, phase: str, value: float
) -> None:
    instance = create(load("reals/CraigAdaptiveImpedance")).to(phase)
    said = [f"{value:.17g}", "must be 0 or 1"] if math.isfinite(value) else ["is not finite"]
    assert_refused(instance, instance.set({"projection": value}), instance.blob(), "projection = ", *said)
    assert instance.set({"projection": 1.0}) == OK


@pytest.mark.parametrize("value", [2.5, 0.999, 2.0**31])
def test_a_number_that_is_not_whole_is_no_integer(load: Load, create: Create, value: float) -> None:
    instance = create(load("reals/CraigAdaptiveImpedance"))
    said = f"update_divisor = {value:.17g} must be a whole number from 1 to 2147483647."
    assert_refused(instance, instance.set({"update_divisor": value}), instance.blob(), said)
    assert instance.set({"update_divisor": 2.0}) == OK


@pytest.mark.parametrize("value", [0.3, 2.0, -1e-300, 1 - 2**-53])
def test_an_input_that_is_neither_0_nor_1_is_refused_at_the_step(load: Load, create: Create, value: float) -> None:
    """As an input that is NaN: fmi2SetReal takes it, and nothing changes until it is right."""
    instance = create(load("reals/CraigAdaptiveImpedance")).enter()
    said = f"Input saturated[2] is {value:.17g}; it must be 0 or 1."
    require_ok(instance.set({"saturated[2]": value}), instance)
    assert_refused(instance, instance.call("fmi2ExitInitializationMode"), instance.blob(), said)
    require_ok(instance.set({"saturated[2]": 1.0}), instance)
    require_ok(instance.call("fmi2ExitInitializationMode"), instance)
    require_ok(instance.set({"saturated[2]": value}), instance)
    assert_refused(instance, instance.step(H), instance.blob(), said)
    require_ok(instance.set({"saturated[2]": -0.0}), instance)
    assert instance.step(H) == OK


def test_the_fmu_of_a_system_refuses_such_numbers_and_nothing_changes(
    reals_folder: Path, tmp_path: Path, create: Create
) -> None:
    system = System.of({"c": reals_folder / "CraigAdaptiveImpedance.fmu"}).with_sample_time(H)
    instance = create(Binary(system.to_fmu(tmp_path / "one.fmu"), tmp_path / "unpacked")).enter()
    values = {"c.K[1]": 1234.0, "c.projection": 0.3}
    before = instance.blob()
    assert_refused(instance, instance.set(values), before, "c.projection = ", "must be 0 or 1")
    require_ok(instance.call("fmi2ExitInitializationMode"), instance)
    require_ok(instance.set({"c.saturated[2]": 0.3}), instance)
    before = instance.blob()
    said = "Input c.saturated[2] is 0.29999999999999999; it must be 0 or 1."
    assert_refused(instance, instance.step(H), before, said)
    require_ok(instance.set({"c.saturated[2]": 1.0}), instance)
    assert instance.step(H) == OK


def switch(divisor: float = 3) -> SampledModel:
    """Inputs shown as Integer and Boolean, and slow ticks."""
    model = SampledModel("Switch", "Shows its inputs.", sample_time=H)
    u = model.input("u", 1.0, description="Input")
    n = model.input("n", 2, type=Type.INTEGER, description="A number")
    model.output("whole", u + n, type=Type.INTEGER, description="Both", scalar=True)
    model.output("truth", ca.vertcat(u, n), type=Type.BOOLEAN, description="Whether they are not zero")
    x = model.state("x", ca.SX(0.0))
    model.parameter("every", divisor, type=Type.INTEGER, limits=Limits(1), description="Ticks per update")
    model.update_slowly(x, x + 1, divisor="every")
    model.output("x", x, description="Updates", scalar=True)
    return model


@pytest.fixture
def switches(tmp_path: Path, create: Create) -> list[Instance]:
    """That model as it is, and with Reals only, in initialization mode."""
    found = []
    for reals in (False, True):
        folder = tmp_path / str(reals)
        path = build(switch(), folder, cache=tmp_path / "cache", reals=reals)
        found.append(create(Binary(path, folder / "unpacked")).enter())
    return found


@pytest.mark.parametrize("u", [0.0, -0.0, 1.0, -1.0, 7.0, 2.0**31 - 3, 0.5, 1e300, math.nan, math.inf])
def test_outputs_are_what_booleans_and_integers_would_be(switches: list[Instance], u: float) -> None:
    """A value that is no Integer ends both with an error; every other number than 0 means true."""
    seen = []
    for instance in switches:
        instance.set({"u": u})
        ended = instance.call("fmi2ExitInitializationMode")
        stepped = instance.step(H) if ended == OK else None
        seen.append((ended, stepped, instance.outputs().tolist() if stepped == OK else instance.last[:12]))
    assert seen[0] == seen[1]
    assert (seen[0][0] == OK) == (math.isfinite(u) and u == round(u) and abs(u) < 1e9 * 3)


def test_the_error_of_an_output_names_the_value(switches: list[Instance]) -> None:
    instance = switches[1]
    require_ok(instance.set({"u": 0.5}), instance)
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert instance.last == "Output whole is 2.5; it must be a whole number from -2147483648 to 2147483647."


def test_a_real_that_stands_for_a_boolean_has_no_derivative(tmp_path: Path, create: Create) -> None:
    model = ContinuousModel("Valve", "A tank")
    on = model.input("on", 1, type=Type.BOOLEAN, description="Whether it is open")
    level = model.state("level", 0.0)
    model.derivative(level, on)
    model.output("level", level, description="Level", scalar=True)
    path = build(model, tmp_path, cache=tmp_path / "cache", reals=True)
    instance = create(Binary(path, tmp_path / "unpacked")).initialize()
    order, value = array(ct.c_int, [1]), array(ct.c_double, [0.5])
    status = instance.call("fmi2SetRealInputDerivatives", instance.references("on"), 1, order, value)
    assert_refused(instance, status, instance.blob(), "on must be 0 or 1, so it has no derivative")
    assert instance.step(0.25) == OK
    assert abs(instance.get("level")[0] - 0.25) < 2500 * 2.0**-54  # half a bit of rounding in each of 2500 sub-steps


def test_what_no_fmu_can_be_is_refused_as_before() -> None:
    model = SampledModel("Odd", "A divisor that is a Boolean")
    x = model.state("x", ca.SX(0.0))
    model.parameter("every", 1, type=Type.BOOLEAN, description="A switch")
    model.divisor_name = "every"
    model.output("x", x, description="State")
    with pytest.raises(DefinitionError, match="the divisor every of slow states must be an Integer parameter"):
        as_reals(model)


def test_the_model_itself_stays(fmu_folder: Path, tmp_path: Path) -> None:
    model: Model = MODELS["Actuator"]()
    build(model, tmp_path / "reals", reals=True)
    assert build(model, tmp_path).read_bytes() == _bytes(fmu_folder, "Actuator")


def test_no_fmu_is_for_model_exchange(fmu: Path) -> None:
    """ROS 2's fmi_adapter refuses an FMU that is anything besides co-simulation."""
    assert fmpy.read_model_description(str(fmu)).modelExchange is None
