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
                known = ", ".join(BASE_EXPONENTS)
                msg = f'Unit "{unit}": "{factor}" is no known symbol with exponent; known: {known}.'
                raise DefinitionError(msg)
            power = sign * int(match[2] or 1)
            for base, exponent in BASE_EXPONENTS[match[1]].items():
                exponents[base] = exponents.get(base, 0) + power * exponent
    return {base: exponents[base] for base in ("kg", "m", "s", "A", "K", "rad") if exponents.get(base)}
