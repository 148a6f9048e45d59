"""Refusals that nothing else reaches: wrong kinds of status, arrays that are missing, variables of a wrong type.

Found by `coverage`; checklist 10.
"""

import ctypes as ct
from collections.abc import Callable
from typing import Any

import pytest

from tests.conformance.binary import ERROR, OK, Binary, Instance, array
from tests.conformance.container import of_models

Create = Callable[..., Instance]
Load = Callable[[str], Binary]
# The one kind of status each function answers, and the type of its result.
STATUS = {
    "fmi2GetStatus": (0, ct.c_int),
    "fmi2GetStringStatus": (1, ct.c_char_p),
    "fmi2GetRealStatus": (2, ct.c_double),
    "fmi2GetBooleanStatus": (3, ct.c_int),
}


def refused(instance: Instance, function: str, *arguments: Any) -> str:
    """The message of a call that must be refused and change nothing."""
    before, told = instance.blob(), len(instance.log)
    assert instance.call(function, *arguments) == ERROR
    assert len(instance.log) == told + 1
    assert instance.last.startswith(function)
    assert instance.blob() == before
    return instance.last


@pytest.mark.parametrize("function", STATUS)
def test_10_other_kinds_of_status_are_refused(binary: Binary, create: Create, function: str) -> None:
    instance = create(binary).initialize()
    kind, c_type = STATUS[function]
    for other in range(4):
        if other != kind:
            assert "fmi2" in refused(instance, function, other, ct.byref(c_type()))
    assert "only" in refused(instance, function, kind, None)
    assert instance.call(function, kind, ct.byref(c_type())) == OK


@pytest.mark.parametrize("function", ["fmi2SetRealInputDerivatives", "fmi2GetRealOutputDerivatives"])
def test_10_missing_arrays_of_derivatives_are_refused(load: Load, create: Create, function: str) -> None:
    instance = create(load("Plant")).initialize()
    one = instance.references("tau[1]" if "Input" in function else "q[1]")
    order, value = array(ct.c_int, [1]), array(ct.c_double, [0.0])
    for arguments in ((None, 1, order, value), (one, 1, None, value), (one, 1, order, None)):
        assert "missing" in refused(instance, function, *arguments)
    assert instance.call(function, one, 1, order, value) == OK


@of_models
def test_10_missing_arrays_of_directions_are_refused(binary: Binary, create: Create) -> None:
    instance = create(binary).initialize()
    known = unknown = instance.references(binary.names("output")[0])
    value = array(ct.c_double, [0.0])
    for arguments in (
        (None, 1, known, 1, value, value),
        (unknown, 1, None, 1, value, value),
        (unknown, 1, known, 1, None, value),
        (unknown, 1, known, 1, value, None),
    ):
        assert "missing" in refused(instance, "fmi2GetDirectionalDerivative", *arguments)


def test_10_booleans_have_no_derivative(load: Load, create: Create) -> None:
    instance = create(load("CraigAdaptiveImpedance")).initialize()
    boolean, output = instance.references("saturated[1]"), instance.references("tau_cmd[1]")
    order, value = array(ct.c_int, [1]), array(ct.c_double, [0.0])
    assert "Boolean" in refused(instance, "fmi2GetDirectionalDerivative", output, 1, boolean, 1, value, value)
    assert "Boolean" in refused(instance, "fmi2GetDirectionalDerivative", boolean, 1, boolean, 1, value, value)
    assert "Boolean" in refused(instance, "fmi2GetRealOutputDerivatives", boolean, 1, order, value)


def test_11_time_stays_finite(load: Load, create: Create) -> None:
    """Found by the fuzzer: t and h are finite, t + h is not, and the last time was infinite after fmi2OK."""
    instance = create(load("ForceSensor"), start={"sample_time": 1.7e308}).initialize(t0=1.7e308)
    assert "1.69999" in refused(instance, "fmi2DoStep", 1.7e308, 1.7e308, 1)
