"""Tests of start values and of `replace`: what is refused, what is kept, and what is reported."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, Type, build
from orchestration import (
    ArchiveError,
    Component,
    Options,
    System,
    SystemDescriptionError,
    UnconnectedInputWarning,
    simulate,
)
from orchestration.fmi.description import read_description
from tests.unit.orchestration.small_models import H, mixed, system


@pytest.fixture(scope="module")
def controllers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Stand-ins for the controller of fig2, each with one thing of its own."""
    folder = tmp_path_factory.mktemp("controllers")
    models = []
    for name, output, unit in (("Few", "tau_cmd", "N.m"), ("Mute", "torque", "N.m"), ("Odd", "tau_cmd", "N")):
        model = SampledModel(name, "A controller that damps")
        dq = model.input("dq", [0.0, 0.0], unit="rad/s", description="Joint velocity")
        gain = model.parameter("K", [1.0, 2.0], description="Gain")
        model.output(output, -gain * dq, unit=unit, description="Torque")
        models.append(model)
    typed = SampledModel("Typed", "A controller with an Integer for K")
    typed.input("dq", [0, 0], description="Joint velocity", type=Type.INTEGER)
    typed.output("tau_cmd", typed.parameter("K", [1, 2], description="Gain", type=Type.INTEGER), description="Torque")
    return {model.name: build(model, folder) for model in [*models, typed]}


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("relay.z", 1, "relay has no variable z; there are sample_time, offset, u, n and 4 more"),
        ("relais.u", 1, r"has no component relais; did you mean relay\?"),
        ("offset", 1, r"'offset' is not of the form component\.variable, such as relay\.offset"),
        ("relay.y", 1, r"relay\.y has causality output; only parameters, inputs and initial states can be set"),
        ("relay.offset", "stiff", r"relay\.offset = 'stiff': a plain number in m is needed, without a unit"),
        ("relay.offset", float("nan"), r"relay\.offset = nan: a finite number in m is needed"),
        ("relay.u", "nan", r"relay\.u = 'nan': a plain number in m is needed"),  # though a connection drives it
        ("relay.offset", None, r"relay\.offset = None: a finite number in m is needed"),
        ("relay.n", 1.5, r"relay\.n = 1\.5: an integer of 32 bits is needed"),
        ("relay.n", 2**31, r"relay\.n = 2147483648: an integer of 32 bits"),
        ("relay.n", "1e12", r"relay\.n = '1e12': an integer of 32 bits"),
        ("relay.n", float("inf"), r"relay\.n = inf: an integer"),
        ("relay.even", "maybe", r"relay\.even = 'maybe': true or false is needed"),
        ("relay.even", 2, r"relay\.even = 2: true or false is needed"),
    ],
)
def test_wrong_values_are_refused(small: dict[str, Path], path: str, value: Any, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        mixed(small).set({path: value})


def test_start_values_are_checked_without_set_too(small: dict[str, Path]) -> None:
    description = read_description(small["Relay"])
    for start in ({"offset": float("nan")}, {"n": 0.5}, {"even": 3.0}, {"y": 1.0}, {"z": 1.0}):
        with pytest.raises(SystemDescriptionError, match=rf"relay.*{next(iter(start))}"):
            System("s", (Component("relay", description, start),))


@pytest.mark.parametrize(
    ("path", "value", "number"),
    [
        ("relay.even", True, 1.0),
        ("relay.even", "true", 1.0),
        ("relay.even", 1, 1.0),
        ("relay.even", 0.0, 0.0),
        ("relay.even", "False", 0.0),
        ("relay.n", "-7", -7.0),
        ("relay.n", -(2**31), -(2.0**31)),
        ("relay.n", np.int64(5), 5.0),
        ("relay.offset", "1e-3", 1e-3),
        ("relay.offset", np.float64(0.1), 0.1),
    ],
)
def test_values_of_every_kind_are_taken(small: dict[str, Path], path: str, value: Any, number: float) -> None:
    component, variable = path.split(".")
    changed = mixed(small).set({path: value})
    assert changed.component(component).start[variable] == number
    assert changed.set({path: changed.component(component).start[variable]}) == changed
    assert mixed(small).component(component).start == {}  # the old one is as it was


def test_set_values_reach_the_unit(small: dict[str, Path]) -> None:
    relay = system(small, {"relay": "Relay"}).set({"relay.offset": 0.5, "relay.n": -3, "relay.even": "true"})
    with pytest.warns(UnconnectedInputWarning):
        np.testing.assert_array_equal(simulate(relay, H).rows, [[0.5, -2, 0]] * 2)


def test_replace_keeps_place_values_and_connections(fig2: System, controllers: dict[str, Path]) -> None:
    changed = fig2.replace("controller", controllers["Few"])
    assert [c.name for c in changed.components] == [c.name for c in fig2.components]
    old, new = fig2.component("controller").start, changed.component("controller").start
    assert new == {n: v for n, v in old.items() if n in ("K[1]", "K[2]", "sample_time")}
    dropped = [c for c in fig2.connections if c not in changed.connections]
    assert dropped
    assert all(c.target == "controller" and not c.input.startswith("dq[") for c in dropped)
    assert changed.notices == (
        f"controller: start values dropped, Few has no {', '.join(n for n in old if n not in new)}.",
        f"controller: connections dropped, Few has no input {', '.join(c.input for c in dropped)}.",
    )
    assert np.isfinite(simulate(changed, 10 * fig2.run_step(), options=Options(strict=True)).rows).all()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Mute", r"Mute\.fmu cannot be controller: it has no output tau_cmd"),
        ("Odd", r"Connection controller\.tau_cmd\[1\] -> actuator\.tau_cmd\[1\]: units N and N\.m differ"),
        ("Typed", r"types Real and Integer differ|controller\.K\[1\]"),
    ],
)
def test_replace_refuses_what_does_not_fit(fig2: System, controllers: dict[str, Path], name: str, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        fig2.replace("controller", controllers[name])


def test_replace_names_what_is_missing(fig2: System, tmp_path: Path) -> None:
    with pytest.raises(ArchiveError, match=r"missing\.fmu: there is no such FMU"):
        fig2.replace("controller", tmp_path / "missing.fmu")
    with pytest.raises(SystemDescriptionError, match="no component pilot; there are trajectory, sensor"):
        fig2.replace("pilot", tmp_path / "missing.fmu")
