"""The exact values of the functions, from mpmath, and the arguments at which they are asked for."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from mpmath import mp, mpf

LARGE_ANGLE = float.fromhex("0x1.921fb5p20")
"""From here on angles are reduced with integers (trigonometry.h)."""
BITS = 160
"""Precision of mpmath: 107 bits behind a double's."""
LARGEST = mpf(2) ** 1024
Draw = Callable[[np.random.Generator, int], np.ndarray]


@dataclass(frozen=True)
class Judged:
    """A function, its exact value, and where to ask for it.

    Attributes
    ----------
    exact
        The function in mpmath.
    draws
        Each draws n arguments, of shape (n,), or (n, 2) for two arguments.
    hard
        Arguments that are known to be difficult.
    wide
        The same function for numpy's long doubles, or "" if there is none.
    """

    exact: Callable[..., Any]
    draws: Sequence[Draw]
    hard: Sequence[float | tuple[float, float]] = ()
    wide: str = ""


def error(exact: mpf, found: float) -> float:
    """How many units in the last place of the exact value a number is off; infinite if it is of another kind."""
    if math.isnan(found):
        return math.inf
    if math.isinf(found):  # right from the middle between the largest double and 2^1024 on
        return 0.0 if abs(exact) >= LARGEST - mpf(2) ** 970 and (exact > 0) == (found > 0) else math.inf
    return float(abs(mpf(found) - exact) / unit(exact))


def unit(value: mpf) -> mpf:
    """The unit in the last place of a double near a number."""
    if value == 0:
        return mpf(2) ** -1074
    _, exponent = mpmath.frexp(value)
    return mpf(2) ** max(int(exponent) - 53, -1074)


def any_number(rng: np.random.Generator, n: int) -> np.ndarray:
    """Finite doubles with random bits: every exponent is as likely as the others."""
    numbers = rng.integers(0, 2**64, 2 * n + 10, dtype=np.uint64).view(float)
    return numbers[np.isfinite(numbers)][:n]


def sizes(low: float, high: float, *, signed: bool = True) -> Draw:
    """Numbers whose size is between 2^low and 2^high, each exponent as likely as the others."""

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        sign = rng.choice([-1.0, 1.0], n) if signed else 1.0
        return sign * np.ldexp(rng.uniform(1, 2, n), rng.integers(math.floor(low), math.ceil(high), n))

    return draw


def between(low: float, high: float) -> Draw:
    """Numbers that are spread evenly."""
    return lambda rng, n: rng.uniform(low, high, n)


def near(centre: float, low: float, high: float) -> Draw:
    """Numbers that are apart from a number by 2^low to 2^high."""
    return lambda rng, n: centre + sizes(low, high)(rng, n)


def pairs(first: Draw, second: Draw) -> Draw:
    """Two arguments."""
    return lambda rng, n: np.column_stack([first(rng, n), second(rng, n)])


def near_multiples(rng: np.random.Generator, n: int) -> np.ndarray:
    """The doubles next to multiples of pi/2, up to the largest, and their neighbours."""
    with mp.workprec(1300):
        exponents = rng.integers(0, 1023, n)
        multiples = [mpmath.nint(mpf(2) ** int(e) * mpf(rng.uniform(1, 2)) / (mp.pi / 2)) for e in exponents]
        numbers = np.array([float(m * mp.pi / 2) for m in multiples])
    return numbers + rng.integers(-1, 2, n) * np.spacing(numbers)


def inside(draw: Draw, low: float, high: float) -> Draw:
    """Those of the numbers that are in a range, ends included."""

    def drawn(rng: np.random.Generator, n: int) -> np.ndarray:
        numbers = draw(rng, n)
        return numbers[(numbers >= low) & (numbers <= high)]

    return drawn


# The reduced argument of the first is the smallest of all doubles (V. Lefevre; J.-M. Muller, "Elementary
# functions", 3rd edition, table 11.1: 2^-60.9 pi/2); the others are next to the limits between two reductions.
ANGLES = (
    *(math.ldexp(6381956970095103, 797), math.ldexp(5293122909000000, 500), 1e22, 1.7976931348623157e308),
    *(math.pi / 4, math.nextafter(math.pi / 4, 1), 402.1238596594935, 402.0, 255.5 * math.pi / 2, 256.5 * math.pi / 2),
    *(1647099.0, 1647098.9999, math.nextafter(LARGE_ANGLE, 0), LARGE_ANGLE, 2.0**-27, math.nextafter(2.0**-27, 0)),
    *(5e-324, 2.2250738585072014e-308, 11 * math.pi / 2, 355.0, 103993.0, 52174 * math.pi / 2),
)
_ANGLES = (any_number, sizes(-30, 21), between(-10, 10), near_multiples)
_POSITIVE = (sizes(-1074, 1024, signed=False), between(0.5, 2.0), near(1.0, -53, -6))
_EXPONENTS = (709.782712893384, 709.7827128933841, -708.3964185322641, -745.1332191019411, -745.1332191019412)
_TO_ONE = (sizes(-60, 0), between(-1, 1), inside(near(1.0, -53, -2), 0, math.nextafter(1, 0)))
_EXTREMES = (5e-324, 1.7976931348623157e308)

JUDGED = {
    "sin": Judged(mp.sin, _ANGLES, ANGLES, "sin"),
    "cos": Judged(mp.cos, _ANGLES, ANGLES, "cos"),
    "tan": Judged(mp.tan, _ANGLES, ANGLES, "tan"),
    "exp": Judged(mp.exp, (between(-746, 711), sizes(-60, 9), between(-1, 1)), _EXPONENTS, "exp"),
    "expm1": Judged(
        mpmath.expm1, (sizes(-60, 9), between(-2, 2), between(-45, 62)), (0.35, -0.35, -40.0, 58.0), "expm1"
    ),
    "log": Judged(mpmath.log, _POSITIVE, (5e-324, 1.7976931348623157e308, 1.0), "log"),
    "log1p": Judged(
        mpmath.log1p,
        (
            sizes(-60, 1023, signed=False),
            between(-0.999, 3),
            inside(near(-1.0, -53, -1), math.nextafter(-1, 0), 0),
            inside(sizes(-60, 0), -0.9999, 1),
        ),
        (2.0**-54, 2.0**-53, -(2.0**-53), 2.0**100, math.nextafter(-1, 0)),
        "log1p",
    ),
    "tanh": Judged(mp.tanh, (sizes(-60, 5), between(-1, 1), between(-21, 21)), (0.55, 20.0, 5e-324), "tanh"),
    "sinh": Judged(mp.sinh, (sizes(-60, 9), between(-1, 1), between(-45, 45)), (0.35, 40.0, 710.4758600739439), "sinh"),
    "cosh": Judged(mp.cosh, (sizes(-60, 9), between(-1, 1), between(-45, 45)), (40.0, 710.4758600739439), "cosh"),
    "asin": Judged(mp.asin, _TO_ONE, (0.5, 1.0, -1.0), "arcsin"),
    "acos": Judged(mp.acos, _TO_ONE, (0.5, -0.5, -1.0), "arccos"),
    "atan": Judged(mp.atan, (sizes(-1074, 65), between(-3, 3)), (1.0, 2.0**60, 1 / 32, 3 / 32), "arctan"),
    "asinh": Judged(mp.asinh, (sizes(-60, 1023), between(-3, 3)), (2.0**-10, 2.0**30, 2.0**-28), "arcsinh"),
    "acosh": Judged(mp.acosh, (inside(near(1.0, -52, 1023), 1, 1e308), between(1, 5)), (1.0, 2.0**30), "arccosh"),
    "atanh": Judged(mp.atanh, _TO_ONE, (2.0**-10,), "arctanh"),
    "sqrt": Judged(mp.sqrt, (sizes(-1074, 1024, signed=False),), _EXTREMES, "sqrt"),
    "sqrt_of_integers": Judged(mp.sqrt, (sizes(-1074, 1024, signed=False),), _EXTREMES, "sqrt"),
    "hypot": Judged(
        mp.hypot,
        (
            *(pairs(any_number, any_number), pairs(sizes(-3, 3), sizes(-3, 3))),
            *(pairs(sizes(-1074, -1000), sizes(-1074, -1000)), pairs(sizes(1000, 1024), sizes(1000, 1024))),
        ),
        ((3.0, 4.0), (1.0, 2.0**-60)),
        "hypot",
    ),
    "atan2": Judged(
        mp.atan2,
        (
            *(pairs(any_number, any_number), pairs(sizes(-3, 3), sizes(-3, 3)), pairs(between(-1, 1), between(-1, 1))),
            *(pairs(sizes(-1074, -1000), sizes(-1074, -1)), pairs(sizes(-40, 40), sizes(-40, 40))),
        ),
        ((1.0, 1.0), (1.0, -1.0), (5e-324, 1.0), (5e-324, -1.0)),
        "arctan2",
    ),
    "pow": Judged(
        mp.power,
        (
            *(pairs(sizes(-3, 3, signed=False), between(-300, 300)), pairs(between(0, 10), between(-3, 3))),
            *(pairs(sizes(-1074, 1024, signed=False), between(-1.1, 1.1)), pairs(near(1.0, -50, -5), sizes(5, 60))),
        ),
        ((2.0, 0.5), (10.0, 22.0), (1.0000000000000002, 2.0**61), (5e-324, 0.25)),
        "power",
    ),
}
