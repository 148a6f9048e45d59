"""Physical units as FMI 2.0 writes them: a name and its exponents of the SI base units.

A unit is a product of symbols with optional integer exponents, at most one ``/`` and factors
joined by ``.``: ``N.m``, ``rad/s2``, ``N.m.s/rad``, ``1/s``. All are coherent, so the factor to
base units is 1.
"""

import re

from adaptimp_fmu.errors import DefinitionError

BASE_EXPONENTS: dict[str, dict[str, int]] = {
    "1": {},
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "rad": {"rad": 1},
    "A": {"A": 1},
    "K": {"K": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
}
# Units that measure one thing here; those of gains, which measure many, have no name.
QUANTITIES = {
    "kg": "Mass",
    "m": "Length",
    "m/s": "Velocity",
    "m/s2": "Acceleration",
    "rad": "Angle",
    "rad/s": "AngularVelocity",
    "rad/s2": "AngularAcceleration",
    "s": "Time",
    "N": "Force",
    "N.m": "Torque",
    "N/m": "TranslationalStiffness",
    "N.s/m": "TranslationalDamping",
    "N.m.s/rad": "RotationalDamping",
}
_FACTOR = re.compile(r"([A-Za-z]+|1)(\d*)")
_OTHER_PRODUCTS = re.compile(r"\s*[*·⋅\s]\s*")
_OTHER_POWERS = re.compile(r"\^|\*\*")


def base_exponents(unit: str) -> dict[str, int]:
    """Return the exponents of the SI base units in a physical unit.

    Parameters
    ----------
    unit
        For example ``"N.m.s/rad"``; the empty text for a number without unit.

    Returns
    -------
    dict
        Base unit to non-zero exponent, in the order of the schema's attributes.

    Raises
    ------
    DefinitionError
        If a symbol is unknown or the text is not a unit.
    """
    numerator, slash, denominator = unit.partition("/")
    products = [(1, numerator)] if unit else []
    if slash:
        products.append((-1, denominator))
    exponents: dict[str, int] = {}
    for sign, product in products:
        for factor in product.split("."):
            match = _FACTOR.fullmatch(factor)
            if match is None or match[1] not in BASE_EXPONENTS:
                meant = respelled(unit)
                known = f"known: {', '.join(BASE_EXPONENTS)}."
                help_ = f"did you mean {meant}?" if meant else known
                msg = f'unit "{unit}": "{factor}" is not a known symbol with exponent; {help_}'
                raise DefinitionError(msg)
            power = sign * int(match[2] or 1)
            for base, exponent in BASE_EXPONENTS[match[1]].items():
                exponents[base] = exponents.get(base, 0) + power * exponent
    return {base: exponents[base] for base in ("kg", "m", "s", "A", "K", "rad") if exponents.get(base)}


def respelled(unit: str) -> str | None:
    """Return the unit that a text of another spelling means, such as ``N.m`` for ``Nm``; None if it means none.

    Other spellings have ``*`` for a product or nothing at all, ``^`` for a power, or letters of another case.
    """
    text = _OTHER_PRODUCTS.sub(".", _OTHER_POWERS.sub("", unit.strip()))
    numerator, slash, denominator = text.partition("/")
    products = [numerator, denominator] if slash else [numerator]
    spelled = [_factors(product.strip("()")) for product in products]
    if not all(spelled):
        return None
    return "/".join(filter(None, spelled))


def _factors(product: str) -> str | None:
    """A product of symbols with points between them; None if a part is not a symbol."""
    found = []
    for factor in product.split("."):
        parts = _split(factor)
        if parts is None:
            return None
        found += parts
    return ".".join(found)


def _split(text: str) -> list[str] | None:
    """Symbols with exponents that a text without points is made of, the longest first; None if there are others."""
    if not text:
        return []
    of_length = range(len(text), 0, -1)
    for head, tail in ((text[:n], text[n:]) for n in of_length):
        match = _FACTOR.fullmatch(head)
        symbol = _spelled_symbol(match[1]) if match else None
        if match is not None and symbol is not None and not tail[:1].isdigit():
            rest = _split(tail)
            if rest is not None:
                return [symbol + match[2], *rest]
    return None


def _spelled_symbol(text: str) -> str | None:
    """The symbol that a text means, if need be in another case."""
    if text in BASE_EXPONENTS:
        return text
    same = [symbol for symbol in BASE_EXPONENTS if symbol.lower() == text.lower()]
    return same[0] if len(same) == 1 else None
