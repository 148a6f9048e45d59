"""Reads the names of physical units, such as ``kN``, ``N.m/rad``, ``deg/s`` or ``m/s^2``, that no FMU has to define.

A name is a product of symbols with integer exponents. Factors are joined by ``.``, ``*`` or a space; what follows a
``/`` is divided by. A symbol may have a prefix of the SI, such as ``k`` or ``m``.
"""

import math
import re
from collections.abc import Iterable, Mapping

from orchestration.fmi.units import BASE_UNITS, Unit, UnitDefinition

_SYMBOLS: dict[str, tuple[dict[str, int], float]] = {
    "1": ({}, 1.0),
    "g": ({"kg": 1}, 1e-3),
    **{base: ({base: 1}, 1.0) for base in BASE_UNITS},
    "N": ({"kg": 1, "m": 1, "s": -2}, 1.0),
    "J": ({"kg": 1, "m": 2, "s": -2}, 1.0),
    "W": ({"kg": 1, "m": 2, "s": -3}, 1.0),
    "Pa": ({"kg": 1, "m": -1, "s": -2}, 1.0),
    "Hz": ({"s": -1}, 1.0),
    "C": ({"A": 1, "s": 1}, 1.0),
    "V": ({"kg": 1, "m": 2, "s": -3, "A": -1}, 1.0),
    "Ohm": ({"kg": 1, "m": 2, "s": -3, "A": -2}, 1.0),
    "T": ({"kg": 1, "s": -2, "A": -1}, 1.0),
    "bar": ({"kg": 1, "m": -1, "s": -2}, 1e5),
}
_ALONE: dict[str, tuple[dict[str, int], float]] = {  # without a prefix
    "%": ({}, 1e-2),
    "deg": ({"rad": 1}, math.pi / 180),
    "°": ({"rad": 1}, math.pi / 180),
    "rev": ({"rad": 1}, 2 * math.pi),
    "rpm": ({"rad": 1, "s": -1}, 2 * math.pi / 60),
    "min": ({"s": 1}, 60.0),
    "h": ({"s": 1}, 3600.0),
    "t": ({"kg": 1}, 1e3),
}
_OFFSETS = {"degC": 273.15, "°C": 273.15}
_PREFIXES = {
    **{"n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1},
    **{"h": 1e2, "k": 1e3, "M": 1e6, "G": 1e9},
}
_WHOLE = ("1", "kg")  # take no prefix
_FACTOR = re.compile(r"(?P<symbol>[A-Za-zµ°%]+|1)\^?(?P<power>-?\d+)?")


def named_unit(name: str, defined: Iterable[Mapping[str, UnitDefinition]] = ()) -> UnitDefinition:
    """Return the unit of a name, as one of the given tables defines it, else by its symbols.

    Parameters
    ----------
    name
        Name of the unit.
    defined
        Units by name, such as those of FMUs; the first table that has the name decides.

    Returns
    -------
    UnitDefinition
        Its meaning is None if a symbol is unknown.
    """
    for table in defined:
        if name in table:
            return table[name]
    return UnitDefinition(name, _meaning(name))


def _meaning(name: str) -> Unit | None:
    """Return what a name stands for; None if it is not a product of known symbols."""
    if name in _OFFSETS:
        return Unit((("K", 1),), 1.0, _OFFSETS[name])
    exponents: dict[str, int] = dict.fromkeys(BASE_UNITS, 0)
    scale = 1.0
    for place, product in enumerate(name.split("/")):
        for text in re.split(r"\s*[.*]\s*|\s+", product.strip()):
            match = _FACTOR.fullmatch(text)
            found = match and _symbol(match["symbol"])
            if not (match and found):
                return None
            power = (-1 if place else 1) * int(match["power"] or 1)
            scale *= found[1] ** power
            for base, exponent in found[0].items():
                exponents[base] += power * exponent
    return Unit(tuple((base, power) for base, power in exponents.items() if power), scale)


def _symbol(text: str) -> tuple[dict[str, int], float] | None:
    """Return exponents and factor of a symbol with or without a prefix."""
    known = {**_SYMBOLS, **_ALONE}
    if text in known:
        return known[text]
    prefix, symbol = text[:1], text[1:]
    if prefix in _PREFIXES and symbol in _SYMBOLS and symbol not in _WHOLE:
        exponents, factor = _SYMBOLS[symbol]
        return exponents, _PREFIXES[prefix] * factor
    return None
