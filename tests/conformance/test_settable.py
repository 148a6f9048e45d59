"""Tests of rule 12: which variables can be set in which state, and when a new value acts."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.conformance.binary import OK, Binary, Instance, kind
from tests.conformance.calls import assert_refused
from tests.conformance.scenes import H, scene

Create = Callable[..., Instance]
Load = Callable[[str], Binary]


def test_12_only_inputs_and_tunables_after_initialization(binary: Binary, create: Create) -> None:
    instance = create(binary).initialize()
    starts = binary.starts("input", "parameter")
    before = instance.blob()
    for name in binary.names("parameter", variability="fixed"):
        assert_refused(instance, instance.set({name: starts[name]}), before, name, "fixed")
    for name in [*binary.names("input"), *binary.names("parameter", variability="tunable")]:
        assert instance.set({name: starts[name]}) == OK, name
    assert instance.step(H) == OK


@pytest.mark.parametrize("phase", ["instantiated", "initialization mode", "step complete"])
def test_12_outputs_cannot_be_set(binary: Binary, create: Create, phase: str) -> None:
    instance = create(binary).to(phase)
    before = instance.blob()
    for name in binary.names("output"):
        assert_refused(instance, instance.set({name: 0.0}), before, name, "output")


def test_12_inputs_reach_outputs_during_initialization(binary: Binary, create: Create) -> None:
    """Set before, or set during initialization mode, in one call or after a get: the same outputs."""
    values = {n: v for n, v in scene(binary).items() if n in binary.names("input", "parameter")}
    early = create(binary, start=values).enter()
    late = create(binary).enter()
    late.outputs()
    assert late.set(values) == OK
    np.testing.assert_array_equal(late.outputs(), early.outputs())
    shown = early.outputs()
    for instance in (early, late):
        assert instance.call("fmi2ExitInitializationMode") == OK
        np.testing.assert_array_equal(instance.outputs(), shown)


def test_12_tunable_acts_at_the_next_tick(load: Load, create: Create) -> None:
    """Ticks at 0 and 1 sample times run in a step of 1.5; the limit set then waits for tick 2."""
    instance = create(load("Actuator"), start={"tau_cmd[1]": 5.0}).initialize()
    assert instance.step(1.5 * H) == OK
    assert instance.set({"tau_max[1]": 1.0}) == OK
    assert instance.get("tau[1]", "saturated[1]").tolist() == [5.0, 0.0]
    assert instance.step(0.25 * H) == OK
    assert instance.get("tau[1]", "saturated[1]").tolist() == [5.0, 0.0]
    assert instance.step(0.5 * H) == OK
    assert instance.get("tau[1]", "saturated[1]").tolist() == [1.0, 1.0]


def test_12_every_tunable_acts(binary: Binary, create: Create) -> None:
    """Changed after initialization, each gives the outputs of an instance that started with it.

    Also when an input is set after it, and before the step.
    """
    tunables = binary.names("parameter", variability="tunable")
    start = scene(binary)
    for name in tunables:
        before = (start | binary.starts("parameter"))[name]
        value = 1 - before if kind(binary.variables[name]) == "Boolean" else 1.5 * before + 0.25
        changed = create(binary, start=start).initialize()
        assert changed.set({name: value}) == OK
        assert changed.get(name)[0] == value
        assert changed.set({n: changed.get(n)[0] for n in binary.names("input", type="Real")}) == OK
        fresh = create(binary, start=start | {name: value}).initialize()
        for instance in (changed, fresh):
            assert instance.step(2 * H) == OK, f"{name}: {instance.last}"
        np.testing.assert_array_equal(changed.outputs(), fresh.outputs(), err_msg=name)
