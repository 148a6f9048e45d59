"""Tests of rules 10 and 15: every function in every state, its references and arrays, and any resource location."""

import ctypes as ct
from collections.abc import Callable

import pytest

from tests.conformance.binary import ARGUMENTS, ERROR, FUNCTIONS, OK, OTHERS, PHASES, Binary, Instance, array
from tests.conformance.calls import ALLOWED, CAPABILITIES, arguments, assert_refused
from tests.conformance.scenes import H

Create = Callable[..., Instance]


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
