"""Values at zeros, infinities, NaN and the ends of a domain are those of C11, annex F."""

import math

import numpy as np
import pytest

from tests.property.mathematics.library import Mathematics

INF, NAN = math.inf, math.nan
PI, HALF, QUARTER, THREE_QUARTERS = math.pi, math.pi / 2, math.pi / 4, 2.356194490192345
TINY, LARGEST = 5e-324, 1.7976931348623157e308
THE_NAN = np.float64(np.uint64(0x7FF8000000000000).view(float)).tobytes()

ODD = ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "expm1", "log1p")
"""Functions that return a zero, and a subnormal number, as it is."""

# F.10.1 to F.10.9, in the order of the standard: function, argument, value.
OF_ONE = (
    *(("acos", 1.0, 0.0), ("acos", 1.5, NAN), ("acos", -INF, NAN), ("asin", 1.0000000000000002, NAN)),
    *(("atan", INF, HALF), ("atan", -INF, -HALF), ("cos", 0.0, 1.0), ("cos", -0.0, 1.0), ("cos", INF, NAN)),
    *(("sin", INF, NAN), ("sin", -INF, NAN), ("tan", INF, NAN), ("acosh", 1.0, 0.0), ("acosh", 0.5, NAN)),
    *(("acosh", -INF, NAN), ("acosh", INF, INF), ("asinh", INF, INF), ("asinh", -INF, -INF)),
    *(("atanh", 1.0, INF), ("atanh", -1.0, -INF), ("atanh", 1.5, NAN), ("atanh", -INF, NAN)),
    *(("cosh", 0.0, 1.0), ("cosh", -0.0, 1.0), ("cosh", INF, INF), ("cosh", -INF, INF), ("cosh", 711.0, INF)),
    *(("sinh", INF, INF), ("sinh", -INF, -INF), ("sinh", -711.0, -INF), ("tanh", INF, 1.0), ("tanh", -INF, -1.0)),
    *(("exp", 0.0, 1.0), ("exp", -0.0, 1.0), ("exp", -INF, 0.0), ("exp", INF, INF), ("exp", 710.0, INF)),
    *(("exp", -746.0, 0.0), ("exp", -745.1332191019411, TINY), ("exp", 709.782712893384, 1.7976931348622732e308)),
    *(("expm1", -INF, -1.0), ("expm1", INF, INF), ("expm1", -50.0, -1.0), ("expm1", 710.0, INF)),
    *(("log", 0.0, -INF), ("log", -0.0, -INF), ("log", 1.0, 0.0), ("log", -1.0, NAN), ("log", INF, INF)),
    *(("log", -INF, NAN), ("log1p", -1.0, -INF), ("log1p", -1.5, NAN), ("log1p", INF, INF), ("log1p", -INF, NAN)),
    *(("sqrt", 0.0, 0.0), ("sqrt", -0.0, -0.0), ("sqrt", INF, INF), ("sqrt", -1.0, NAN), ("sqrt", -INF, NAN)),
    *(("fabs", -0.0, 0.0), ("fabs", -INF, INF), ("floor", -0.0, -0.0), ("floor", INF, INF), ("floor", -0.5, -1.0)),
    *(
        ("ceil", -0.5, -0.0),
        ("ceil", -0.0, -0.0),
        ("ceil", -INF, -INF),
        ("ceil", 4503599627370495.5, 4503599627370496.0),
    ),
)
# F.10.1.4, F.10.4.3, F.10.4.4, F.10.7, F.10.8.1, F.10.9: function, arguments, value.
OF_TWO = (
    *(("atan2", 0.0, -0.0, PI), ("atan2", -0.0, -0.0, -PI), ("atan2", 0.0, 0.0, 0.0), ("atan2", -0.0, 0.0, -0.0)),
    *(("atan2", 0.0, -1.0, PI), ("atan2", -0.0, -1.0, -PI), ("atan2", 0.0, 1.0, 0.0), ("atan2", -0.0, 1.0, -0.0)),
    *(("atan2", -1.0, 0.0, -HALF), ("atan2", 1.0, -0.0, HALF), ("atan2", 1.0, -INF, PI), ("atan2", -1.0, -INF, -PI)),
    *(("atan2", 1.0, INF, 0.0), ("atan2", -1.0, INF, -0.0), ("atan2", INF, 1.0, HALF), ("atan2", -INF, -1.0, -HALF)),
    *(("atan2", INF, -INF, THREE_QUARTERS), ("atan2", -INF, -INF, -THREE_QUARTERS), ("atan2", INF, INF, QUARTER)),
    *(("atan2", TINY, LARGEST, 0.0), ("atan2", -TINY, LARGEST, -0.0), ("atan2", TINY, -LARGEST, PI)),
    *(("hypot", INF, NAN, INF), ("hypot", NAN, -INF, INF), ("hypot", 0.0, -2.0, 2.0), ("hypot", -0.0, 0.0, 0.0)),
    *(("hypot", LARGEST, LARGEST, INF), ("hypot", TINY, TINY, TINY), ("hypot", 3 * TINY, 4 * TINY, 5 * TINY)),
    *(("pow", 0.0, -3.0, INF), ("pow", -0.0, -3.0, -INF), ("pow", 0.0, -2.0, INF), ("pow", -0.0, -2.0, INF)),
    *(("pow", -0.0, -INF, INF), ("pow", -0.0, 3.0, -0.0), ("pow", 0.0, 3.0, 0.0), ("pow", -0.0, 2.5, 0.0)),
    *(("pow", -1.0, INF, 1.0), ("pow", -1.0, -INF, 1.0), ("pow", 1.0, NAN, 1.0), ("pow", NAN, 0.0, 1.0)),
    *(("pow", NAN, -0.0, 1.0), ("pow", -8.0, 1 / 3, NAN), ("pow", 0.5, -INF, INF), ("pow", 2.0, -INF, 0.0)),
    *(("pow", 0.5, INF, 0.0), ("pow", -2.0, INF, INF), ("pow", -INF, -3.0, -0.0), ("pow", -INF, -2.0, 0.0)),
    *(("pow", -INF, 3.0, -INF), ("pow", -INF, 2.5, INF), ("pow", INF, -1.0, 0.0), ("pow", INF, 1.0, INF)),
    *(("pow", -2.0, 3.0, -8.0), ("pow", 2.0, 1024.0, INF), ("pow", -2.0, -1075.0, -0.0), ("pow", -2.0, 1025.0, -INF)),
    *(("pow", 2.0, -1074.0, TINY), ("pow", 10.0, 22.0, 1e22), ("pow", 0.5, 1e300, 0.0), ("pow", 2.0, 1e300, INF)),
    *(("fmod", -0.0, 1.0, -0.0), ("fmod", 1.0, 0.0, NAN), ("fmod", INF, 1.0, NAN), ("fmod", -2.5, INF, -2.5)),
    *(("fmod", -6.0, 3.0, -0.0), ("fmod", LARGEST, TINY, 0.0), ("fmod", 5.5, -2.0, 1.5)),
    *(("remainder", 6.0, 4.0, -2.0), ("remainder", 2.0, 4.0, 2.0), ("remainder", -6.0, 3.0, -0.0)),
    *(("remainder", INF, 1.0, NAN), ("remainder", 1.0, 0.0, NAN), ("remainder", -2.5, INF, -2.5)),
    *(("copysign", 1.0, -0.0, -1.0), ("copysign", -INF, 1.0, INF), ("copysign", -0.0, 1.0, 0.0)),
    *(("fmax", NAN, 1.0, 1.0), ("fmax", 1.0, NAN, 1.0), ("fmax", -0.0, 0.0, 0.0), ("fmax", 0.0, -0.0, 0.0)),
    *(("fmin", NAN, 1.0, 1.0), ("fmin", 1.0, NAN, 1.0), ("fmin", -0.0, 0.0, -0.0), ("fmin", 0.0, -0.0, -0.0)),
    *(("fmax", -INF, 1.0, 1.0), ("fmin", INF, 1.0, 1.0), ("fmax", -0.0, -0.0, -0.0), ("fmin", 0.0, 0.0, 0.0)),
    *(("fmax", -2.0, -2.0, -2.0), ("fmin", -2.0, -2.0, -2.0), ("fmax", NAN, NAN, NAN), ("fmin", NAN, NAN, NAN)),
)


def same(found: float, expected: float) -> bool:
    """Whether two numbers are equal, the signs of zeros included; each NaN is the one of the runtime."""
    return np.float64(found).tobytes() == (THE_NAN if math.isnan(expected) else np.float64(expected).tobytes())


@pytest.mark.parametrize(("name", "x", "expected"), OF_ONE)
def test_functions_of_one_argument(mathematics: Mathematics, name: str, x: float, expected: float) -> None:
    found = mathematics(name, np.array([x]))[0]
    assert same(found, expected), found


@pytest.mark.parametrize(("name", "x", "y", "expected"), OF_TWO)
def test_functions_of_two_arguments(mathematics: Mathematics, name: str, x: float, y: float, expected: float) -> None:
    found = mathematics(name, np.array([x]), np.array([y]))[0]
    assert same(found, expected), found


@pytest.mark.parametrize("name", ODD)
def test_zeros_and_subnormal_numbers_return_as_they_are(mathematics: Mathematics, name: str) -> None:
    numbers = np.array([0.0, -0.0, TINY, -TINY, 2.2250738585072014e-308, -1e-310])
    assert mathematics(name, numbers).tobytes() == numbers.tobytes()


def test_a_nan_of_any_sign_becomes_the_one_nan(mathematics: Mathematics) -> None:
    several = np.array([0x7FF8000000000001, 0xFFF8000000000000, 0x7FF4000000000000], dtype=np.uint64).view(float)
    as_they_are = ("fabs", "copysign", "fmin", "fmax", "sqrt_of_integers")
    for name in set(mathematics.names) - set(as_they_are):
        found = mathematics(name, several, np.full(3, 2.0))
        assert {value.tobytes() for value in found} == {THE_NAN}, name
