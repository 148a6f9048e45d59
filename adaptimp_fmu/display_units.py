"""Units that people read values in, such as degrees: FMI 2.0 calls them display units.

A value stands in its unit, which is coherent with the SI. A tool may show the value in the display unit of its
variable (FMI 2.0.5, section 2.2.2):

    shown value = factor * value + offset

A display unit is a unit whose symbols may have a prefix, as in ``mm``, ``kN/m`` and ``kN.mm``, or a symbol of
`SYMBOLS`, as in ``deg/s`` and ``rpm``.
"""

import math
import re
from dataclasses import dataclass

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.names import suggestion
from adaptimp_fmu.units import BASE_EXPONENTS, base_exponents

PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9}
SYMBOLS = {
    "deg": (math.pi / 180, "rad"),
    "rpm": (2 * math.pi / 60, "rad/s"),
    "rev": (2 * math.pi, "rad"),
    "min": (60.0, "s"),
    "h": (3600.0, "s"),
    "g": (1e-3, "kg"),
    "t": (1e3, "kg"),
    "percent": (1e-2, "1"),
}
"""Size of a symbol in a coherent unit."""
CELSIUS, ZERO_CELSIUS = "degC", 273.15  # K
_PREFIXED = ("g", "m", "s", "A", "N", "J", "W")
_FACTOR = re.compile(r"([A-Za-z]+|1)(\d*)")


@dataclass(frozen=True)
class DisplayUnit:
    """A display unit: the coherent unit of its dimension, and how a value in that unit is shown."""

    name: str
    coherent: str
    factor: float
    offset: float = 0.0


def display_unit(name: str) -> DisplayUnit:
    """Return the display unit of a name.

    Raises
    ------
    DefinitionError
        If the text is not a product of known symbols.
    """
    if name == CELSIUS:
        return DisplayUnit(name, "K", 1.0, -ZERO_CELSIUS)
    numerator, slash, denominator = name.partition("/")
    sizes, above, below = {1: 1.0, -1: 1.0}, [], []
    for product, power in ((numerator, 1), (denominator, -1)):
        for factor in product.split(".") if power == 1 or slash else ():
            match = _FACTOR.fullmatch(factor)
            found = _symbol(match[1]) if match else None
            if match is None or found is None:
                known = [*SYMBOLS, CELSIUS, *BASE_EXPONENTS, *(f"{p}{s}" for p in PREFIXES for s in _PREFIXED)]
                msg = f'display unit "{name}": "{factor}" is not known; {suggestion(factor, known)}'
                raise DefinitionError(msg)
            sizes[power] *= found[0] ** int(match[2] or 1)
            top, _, bottom = found[1].partition("/")
            (above if power == 1 else below).append(top + match[2])
            if bottom:
                (below if power == 1 else above).append(bottom + match[2])
    above = [symbol for symbol in above if symbol != "1"] or ["1"]
    coherent = ".".join(above) + ("/" + ".".join(below) if below else "")
    return DisplayUnit(name, coherent, sizes[-1] / sizes[1])


def require_display_unit(name: str, unit: str) -> None:
    """Refuse a display unit that is unknown, or whose dimension is not that of the unit.

    Raises
    ------
    DefinitionError
    """
    found = display_unit(name)
    if base_exponents(found.coherent) != base_exponents(unit):
        given = f"in {unit}" if unit else "without a unit"
        msg = f'display unit "{name}" shows values in {found.coherent}, but the variable is {given}.'
        raise DefinitionError(msg)


def advice(unit: str) -> str:
    """A sentence's end for a text that is not a coherent unit, but may be a display unit; empty if it is not."""
    try:
        found = display_unit(unit)
    except DefinitionError:
        return ""
    return f'values are in SI units; declare unit="{found.coherent}" with display_unit="{unit}".'


def _symbol(text: str) -> tuple[float, str] | None:
    """Size of a symbol and its coherent unit; None if the symbol is unknown."""
    if text in BASE_EXPONENTS:
        return 1.0, text
    if text in SYMBOLS:
        return SYMBOLS[text]
    prefix, symbol = text[:1], text[1:]
    if prefix not in PREFIXES or symbol not in _PREFIXED:
        return None
    size, coherent = SYMBOLS.get(symbol, (1.0, symbol))
    return PREFIXES[prefix] * size, coherent
