"""What a call may do, when, and what an error says: checklist 9 to 12 and 15."""

import ctypes as ct
import math
import time
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from fmus.catalog import UNITS
from tests.conformance.binary import (
    ARGUMENTS,
    ERROR,
    FUNCTIONS,
    OK,
    OTHERS,
    PHASES,
    Binary,
    Callbacks,
    Instance,
    Log,
    array,
)
from tests.conformance.calls import ALLOWED, CAPABILITIES, arguments
from tests.conformance.scenes import scene

Create = Callable[..., Instance]
Load = Callable[[str], Binary]
H = 1e-4  # s, one tick of every unit


def assert_refused(instance: Instance, status: int, before: bytes, *texts: str) -> None:
    """The call failed with a message that holds the texts, and changed nothing."""
    assert status == ERROR
    for text in texts:
        assert text in instance.last, instance.last
    assert instance.blob() == before


# 9: instantiation and logging


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        pytest.param({"guid": b"{00000000-0000-0000-0000-000000000000}"}, "{00000000-0000", id="other GUID"),
        pytest.param({"guid": b""}, "GUID", id="empty GUID"),
        pytest.param({"guid": None}, "GUID", id="no GUID"),
        pytest.param({"name": b""}, "name", id="empty name"),
        pytest.param({"name": b" \t\r\n"}, "name", id="blank name"),
        pytest.param({"name": None}, "name", id="no name"),
        pytest.param({"kind": 0}, "co-simulation", id="model exchange"),
        pytest.param({"kind": 7}, "7", id="unknown type"),
    ],
)
def test_09_wrong_instantiation_is_refused_with_a_message(load: Load, wrong: dict, said: str) -> None:
    binary = load("Actuator")
    log = Log()
    assert binary.create(log, **wrong) is None
    assert len(log) == 1
    assert said in log[0].text
    assert log[0].status == ERROR
    silent = Log()
    assert binary.create(silent, logging=0, **wrong) is None
    assert silent == []
    assert binary.create(None, **wrong) is None, "without a logger"


def test_09_every_unit_refuses_a_wrong_guid(binary: Binary) -> None:
    log = Log()
    assert binary.create(log, guid=b"{wrong}") is None
    assert binary.guid.decode() in log[0].text, "the message names both"
    assert "{wrong}" in log[0].text


def test_09_callbacks_may_be_missing(load: Load) -> None:
    assert load("Actuator").create(None, callbacks=None) is None


def test_09_callback_struct_is_copied(load: Load) -> None:
    binary, log = load("Actuator"), Log()
    callbacks = Callbacks(logger=log.callback)
    component = binary.create(callbacks=ct.byref(callbacks))
    ct.memset(ct.byref(callbacks), 0, ct.sizeof(callbacks))
    assert binary["fmi2Terminate"](component) == ERROR
    assert len(log) == 1
    binary["fmi2FreeInstance"](component)


def test_09_null_logger_is_tolerated(binary: Binary) -> None:
    component = binary.create(None)
    assert component is not None
    assert binary["fmi2Terminate"](component) == ERROR
    binary["fmi2FreeInstance"](component)


def test_09_nothing_is_logged_when_logging_is_off(binary: Binary, create: Create) -> None:
    instance = create(binary, logging=0)
    for function in ARGUMENTS:
        instance.call(function, *arguments(instance, function).arguments)
        assert instance.call("fmi2SetDebugLogging", 0, 0, None) == OK
    assert instance.log == []


def test_09_messages_have_a_declared_category_and_no_newline(binary: Binary, create: Create) -> None:
    instance = create(binary, name=b"this one")
    for phase in PHASES[1:]:
        assert instance.call("fmi2Reset") == OK
        instance.to(phase)
        instance.call("fmi2SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
    assert len(instance.log) >= len(PHASES) - 1
    for message in instance.log:
        assert message.category in binary.log_categories
        assert message.name == "this one"
        assert message.status == ERROR
        assert message.text == message.text.strip()
        assert message.text.endswith(".")


def switch_logging(instance: Instance, on: int, *categories: bytes) -> int:
    """fmi2SetDebugLogging."""
    return instance.call("fmi2SetDebugLogging", on, len(categories), array(ct.c_char_p, categories))


def provoke(instance: Instance) -> int:
    """Number of messages that an error sends."""
    before = len(instance.log)
    assert instance.call("fmi2CancelStep") == ERROR
    return len(instance.log) - before


def test_09_logging_can_be_switched(load: Load, create: Create) -> None:
    instance = create(load("Actuator"), logging=0)
    assert provoke(instance) == 0
    assert switch_logging(instance, 1) == OK
    assert provoke(instance) == 1
    assert switch_logging(instance, 0) == OK
    assert provoke(instance) == 0
    assert switch_logging(instance, 1, b"logStatusError") == OK
    assert provoke(instance) == 1
    assert switch_logging(instance, 0, b"logStatusWarning") == OK
    assert provoke(instance) == 1, "only the given category is off"
    assert switch_logging(instance, 0, b"logStatusError") == OK
    assert provoke(instance) == 0


def test_09_only_the_given_categories_are_logged(load: Load, create: Create) -> None:
    """FMI 2.0.5, 2.1.5: with loggingOn and categories, only those are logged."""
    instance = create(load("Actuator"), logging=1)
    assert switch_logging(instance, 1, b"logStatusWarning") == OK
    assert provoke(instance) == 0
    assert switch_logging(instance, 1, b"logStatusWarning", b"logStatusError") == OK
    assert provoke(instance) == 1


def test_09_known_categories_are_the_declared_ones(binary: Binary, create: Create) -> None:
    instance = create(binary)
    for category in binary.log_categories:
        assert switch_logging(instance, 1, category.encode()) == OK
    assert switch_logging(instance, 1) == OK
    assert switch_logging(instance, 1, b"none") == ERROR
    assert set(instance.last.rstrip(".").partition("known are ")[2].split(", ")) == binary.log_categories


def test_09_unknown_categories_are_named(load: Load, create: Create) -> None:
    instance = create(load("Actuator"))
    before = instance.blob()
    assert_refused(
        instance,
        switch_logging(instance, 1, b"logAll", b"logNothing"),
        before,
        "logNothing",
        "logStatusError",
    )
    assert_refused(instance, instance.call("fmi2SetDebugLogging", 1, 1, None), before, "missing")
    assert_refused(instance, switch_logging(instance, 1, None), before, "null")


@pytest.mark.parametrize("text", [b"%s%s%s%n", b"100 % sure", b"%", b"%%", b"x" * 5000, b"%" * 5000, b"\xc3\xa9" * 700])
def test_09_percent_signs_and_long_texts_are_safe(load: Load, create: Create, text: bytes) -> None:
    """The message is a printf format to the host; a lone percent sign would read its stack."""
    binary, log = load("Actuator"), Log()
    assert binary.create(log, guid=text) is None
    instance = create(binary, name=text)
    assert provoke(instance) == 1
    assert switch_logging(instance, 1, text) == ERROR
    assert len(instance.log) == 2
    for message in [*log, *instance.log]:
        assert message.is_safe_format
    assert log[0].raw.startswith(b'The GUID "' + text[:100].replace(b"%", b"%%"))


# 10: every function in every state


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("function", ARGUMENTS)
def test_10_allowed_or_refused(binary: Binary, create: Create, function: str, phase: str) -> None:
    instance = create(binary)
    if function == "fmi2EnterInitializationMode":
        instance.setup() if phase == "instantiated" else None
    instance.to(phase)
    capability, absent, otherwise = CAPABILITIES.get(function, ("", None, frozenset()))
    supported = not capability or getattr(binary.description.coSimulation, capability) != absent
    phases = ALLOWED.get(function, otherwise if supported else frozenset())
    call = arguments(instance, function)
    before, told = instance.blob(), len(instance.log)
    results = [bytes(result) for result in call.results]
    status = instance.call(function, *call.arguments)
    if phase in phases:
        assert status == OK, instance.last
        assert len(instance.log) == told
    else:
        assert_refused(instance, status, before, function)
        assert len(instance.log) == told + 1
        assert [bytes(result) for result in call.results] == results
        assert (
            phase in instance.last or function in CAPABILITIES or function in ("fmi2CancelStep", "fmi2GetIntegerStatus")
        )


def test_10_no_component_is_an_error_not_a_crash(binary: Binary) -> None:
    for function, kinds in ARGUMENTS.items():
        assert binary[function](None, *(kind() for kind in kinds)) == ERROR, function
    assert binary["fmi2FreeInstance"](None) is None


def test_10_version_and_platform(binary: Binary) -> None:
    assert binary["fmi2GetVersion"]() == b"2.0"
    assert binary["fmi2GetTypesPlatform"]() == b"default"
    assert set(FUNCTIONS) == set(OTHERS) | set(ALLOWED) | set(CAPABILITIES)


@pytest.mark.parametrize("type", ["Real", "Integer", "Boolean", "String"])
def test_10_wrong_references_and_arrays_are_refused(binary: Binary, create: Create, type: str) -> None:
    c_type = {"Real": ct.c_double, "String": ct.c_char_p}.get(type, ct.c_int)
    instance = create(binary).enter()
    instance.outputs()
    others = [name for name in binary.variables if binary.variables[name].type != type][:1]
    before = instance.blob()
    value, one = array(c_type, [c_type().value]), array(ct.c_uint, [0])
    for access in ("Get", "Set"):
        function = f"fmi2{access}{type}"
        for reference in (len(binary.variables), 2**32 - 1):
            status = instance.call(function, array(ct.c_uint, [reference]), 1, value)
            assert_refused(instance, status, before, function, str(reference))
        for other in others:
            status = instance.call(function, instance.references(other), 1, value)
            assert_refused(instance, status, before, function, other, type)
        assert_refused(instance, instance.call(function, None, 1, value), before, function, "missing")
        assert_refused(instance, instance.call(function, one, 1, None), before, function, "missing")
        assert instance.call(function, None, 0, None) == OK


def test_10_status_of_the_last_step(binary: Binary, create: Create) -> None:
    instance, status, end, terminated = create(binary), ct.c_int(), ct.c_double(), ct.c_int(7)
    instance.initialize(t0=0.5)
    assert instance.step(H) == OK
    assert instance.call("fmi2GetStatus", 0, ct.byref(status)) == OK
    assert instance.call("fmi2GetRealStatus", 2, ct.byref(end)) == OK
    assert instance.call("fmi2GetBooleanStatus", 3, ct.byref(terminated)) == OK
    assert (status.value, end.value, terminated.value) == (OK, 0.5 + H, 0)
    pending = ct.c_char_p(b"unset")
    assert instance.call("fmi2GetStringStatus", 1, ct.byref(pending)) == OK
    assert pending.value == b"", "a text, not NULL"
    assert instance.step(1e9) == ERROR
    assert instance.call("fmi2GetStatus", 0, ct.byref(status)) == OK
    assert instance.call("fmi2GetRealStatus", 2, ct.byref(end)) == OK
    assert (status.value, end.value) == (ERROR, 0.5 + H)
    before = instance.blob()
    assert_refused(instance, instance.call("fmi2GetStatus", 2, ct.byref(status)), before, "fmi2DoStepStatus")
    assert_refused(instance, instance.call("fmi2GetRealStatus", 0, ct.byref(end)), before, "fmi2LastSuccessfulTime")


# 11: experiments, steps and numbers that cannot be


def test_11_experiment_must_be_set_up(binary: Binary, create: Create) -> None:
    instance = create(binary)
    before = instance.blob()
    assert_refused(instance, instance.call("fmi2EnterInitializationMode"), before, "fmi2SetupExperiment")


@pytest.mark.parametrize(
    ("t0", "stop"), [(math.nan, None), (math.inf, None), (1.25, 1.125), (0.0, math.nan), (0.0, math.inf)]
)
def test_11_experiment_must_make_sense(load: Load, create: Create, t0: float, stop: float | None) -> None:
    instance = create(load("Actuator"))
    before = instance.blob()
    said = [f"{t0:.17g}"] if stop is None else [f"{t0:.17g}", f"{stop:.17g}"]
    assert_refused(instance, instance.setup(t0, stop), before, *said)


@pytest.mark.parametrize("h", [0.0, -0.0, -H, math.nan, math.inf, -math.inf])
def test_11_step_must_be_positive_and_finite(binary: Binary, create: Create, h: float) -> None:
    instance = create(binary).initialize(t0=0.3)
    before = instance.blob()
    assert_refused(instance, instance.step(h), before, f"{0.3:.17g} s", f"{h:.17g} s")
    assert instance.step(H) == OK


@pytest.mark.parametrize("t", [0.0, 0.4 + 2 * H, 5.0, -1e300, 1e300])
def test_11_communication_point_must_follow(binary: Binary, create: Create, t: float) -> None:
    instance = create(binary).initialize(t0=0.4)
    assert instance.step(H) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(H, t), before, f"{t:.17g} s", f"{0.4 + H:.17g} s")
    assert instance.step(H) == OK


@pytest.mark.parametrize("t", [math.nan, math.inf, -math.inf])
def test_11_communication_point_must_be_finite(binary: Binary, create: Create, t: float) -> None:
    instance = create(binary).initialize()
    before = instance.blob()
    assert_refused(instance, instance.step(H, t), before, f"{t:.17g} s", f"{H:.17g} s")


def test_11_summed_and_rounded_clocks_are_accepted(binary: Binary, create: Create) -> None:
    """A host may sum its time, or round it to a nanosecond; a nanosecond is 1e-9 max(1, |t|)."""
    for clock in (lambda k: round(100 + k * H / 3, 9), lambda k: sum([H / 3] * k, 100.0)):
        instance = create(binary).initialize(t0=100.0)
        assert all(instance.step(H / 3, clock(k)) == OK for k in range(300)), instance.last


def test_11_no_step_past_the_stop_time(binary: Binary, create: Create) -> None:
    instance = create(binary).initialize(stop=3 * H)
    assert instance.step(2 * H) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(2 * H), before, f"{4 * H:.17g} s", f"{3 * H:.17g} s")
    assert_refused(instance, instance.step(1e300), before, "1e+300", f"{3 * H:.17g} s")
    assert instance.step(H) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(H), before, "stop time")


def test_11_a_summed_clock_reaches_the_stop_time(binary: Binary, create: Create) -> None:
    instance, t = create(binary).initialize(stop=0.1), 0.0
    for _ in range(1000):
        assert instance.step(H, t) == OK, instance.last
        t += H


@pytest.mark.parametrize("h", [1.1e3, 1e9, 1e300, 1.7e308])
def test_11_a_huge_step_is_refused_at_once(binary: Binary, create: Create, h: float) -> None:
    """More than 1e7 ticks or sub-steps of 1e-4 s; a second is 1e4 times what refusing takes."""
    instance = create(binary).initialize()
    start = time.monotonic()
    assert instance.step(h) == ERROR
    assert time.monotonic() - start < 1
    assert f"{h:.17g} s" in instance.last
    assert f"{H:.17g} s" in instance.last
    assert instance.call("fmi2Reset") == OK
    instance.initialize()
    assert instance.step(H) == OK


def test_11_a_tiny_sample_time_is_refused_at_once(binary: Binary, create: Create) -> None:
    period = "sample_time" if "sample_time" in binary.variables else "dt_max"
    instance = create(binary, start={period: 1e-12}).initialize()
    start = time.monotonic()
    assert instance.step(1.0) == ERROR
    assert time.monotonic() - start < 1
    assert period in instance.last


def real_inputs() -> list[tuple[str, str]]:
    """Each unit's first and last Real input."""
    pairs = []
    for unit, declare in UNITS.items():
        names = [v.name for v in declare().variables if v.role.name == "INPUT" and v.type.name == "REAL"]
        pairs += [(unit, name) for name in (names[:1] + names[-1:])]
    return pairs


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(("unit", "name"), real_inputs())
def test_11_input_that_is_not_finite_is_stored_then_reported(
    load: Load, create: Create, unit: str, name: str, value: float
) -> None:
    instance = create(load(unit)).enter()
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
            wrong[below] = f"{least:.17g}"
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


def test_11_divergence_is_reported_and_not_shown(load: Load, create: Create) -> None:
    plant = create(load("Plant")).initialize()
    assert plant.set({"tau[1]": 1e300}) == OK
    assert plant.step(H) == ERROR
    assert plant.last.startswith("State q[1] is nan")
    controller = create(load("CraigAdaptiveImpedance")).initialize()
    shown = controller.outputs()
    assert controller.set({"x_v[1]": 1e308}) == OK
    assert controller.step(H) == ERROR
    assert controller.last.startswith("Output tau_cmd[1] is nan")
    np.testing.assert_array_equal(controller.outputs(), shown)


def controllers() -> list[str]:
    """Units that command a torque from joint angles."""
    return [name for name, declare in UNITS.items() if {"tau_cmd[1]", "q[2]"} <= {v.name for v in declare().variables}]


@pytest.mark.parametrize("unit", controllers())
@pytest.mark.parametrize("q2", [0.0, math.pi])
def test_11_singular_arm_is_reported(load: Load, create: Create, unit: str, q2: float) -> None:
    binary = load(unit)
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


@pytest.mark.parametrize("unit", ["Plant", "Plant3R", "VirtualTrajectory"])
@pytest.mark.parametrize("normal", [(-1.0, 0.1), (0.0, 0.0), (-1.0 - 1e-8, 0.0), (2.0, 0.0)])
def test_11_wall_normal_must_have_length_one(
    load: Load, create: Create, unit: str, normal: tuple[float, float]
) -> None:
    instance = create(load(unit), start={"wall_normal[1]": normal[0], "wall_normal[2]": normal[1]}).enter()
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


# 12: what can be set when


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
        value = 1.5 * (start | binary.starts("parameter"))[name] + 0.25
        changed = create(binary, start=start).initialize()
        assert changed.set({name: value}) == OK
        assert changed.get(name)[0] == value
        assert changed.set({n: changed.get(n)[0] for n in binary.names("input", type="Real")}) == OK
        fresh = create(binary, start=start | {name: value}).initialize()
        for instance in (changed, fresh):
            assert instance.step(2 * H) == OK, f"{name}: {instance.last}"
        np.testing.assert_array_equal(changed.outputs(), fresh.outputs(), err_msg=name)


# 15: resource location


@pytest.mark.parametrize(
    "location",
    [
        None,
        b"",
        b"file:/a/b/resources",
        b"file:///a b/c%20d/%C3%A9/resources",
        b"C:\\x y",
        b"\xff\xfe",
        b"/" * 9000,
    ],
)
def test_15_resource_location_is_not_needed(binary: Binary, create: Create, location: bytes | None) -> None:
    instance = create(binary, location=location).initialize()
    assert instance.step(H) == OK
