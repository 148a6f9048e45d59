"""Rule 9: what instantiation refuses, and what is logged, when and how."""

import ctypes as ct
from collections.abc import Callable

import pytest

from tests.conformance.binary import ARGUMENTS, ERROR, OK, PHASES, Binary, Callbacks, Instance, Log, array
from tests.conformance.calls import arguments, assert_refused

Create = Callable[..., Instance]
Load = Callable[[str], Binary]


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


def switch_logging(instance: Instance, on: int, *categories: bytes | None) -> int:
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
