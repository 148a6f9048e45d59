"""Each function of the runtime is within 1 unit in the last place of the exact value, and faults are noticed."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.property.mathematics.exact import JUDGED, any_number, near_multiples, sizes
from tests.property.mathematics.judge import all_draws, worst_of
from tests.property.mathematics.library import RUNTIME, Mathematics

LARGEST = 1.0  # units in the last place
EXACT = 0.5  # of functions that are correctly rounded
COUNT, SEED = 1000, 1  # of each draw
ROUNDED = ("sqrt", "sqrt_of_integers")

# File, what stands in it, what takes its place, and the function that becomes wrong by more than a unit.
FAULTS = {
    "a digit of a coefficient": ("mathematics_tables.h", "0x1.111111110f87ap-7", "0x1.111111710f87ap-7", "sin"),
    "a digit of pi/2": ("mathematics_tables.h", "PI_HALF_2 0x1.0b4611a6", "PI_HALF_2 0x1.0b4611a7", "cos"),
    "a bit of 2/pi": ("mathematics_tables.h", "0xa2f9836e4e441529u", "0xa2f9836e4e441528u", "sin"),
    "a power of two": (
        "mathematics_tables.h",
        "EXP_STEP_2 0x1.473de6af278edp-39",
        "EXP_STEP_2 0x1.473de6bf278edp-39",
        "exp",
    ),
    "digits of log(2)": ("mathematics_tables.h", "LOG_2_LOW 0x1.cf79", "LOG_2_LOW 0x1.cf09", "log"),
    "the third part of pi/2 left out": ("trigonometry.h", "-(multiple * PI_HALF_3)", "-(multiple * 0)", "tan"),
    "few parts of pi/2 for large angles": ("trigonometry.h", "< 256", "< 1e9", "cos"),
    "one unit of the quadrant": ("trigonometry.h", "<< 61)) >> 62", "<< 60)) >> 62", "sin"),
    "the low half of a rest": ("trigonometry.h", "x.low * (1 - 0.5 * z)", "0 * (1 - 0.5 * z)", "sin"),
    "the low half of a power": ("logarithm.h", "e.terms += power.low", "e.terms += 0", "pow"),
    "the rest of a square root": ("real_pairs.h", "/ (2 * root)", "/ (-2 * root)", "acos"),
    "the rest of a quotient": ("real_pairs.h", "quotient, rest / y.high", "quotient, 0 * rest", "atan2"),
    "a limit of tanh": ("exponential.h", "size < 20", "size < 15", "tanh"),
    "cancellation in expm1": ("exponential.h", "power > 0.7 && power < 1.42", "0", "expm1"),
    "half of a last place": ("real_numbers.h", "(root + 1) >> 1", "(root + 0) >> 1", "sqrt_of_integers"),
}


def limit(name: str) -> float:
    """The largest error that a function may have."""
    return EXACT if name in ROUNDED else LARGEST


@pytest.mark.parametrize("name", JUDGED)
def test_errors_are_at_most_a_unit(mathematics: Mathematics, name: str) -> None:
    worst = worst_of(mathematics, name, JUDGED[name], all_draws(JUDGED[name], COUNT, SEED))
    assert worst.error <= limit(name), worst


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_noticed(fault: str, tmp_path: Path) -> None:
    file, text, wrong, name = FAULTS[fault]
    sources = tmp_path / "sources"
    shutil.copytree(RUNTIME, sources, ignore=shutil.ignore_patterns("*.c"))
    whole = (sources / file).read_text(encoding="utf-8")
    assert text in whole
    (sources / file).write_text(whole.replace(text, wrong), encoding="utf-8")
    worst = worst_of(Mathematics(tmp_path, sources), name, JUDGED[name], all_draws(JUDGED[name], COUNT, SEED))
    assert worst.error > limit(name)


def test_sine_and_cosine_of_one_call_are_those_of_two(mathematics: Mathematics) -> None:
    rng = np.random.default_rng(SEED)
    angles = np.concatenate(
        [any_number(rng, 5000), sizes(-60, 30)(rng, 5000), near_multiples(rng, 1000), [-0.0, np.inf]]
    )
    assert mathematics("sincos_sin", angles).tobytes() == mathematics("sin", angles).tobytes()
    assert mathematics("sincos_cos", angles).tobytes() == mathematics("cos", angles).tobytes()


@pytest.mark.parametrize("name", ["floor", "ceil"])
def test_rounding_to_integers_is_numpy_s(mathematics: Mathematics, name: str) -> None:
    rng = np.random.default_rng(SEED)
    numbers = np.concatenate(
        [any_number(rng, 5000), sizes(-3, 60)(rng, 5000), np.arange(-5, 5, 0.5), [-0.0, 0.0, np.inf]]
    )
    expected = getattr(np, name)(numbers)
    assert mathematics(name, numbers).tobytes() == expected.tobytes()


@pytest.mark.parametrize(("name", "theirs"), [("fmod", "fmod"), ("copysign", "copysign")])
def test_functions_with_one_answer_are_numpy_s(mathematics: Mathematics, name: str, theirs: str) -> None:
    rng = np.random.default_rng(SEED)
    x = np.concatenate([any_number(rng, 5000), sizes(-5, 30)(rng, 5000), sizes(-1074, -1010)(rng, 500)])
    y = np.concatenate([any_number(rng, 5000), sizes(-5, 30)(rng, 5000), sizes(-1074, -1010)(rng, 500)])
    assert mathematics(name, x, y).tobytes() == getattr(np, theirs)(x, y).tobytes()


def test_remainder_is_the_nearest_one(mathematics: Mathematics) -> None:
    rng = np.random.default_rng(SEED)
    x = np.concatenate([sizes(-5, 60)(rng, 5000), np.arange(-20, 20, 0.5), sizes(-1074, -1010)(rng, 500)])
    y = np.concatenate([sizes(-5, 5)(rng, 5000), np.full(80, 3.0), sizes(-1074, -1010)(rng, 500)])
    expected = np.array([math.remainder(a, b) for a, b in zip(x, y, strict=True)])
    assert mathematics("remainder", x, y).tobytes() == expected.tobytes()
