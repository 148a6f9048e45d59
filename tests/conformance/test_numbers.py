"""Rule 11: inputs, parameters and results that cannot be: not finite, out of range, singular, without a bound."""

import ctypes as ct
import math
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, SampledModel, build
from fmus.catalog import MODELS
from tests.conformance.binary import ERROR, OK, Binary, Instance, array
from tests.conformance.calls import assert_refused
from tests.conformance.scenes import H

Create = Callable[..., Instance]
Load = Callable[[str], Binary]


def real_inputs() -> list[tuple[str, str]]:
    """Each FMU's first and last Real input."""
    pairs = []
    for identifier, declare in MODELS.items():
        names = [v.name for v in declare().variables if v.role.name == "INPUT" and v.type.name == "REAL"]
        pairs += [(identifier, name) for name in (names[:1] + names[-1:])]
    return pairs


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(("identifier", "name"), real_inputs())
def test_11_input_that_is_not_finite_is_stored_then_reported(
    load: Load, create: Create, identifier: str, name: str, value: float
) -> None:
    instance = create(load(identifier)).enter()
    good = instance.get(name)[0]
    assert instance.set({name: value}) == OK
    np.testing.assert_array_equal(instance.get(name), value)
    instance.outputs()
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert name in instance.last
    assert f"{value:g}" in instance.last
    assert instance.set({name: good}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    assert instance.step(H) == OK
    assert instance.set({name: value}) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(H), before, name, f"{value:g}")
    assert instance.set({name: good}) == OK
    assert instance.step(H) == OK


def test_11_parameter_out_of_range_is_named_with_both_values(binary: Binary, create: Create) -> None:
    instance = create(binary)
    before = instance.blob()
    bounded = 0
    for name in binary.names("parameter"):
        variable = binary.variables[name]
        if variable.type == "Boolean":
            continue
        wrong = {math.nan: "nan", math.inf: "inf", -math.inf: "-inf"} if variable.type == "Real" else {}
        if variable.min is not None:
            least = float(variable.min)
            below = least - 1 if variable.type == "Integer" else least - 0.1
            wrong[below] = repr(least).removesuffix(".0")
            bounded += 1
        for value, said in wrong.items():
            status = instance.set({name: value})
            assert_refused(instance, status, before, f"{name} =", f"{value:.17g}", said)
    assert bounded, "every unit has a parameter with a least value"


def test_11_a_refused_array_sets_nothing(load: Load, create: Create) -> None:
    instance = create(load("Plant"))
    before = instance.blob()
    names = ("q_start[1]", "m[1]")
    status = instance.call("fmi2SetReal", instance.references(*names), 2, array(ct.c_double, [0.5, -1.0]))
    assert_refused(instance, status, before, "m[1]")


def test_11_a_state_that_diverges_unseen_is_reported(tmp_path: Path, create: Create) -> None:
    """Where no output shows it, and no event is near."""
    model = ContinuousModel("Unseen", "Integrates, and shows its input", dt_max=H)
    u = model.input("u", 0.0, description="A rate")
    z = model.state("z", 0.0)
    model.derivative(z, ca.exp(u))
    model.output("y", u, description="u")
    instance = create(Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")).initialize()
    assert instance.step(H) == OK
    assert instance.set({"u": 1e3}) == OK
    assert instance.step(H) == ERROR
    assert instance.last.startswith("State z[1] is inf")


def test_11_huge_numbers_are_finite(load: Load, create: Create) -> None:
    """Also where their sum is not."""
    sensor = create(load("ForceSensor"), start={"range": 100.0}).initialize()
    assert sensor.set({"F_ext[1]": 1.5e308, "F_ext[2]": 1.7e308}) == OK
    assert sensor.step(H) == OK
    np.testing.assert_array_equal(sensor.get("F_hat[1]", "F_hat[2]"), 100.0)


def test_11_a_demand_without_a_value_is_not_met(tmp_path: Path, create: Create) -> None:
    """The root of a negative number is not positive: it is no number."""
    model = SampledModel("Root", "Demands a root")
    u = model.input("u", 1.0, description="Not negative")
    model.require(ca.sqrt(u), "u has no root")
    model.output("y", u, description="u")
    instance = create(Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")).initialize()
    assert instance.set({"u": -1.0}) == OK
    assert instance.step(H) == ERROR
    assert "u has no root" in instance.last


@pytest.mark.parametrize("wall_offset", [1.45, -1.6])
def test_11_divergence_is_reported_and_not_shown(load: Load, create: Create, wall_offset: float) -> None:
    """Free and in contact, where a wall is expected behind the tip's start."""
    plant = create(load("Plant"), start={"wall_offset": wall_offset}).initialize()
    assert (plant.get("penetration")[0] > 0) == (wall_offset < 0)
    before = plant.outputs()
    assert plant.set({"tau[1]": 1e300}) == OK
    assert plant.step(H) == ERROR
    assert plant.last.startswith("State q[1] is nan")
    np.testing.assert_array_equal(plant.outputs(), before)
    controller = create(load("CraigAdaptiveImpedance")).initialize()
    shown = controller.outputs()
    assert controller.set({"x_v[1]": 1e308}) == OK
    assert controller.step(H) == ERROR
    assert controller.last.startswith("Output tau_cmd[1] is nan")
    np.testing.assert_array_equal(controller.outputs(), shown)


def controllers() -> list[str]:
    """FMUs that command a torque from joint angles."""
    return [name for name, declare in MODELS.items() if {"tau_cmd[1]", "q[2]"} <= {v.name for v in declare().variables}]


@pytest.mark.parametrize("identifier", controllers())
@pytest.mark.parametrize("q2", [0.0, math.pi])
def test_11_singular_arm_is_reported(load: Load, create: Create, identifier: str, q2: float) -> None:
    binary = load(identifier)
    elbows = [name for name in binary.names("input") if name.startswith("q[") and name != "q[1]"]
    singular, regular = dict.fromkeys(elbows, 0.0) | {"q[2]": q2}, dict.fromkeys(elbows, 1.4)
    instance = create(binary).enter()
    assert instance.set(singular) == OK
    instance.outputs()
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert "The arm is singular" in instance.last
    assert instance.set(regular) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    assert instance.step(H) == OK
    shown = instance.outputs()
    assert instance.set(singular) == OK
    assert instance.step(H) == ERROR
    assert "The arm is singular" in instance.last
    np.testing.assert_array_equal(instance.outputs(), shown)
    assert instance.step(H) == ERROR, "only reset or an earlier state lead on"
    assert instance.call("fmi2Reset") == OK
    instance.initialize()
    assert instance.step(H) == OK


@pytest.mark.parametrize("identifier", ["Plant", "Plant3R", "VirtualTrajectory"])
@pytest.mark.parametrize("normal", [(-1.0, 0.1), (0.0, 0.0), (-1.0 - 1e-8, 0.0), (2.0, 0.0)])
def test_11_wall_normal_must_have_length_one(
    load: Load, create: Create, identifier: str, normal: tuple[float, float]
) -> None:
    instance = create(load(identifier), start={"wall_normal[1]": normal[0], "wall_normal[2]": normal[1]}).enter()
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert "wall_normal" in instance.last
    assert instance.set({"wall_normal[1]": 0.6, "wall_normal[2]": -0.8}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK, "0.6^2 + 0.8^2 = 1 to rounding"


def test_11_noise_without_a_bound_is_reported(load: Load, create: Create) -> None:
    instance = create(load("ForceSensor"), start={"noise_std": 1.0}).enter()
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert "noise_bound" in instance.last
    assert instance.set({"noise_bound": 3.0}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    assert instance.set({"noise_bound": 0.0}) == OK
    assert instance.step(H) == ERROR
    assert "noise_bound" in instance.last
    assert instance.set({"noise_bound": 3.0}) == OK
    assert instance.step(H) == OK, "a step that its parameters forbid changes nothing"
