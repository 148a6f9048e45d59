"""Rule 11, numbers that C cannot calculate with: a divisor of zero, Integers that are none."""

import math
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import pytest

from adaptimp_fmu import Limits, SampledModel, Type, build
from adaptimp_fmu.sampled_model import SampledModel as Declared
from tests.conformance.binary import ERROR, OK, Binary, Instance, require_ok
from tests.conformance.calls import assert_refused
from tests.conformance.scenes import H

Create = Callable[..., Instance]
FEW = 20  # ticks


def binary_of(model: SampledModel, folder: Path) -> Binary:
    """The model's FMU, built and loaded."""
    return Binary(build(model, folder, cache=folder / "cache"), folder / "unpacked")


def slow(limits: Limits) -> SampledModel:
    """A state that counts its updates, one at every n-th tick."""
    model = SampledModel("Slow", "Counts slowly", sample_time=H)
    x = model.state("x", ca.SX(0.0))
    model.parameter("n", 3, type=Type.INTEGER, limits=limits, tunable=True, description="Ticks per update")
    model.output("x", x, description="Updates before this tick", scalar=True)
    model.update_slowly(x, x + 1, divisor="n")
    return model


@pytest.mark.parametrize("n", [0, -1, -(2**31)])
def test_a_divisor_below_one_is_an_error_of_the_call(tmp_path: Path, create: Create, n: int) -> None:
    instance = create(binary_of(slow(Limits(1)), tmp_path)).initialize()
    assert_refused(instance, instance.set({"n": n}), instance.blob(), f"n = {n}")
    for _ in range(FEW):
        assert instance.step(H) == OK
    assert instance.get("x") == [(FEW - 1 + 2) // 3]  # updates after ticks 0, 3, 6, ..., shown one tick later


@pytest.mark.parametrize("n", [0, -1])
def test_so_it_is_where_the_table_of_limits_allows_it(
    tmp_path: Path, create: Create, monkeypatch: pytest.MonkeyPatch, n: int
) -> None:
    """The runtime does not trust the table with a division: sources are there to be changed."""
    monkeypatch.setattr(Declared, "_require_divisor", lambda *_: None)
    instance = create(binary_of(slow(Limits(-10)), tmp_path))
    assert_refused(instance, instance.set({"n": n}), instance.blob(), f"n = {n}", "at least 1")
    instance.initialize()
    assert_refused(instance, instance.set({"n": n}), instance.blob(), f"n = {n}", "at least 1")
    assert instance.step(H) == OK


def rounded() -> SampledModel:
    """An Integer and a Boolean output that show an input as it is."""
    model = SampledModel("Rounded", "Shows its input as an Integer and as a Boolean", sample_time=H)
    u = model.input("u", 1.0, description="Input")
    model.output("n", u, type=Type.INTEGER, description="The input as an Integer", scalar=True)
    model.output("b", u, type=Type.BOOLEAN, description="Whether the input is not zero", scalar=True)
    return model


@pytest.fixture
def shown(tmp_path: Path, create: Create) -> Instance:
    """An instance of that model in initialization mode."""
    return create(binary_of(rounded(), tmp_path)).enter()


@pytest.mark.parametrize("value", [-(2.0**31), -1.0, 0.0, 7.0, 2.0**31 - 1])
def test_outputs_that_are_integers_are_shown(shown: Instance, value: float) -> None:
    require_ok(shown.set({"u": value}), shown)
    assert list(shown.get("n", "b")) == [value, value != 0]
    require_ok(shown.call("fmi2ExitInitializationMode"), shown)
    assert shown.step(H) == OK
    assert list(shown.get("n", "b")) == [value, value != 0]


@pytest.mark.parametrize("value", [2.0**31, -(2.0**31) - 1, 1e300, 0.5, 7 + 1e-9])
def test_integer_outputs_that_are_none_are_errors(shown: Instance, value: float) -> None:
    """C would cut 0.5 to 0 without a word, and may do anything with 1e300."""
    require_ok(shown.set({"u": value}), shown)
    with pytest.raises(RuntimeError, match=r"fmi2GetInteger: n = .* is not an Integer"):
        shown.get("n")
    assert shown.get("b") == [True]
    assert shown.call("fmi2ExitInitializationMode") == ERROR
    assert f"Output n is {value:.17g} at t = 0 s; an Integer is a whole number" in shown.last
    require_ok(shown.set({"u": 1.0}), shown)
    require_ok(shown.call("fmi2ExitInitializationMode"), shown)
    require_ok(shown.set({"u": value}), shown)
    assert shown.step(H) == ERROR
    assert "Output n is" in shown.last


def test_an_integer_that_is_not_a_number_is_no_integer(shown: Instance) -> None:
    require_ok(shown.set({"u": math.nan}), shown)
    with pytest.raises(RuntimeError, match=r"fmi2GetInteger: n = .*nan.* is not an Integer"):
        shown.get("n")
