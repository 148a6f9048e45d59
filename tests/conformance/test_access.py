"""Tests of rule 10: a variable's value does not depend on the other variables of the same call, or their order.

Between steps the runtime has a quick way for neighbours in their order; all else goes the long way.
"""

import ctypes as ct
import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from fmus.catalog import MODELS
from tests.conformance.binary import ERROR, OK, Binary, Instance, array
from tests.conformance.scenes import H, scene

Create = Callable[..., Instance]


def selections(names: list[str]) -> Iterator[list[str]]:
    """Neighbours of every number, and what is nearly a run of neighbours."""
    for n in range(1, len(names) + 1):
        yield names[:n]
        yield names[-n:]
    yield names[::-1]
    yield names[::2]
    yield [names[0], names[0]]
    for i, j in itertools.combinations(range(len(names)), 2):
        swapped = names.copy()
        swapped[i], swapped[j] = swapped[j], swapped[i]
        yield swapped


def numbers(binary: Binary, causality: str) -> list[str]:
    """Real variables of a causality."""
    return binary.names(causality, type="Real")


def test_10_a_get_of_any_selection(binary: Binary, create: Create) -> None:
    instance = create(binary, start=scene(binary)).initialize()
    assert instance.step(2 * H) == OK
    names = [*numbers(binary, "parameter")[-3:], *numbers(binary, "input"), *numbers(binary, "output")]
    alone = {name: instance.get(name)[0] for name in names}
    for chosen in selections(names):
        values = array(ct.c_double, [np.nan] * len(chosen))
        assert instance.call("fmi2GetReal", instance.references(*chosen), len(chosen), values) == OK
        np.testing.assert_array_equal(list(values), [alone[name] for name in chosen])


@pytest.mark.parametrize("identifier", [name for name in MODELS if name != "VirtualTrajectory"])  # it has no inputs
def test_10_a_set_of_any_selection(binary: Binary, create: Create) -> None:
    names = numbers(binary, "input")
    instance = create(binary).initialize()
    for k, chosen in enumerate(selections(names)):
        expected = dict(zip(names, instance.get(*names), strict=True))
        values = {name: 0.5 + k + i for i, name in enumerate(chosen)}
        given = array(ct.c_double, [values[name] for name in chosen])
        assert instance.call("fmi2SetReal", instance.references(*chosen), len(chosen), given) == OK
        np.testing.assert_array_equal(instance.get(*names), list((expected | values).values()))


def test_10_a_run_that_leaves_its_kind_is_refused(binary: Binary, create: Create) -> None:
    """Inputs and the first output side by side; the last variable and what comes after it."""
    instance = create(binary).initialize()
    inputs, outputs = numbers(binary, "input"), numbers(binary, "output")
    before = instance.blob()
    references = instance.references(*inputs, outputs[0])
    status = instance.call("fmi2SetReal", references, len(references), array(ct.c_double, [1.0] * len(references)))
    assert status == ERROR
    assert instance.blob() == before
    last = max(v.valueReference for v in binary.variables.values())
    beyond = array(ct.c_uint, [last, last + 1])
    kind = next(v.type for v in binary.variables.values() if v.valueReference == last)
    c_type = ct.c_double if kind == "Real" else ct.c_int
    assert instance.call(f"fmi2Get{kind}", beyond, 2, array(c_type, [0, 0])) == ERROR
    assert f"{last + 1}" in instance.last


@pytest.mark.parametrize("phase", ["initialization mode", "step complete"])
def test_10_variables_of_another_type_are_refused(binary: Binary, create: Create, phase: str) -> None:
    """Read and written, alone and twice, by the functions of every other type."""
    instance = create(binary).to(phase)
    before = instance.blob()
    examples = {(v.type, v.causality): v for v in binary.variables.values() if v.causality != "independent"}
    assert "Real" in {kind for kind, _ in examples}
    for (kind, causality), variable in examples.items():
        for other, c_type in (("Real", ct.c_double), ("Integer", ct.c_int), ("Boolean", ct.c_int)):
            if other == kind:
                continue
            for action in ("Get", "Set") if causality != "output" else ("Get",):
                for n in (1, 2):
                    references = array(ct.c_uint, [variable.valueReference] * n)
                    status = instance.call(f"fmi2{action}{other}", references, n, array(c_type, [1] * n))
                    assert status == ERROR, f"fmi2{action}{other} of {variable.name}"
                    assert all(said in instance.last for said in (variable.name, f"a {kind}", f"a {other}"))
    assert instance.blob() == before


def test_10_more_variables_than_are_copied_at_once(tmp_path: Path, create: Create) -> None:
    """Every number of inputs and outputs up to 40; the runtime copies 24 with one jump."""
    model = SampledModel("Wide", "Doubles its inputs")
    u = model.input("u", [0.0] * 40, description="Signals")
    model.output("y", 2 * u, description="2 u")
    instance = create(Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")).initialize()
    inputs, outputs = numbers(instance.binary, "input"), numbers(instance.binary, "output")
    for n in range(1, 41):
        given = [float(10 * n + i) for i in range(n)]
        assert instance.call("fmi2SetReal", instance.references(*inputs[:n]), n, array(ct.c_double, given)) == OK
        assert instance.step(H) == OK
        values = array(ct.c_double, [np.nan] * n)
        assert instance.call("fmi2GetReal", instance.references(*outputs[:n]), n, values) == OK
        np.testing.assert_array_equal(list(values), 2 * np.array(given))
