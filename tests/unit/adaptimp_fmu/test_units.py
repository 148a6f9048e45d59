"""Tests of physical units as FMI 2.0 writes them."""

import pytest

from adaptimp_fmu import DefinitionError
from adaptimp_fmu.units import BASE_EXPONENTS, base_exponents, respelled


@pytest.mark.parametrize(
    ("unit", "exponents"),
    [
        ("", {}),
        ("1", {}),
        ("m", {"m": 1}),
        ("N", {"kg": 1, "m": 1, "s": -2}),
        ("N.m", {"kg": 1, "m": 2, "s": -2}),
        ("N/m", {"kg": 1, "s": -2}),
        ("N.s/m", {"kg": 1, "s": -1}),
        ("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("rad/s2", {"s": -2, "rad": 1}),
        ("1/s", {"s": -1}),
        ("s/m", {"m": -1, "s": 1}),
        ("kg.m2", {"kg": 1, "m": 2}),
        ("W/A2", {"kg": 1, "m": 2, "s": -3, "A": -2}),
        ("J/K", {"kg": 1, "m": 2, "s": -2, "K": -1}),
        ("m/m", {}),
        ("m10/s12", {"m": 10, "s": -12}),
    ],
)
def test_exponents_of_the_base_units(unit: str, exponents: dict[str, int]) -> None:
    assert base_exponents(unit) == exponents


def test_every_symbol_is_a_unit() -> None:
    for symbol, exponents in BASE_EXPONENTS.items():
        assert base_exponents(symbol) == exponents


def test_base_units_come_in_the_order_of_the_schema() -> None:
    assert list(base_exponents("rad.K.A.s.m.kg")) == ["kg", "m", "s", "A", "K", "rad"]


@pytest.mark.parametrize(
    ("unit", "fault"),
    [
        ("furlong", "furlong"),
        ("N.furlong/s", "furlong"),
        ("m/s/s", "s/s"),
        ("m^2", "m^2"),
        ("m-1", "m-1"),
        ("N*m", "N*m"),
        ("N m", "N m"),
        ("2", "2"),
        ("n", "n"),
        ("m.", ""),
        (".m", ""),
        ("N..m", ""),
        ("m/", ""),
        ("/s", ""),
        ("/", ""),
    ],
)
def test_what_is_no_unit_is_named(unit: str, fault: str) -> None:
    with pytest.raises(DefinitionError) as caught:
        base_exponents(unit)
    assert f'unit "{unit}": "{fault}" is not a known symbol' in str(caught.value)
    meant = respelled(unit)
    assert (f"did you mean {meant}?" if meant else "known: 1, kg, m, s") in str(caught.value)


@pytest.mark.parametrize(
    ("unit", "meant"),
    [
        *(("Nm", "N.m"), ("Nm/rad", "N.m/rad"), ("Nms/rad", "N.m.s/rad"), ("kgm2", "kg.m2"), ("n.m", "N.m")),
        *(("N*m", "N.m"), ("N m", "N.m"), ("m^2", "m2"), ("m/s**2", "m/s2"), ("RAD/S", "rad/s"), ("N/(m)", "N/m")),
        *(("furlong", None), ("m-1", None), ("m/", None), ("/s", None), ("", None), ("m2.5", None)),
    ],
)
def test_other_spellings_are_understood(unit: str, meant: str | None) -> None:
    assert respelled(unit) == meant
    if meant:
        assert base_exponents(meant)
