"""Names of units that no FMU defines are read by their symbols."""

import math

import pytest

from orchestration.fmi.unit_names import named_unit
from orchestration.fmi.units import Unit, UnitDefinition, conversion

FACTORS = [
    ("kN", "N", 1e3),
    ("mm", "m", 1e-3),
    ("deg", "rad", math.pi / 180),
    ("deg/s", "rad/s", math.pi / 180),
    ("rpm", "rad/s", math.pi / 30),
    ("g", "kg", 1e-3),
    ("t", "kg", 1e3),
    ("min", "s", 60.0),
    ("ms", "s", 1e-3),
    ("kN.m", "N.m", 1e3),
    ("N mm", "N.m", 1e-3),
    ("m/s^2", "m/s2", 1.0),
    ("m.s-2", "m/s2", 1.0),
    ("m/s/s", "m/s2", 1.0),
    ("km/h", "m/s", 1e3 / 3600),
    ("J", "N.m", 1.0),
    ("%", "1", 1e-2),
    ("cm2", "m2", 1e-4),
    ("MPa", "N/m2", 1e6),
]


@pytest.mark.parametrize(("given", "wanted", "factor"), FACTORS)
def test_a_unit_is_a_product_of_symbols(given: str, wanted: str, factor: float) -> None:
    found = conversion(named_unit(given), named_unit(wanted))
    assert found == (pytest.approx(factor, rel=1e-15), 0.0)


def test_temperatures_have_an_offset() -> None:
    assert conversion(named_unit("degC"), named_unit("K")) == (1.0, 273.15)
    assert conversion(named_unit("degC"), named_unit("K"), relative=True) == (1.0, 0.0)


@pytest.mark.parametrize("name", ["furlong", "kkg", "N..m", "m/", "s2m", "k", "kdeg", "1k"])
def test_what_is_not_a_product_of_symbols_has_no_meaning(name: str) -> None:
    assert named_unit(name).meaning is None


def test_a_definition_decides_over_symbols() -> None:
    own = UnitDefinition("kN", Unit((("m", 1),), 2.0))
    assert named_unit("kN", [{}, {"kN": own}]) is own


def test_different_dimensions_do_not_convert() -> None:
    assert conversion(named_unit("N"), named_unit("N.m")) is None
