"""Units of products, as of an adaptation gain that couples two parameters."""

import re
from collections import Counter
from collections.abc import Sequence

_FACTOR = re.compile(r"([A-Za-z]+)(\d*)")
_ORDER = ("kg", "N", "m", "s", "rad")


def product_unit(*units: str) -> str:
    """Unit of a product.

    Parameters
    ----------
    units
        Units of the factors in kg, N, m, s and rad, such as ``N.m.s/rad``. A divisor is written as ``1/N.m``.

    Returns
    -------
    str
        The product with the symbols in that order. Newtons do not stand below the line: 1/N is s2/kg.m.
    """
    exponents: Counter[str] = Counter()
    for unit in units:
        above, _, below = unit.partition("/")
        for sign, factors in ((1, above), (-1, below)):
            for symbol, power in _FACTOR.findall(factors):
                exponents[symbol] += sign * int(power or 1)
    if exponents["N"] < 0:
        newtons = exponents.pop("N")
        exponents.update({"kg": newtons, "m": newtons, "s": -2 * newtons})
    above, below = (_factors(exponents, sign) for sign in (1, -1))
    return f"{above or 1}/{below}" if below else above


def gain_units(parameters: Sequence[str], per: str) -> list[list[str]]:
    """Units of an adaptation gain, shape (r, r): of two parameters and of the divisor `per`, such as ``1/N.m``."""
    return [[product_unit(one, other, per) for other in parameters] for one in parameters]


def _factors(exponents: Counter[str], sign: int) -> str:
    """The symbols on one side of the line."""
    powers = [(symbol, sign * exponents[symbol]) for symbol in _ORDER if sign * exponents[symbol] > 0]
    return ".".join(f"{symbol}{power if power > 1 else ''}" for symbol, power in powers)
