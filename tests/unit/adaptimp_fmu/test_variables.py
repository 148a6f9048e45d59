"""Tests of the declaration of a variable: what it refuses."""

import math
from typing import Any

import pytest

from adaptimp_fmu import DefinitionError, Role, Type, Variable
from adaptimp_fmu.variables import element_names


def variable(**changes: Any) -> Variable:
    """A good variable, but for the changes."""
    good = {
        "name": "q[1]",
        "role": Role.FIXED_PARAMETER,
        "type": Type.REAL,
        "unit": "rad",
        "description": "Joint angle",
        "start": 1.0,
        "minimum": 0.0,
        "maximum": 2.0,
    }
    return Variable(**(good | changes))


@pytest.mark.parametrize("name", ["q", "q[1]", "dx_v[12]", "_x", "K2"])
def test_structured_names_are_fine(name: str) -> None:
    assert variable(name=name).name == name


@pytest.mark.parametrize(
    "name",
    [
        "",
        "1q",
        "q[0]",
        "q[01]",
        "q[]",
        "q[1][2]",
        "q[1,]",
        "q[1,0]",
        "q[1, 2]",
        "q.x",
        "q 1",
        "q-1",
        "q[1",
        "q]",
        "q\n",
        "é",
        "qé",
        "q[\u0661]",
    ],
)
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(DefinitionError, match="not a structured FMI name") as caught:
        variable(name=name)
    assert repr(name) in str(caught.value)


def test_description_is_needed() -> None:
    with pytest.raises(DefinitionError, match=r"q\[1\]: a description is missing"):
        variable(description="")


@pytest.mark.parametrize("type", [Type.INTEGER, Type.BOOLEAN])
def test_only_reals_have_units(type: Type) -> None:
    with pytest.raises(DefinitionError, match=f"only a Real has a unit, this is a {type.value} in rad"):
        variable(type=type)


@pytest.mark.parametrize("start", [-1e-9, 2.0000001])
def test_start_outside_its_limits_is_refused_with_all_three_values(start: float) -> None:
    with pytest.raises(DefinitionError) as caught:
        variable(start=start)
    assert str(caught.value) == f"q[1]: start {start!r} must be from 0 to 2 rad."


@pytest.mark.parametrize(
    ("minimum", "maximum", "words"),
    [
        *(
            (0.0, math.inf, "at least 0 rad"),
            (-math.inf, 0.1, "at most 0.1 rad"),
            (1e-12, 1e16, "from 1e-12 to 1e+16 rad"),
        ),
        (-math.inf, math.inf, ""),
    ],
)
def test_a_range_is_said_as_people_do(minimum: float, maximum: float, words: str) -> None:
    assert variable(start=None, minimum=minimum, maximum=maximum).range == words


def test_a_unit_is_checked_where_it_is_declared() -> None:
    with pytest.raises(DefinitionError, match=r'q\[1\]: unit "Nm": .*; did you mean N\.m\?'):
        variable(unit="Nm")


@pytest.mark.parametrize(("unit", "coherent"), [("deg", "rad"), ("rpm", "rad/s"), ("mm", "m"), ("kN/m", "N/m")])
def test_a_unit_that_is_not_coherent_is_a_display_unit(unit: str, coherent: str) -> None:
    with pytest.raises(DefinitionError, match=f'declare unit="{coherent}" with display_unit="{unit}"'):
        variable(unit=unit)


@pytest.mark.parametrize("start", [0.0, 1.0, 2.0, None])
def test_limits_are_closed(start: float | None) -> None:
    assert variable(start=start).start == start


@pytest.mark.parametrize("start", [math.inf, -math.inf, math.nan])
def test_start_must_be_finite(start: float) -> None:
    for bound in (2.0, math.inf):
        with pytest.raises(DefinitionError, match=rf"q\[1\]: start {start!r} is not of type Real"):
            variable(start=start, minimum=-bound, maximum=bound)


@pytest.mark.parametrize(
    ("type", "start"),
    [
        *((Type.INTEGER, 0.5), (Type.INTEGER, 1 + 1e-12), (Type.INTEGER, 2.0**31), (Type.INTEGER, -1e300)),
        *((Type.BOOLEAN, 0.5), (Type.BOOLEAN, 2.0)),
    ],
)
def test_start_must_be_of_its_type(type: Type, start: float) -> None:
    """In C all starts are doubles, in XML they are written by type: they must agree."""
    with pytest.raises(DefinitionError, match=f"is not of type {type.value}"):
        variable(type=type, unit="", start=start, minimum=-math.inf, maximum=math.inf)


@pytest.mark.parametrize(("type", "start"), [(Type.INTEGER, -3.0), (Type.BOOLEAN, 0.0), (Type.BOOLEAN, 1.0)])
def test_whole_numbers_and_truth_values_are_fine(type: Type, start: float) -> None:
    assert variable(type=type, unit="", start=start, minimum=-10.0, maximum=10.0).start == start


def test_elements_are_counted_from_one() -> None:
    assert element_names("q", None) == ["q"]
    assert element_names("q", 3) == ["q[1]", "q[2]", "q[3]"]
