"""Values of a factor as short texts: ranges and lists for grids, distributions for samples.

1e4:1e6:9          9 levels at equal distances, both ends included
1e4:1e6:9log       9 levels at equal ratios, both ends included
50,100,200         these levels; items of Enumerations and true, false go by their names
1-30               whole numbers, both ends included; for seeds
1e4:1e6            uniform between both ends; for samples
1e4:1e6 log        the logarithm is uniform; for samples
normal(1, 0.1)     also uniform(a, b) and loguniform(a, b); for samples
"""

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence, Sized
from dataclasses import dataclass
from typing import Any

import numpy as np

from orchestration.errors import StudyError
from orchestration.fmi.given import shown

DIGITS = 12
"""Digits of a level between the ends of a range, so that it can be written down and found again: 0.3, not 0.1 * 3."""
MOST_LEVELS = 1_000_000
SEED = "seed"
"""Name of the factor of the seeds."""
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*(\d+)\s*(log)?")
_INTERVAL = re.compile(rf"({_NUMBER})\s*:\s*({_NUMBER})\s*(log)?")
_CALL = re.compile(rf"(normal|uniform|loguniform)\(\s*({_NUMBER})\s*,\s*({_NUMBER})\s*\)")
_WHOLE = re.compile(r"(\d+)\s*-\s*(\d+)")
_WORD = re.compile(r"[A-Za-z_]\w*")

Level = float | bool | str
"""A value of a factor; a text names an item of an Enumeration or a Boolean."""


@dataclass(frozen=True)
class Interval:
    """A uniform distribution between two ends, of the value or of its logarithm."""

    low: float
    high: float
    logarithmic: bool = False

    def ppf(self, share: np.ndarray) -> np.ndarray:
        """Values below which the given shares of the distribution lie."""
        if self.logarithmic:
            low, high = math.log(self.low), math.log(self.high)
            return np.clip(np.exp(low + share * (high - low)), self.low, self.high)
        return np.clip(self.low + share * (self.high - self.low), self.low, self.high)


@dataclass(frozen=True)
class Normal:
    """A normal distribution."""

    mean: float
    deviation: float

    def ppf(self, share: np.ndarray) -> np.ndarray:
        """Values below which the given shares of the distribution lie."""
        from scipy.special import ndtri

        return self.mean + self.deviation * ndtri(share)


@dataclass(frozen=True)
class Choice:
    """Levels that are equally likely, by their numbers 0, 1, ..."""

    levels: tuple[Level, ...]

    def ppf(self, share: np.ndarray) -> np.ndarray:
        """Numbers of the levels for the given shares."""
        return np.minimum(np.floor(share * len(self.levels)), len(self.levels) - 1)


def levels(factor: str, given: Any) -> tuple[Level, ...]:
    """Levels that a text, a number or a sequence means.

    Parameters
    ----------
    factor
        Name of the factor, for messages.

    Raises
    ------
    StudyError
        If the levels cannot be told, are none, or are given twice.
    """
    found = _levels_of_text(factor, given) if isinstance(given, str) else _plain_levels(factor, given)
    if not found:
        raise _error(factor, given, "there is no level; give one at least")
    if len(set(found)) < len(found):
        twice = Counter(found).most_common(1)[0][0]
        raise _error(factor, given, f"the level {twice!r} is there twice; give each level once")
    return found


def distribution(factor: str, given: Any) -> Any:
    """A distribution that a text, a sequence of levels or an object of scipy.stats means; it has a method ``ppf``.

    Raises
    ------
    StudyError
        If the distribution cannot be told.
    """
    if callable(getattr(given, "ppf", None)):
        return given
    if isinstance(given, str):
        text = given.strip()
        if match := _INTERVAL.fullmatch(text):
            return _interval(factor, given, float(match[1]), float(match[2]), bool(match[3]))
        if match := _CALL.fullmatch(text):
            first, second = float(match[2]), float(match[3])
            if match[1] != "normal":
                return _interval(factor, given, first, second, match[1] == "loguniform")
            if second <= 0:
                raise _error(factor, given, "the standard deviation must be positive")
            return Normal(first, second)
        if "(" in text or (":" in text and not _RANGE.fullmatch(text)):
            advice = "write a:b, a:b log, normal(mean, deviation), uniform(a, b) or loguniform(a, b)"
            raise _error(factor, given, advice)
    return Choice(levels(factor, given))


def seed_numbers(given: Any) -> tuple[int, ...]:
    """Seeds that a text such as ``1-30``, a number or a sequence means.

    Raises
    ------
    StudyError
        If a seed is not a whole number from 0 on, or there are more than `MOST_LEVELS`.
    """
    found: list[Any] = []
    for part in given.split(",") if isinstance(given, str) else [given]:
        seeds = _seeds_of_text(given, part.strip()) if isinstance(part, str) else part
        number = len(found) + (len(seeds) if isinstance(seeds, Sized) else 1)
        if number > MOST_LEVELS:
            raise _error(SEED, given, f"these are {number} seeds; give {MOST_LEVELS} at most")
        found += levels(SEED, seeds)
    for seed in found:
        if isinstance(seed, str | bool) or not float(seed).is_integer() or not 0 <= seed < 2**31:
            raise _error(SEED, given, f"{seed!r} is not a whole number from 0 to {2**31 - 1}; write 1-30 or 1,2,5")
    return tuple(int(seed) for seed in levels(SEED, found))


def _seeds_of_text(given: str, part: str) -> Sequence[int]:
    """Seeds of a part of a text: a range or one number. They are counted before any of them is made."""
    match = _WHOLE.fullmatch(part)
    if match is None and not part.isdecimal():
        raise _error(SEED, given, "write seeds as 1-30 or 1,2,5")
    first, last = (int(match[1]), int(match[2])) if match else (int(part), int(part))
    if first > last:
        raise _error(SEED, given, f"the first seed of {part} is above the last; write {last}-{first}")
    if last >= 2**31:
        raise _error(SEED, given, f"{last} is not a whole number from 0 to {2**31 - 1}; write 1-30 or 1,2,5")
    return range(first, last + 1)


def _interval(factor: str, given: Any, low: float, high: float, logarithmic: bool) -> Interval:
    if not low < high:
        raise _error(factor, given, "the first end must be below the second")
    if logarithmic and low <= 0:
        raise _error(factor, given, "a logarithm needs ends above zero")
    return Interval(low, high, logarithmic)


def _levels_of_text(factor: str, text: str) -> tuple[Level, ...]:
    if match := _RANGE.fullmatch(text.strip()):
        return _range(factor, text, float(match[1]), float(match[2]), int(match[3]), bool(match[4]))
    found: list[Level] = []
    for part in text.split(","):
        if re.fullmatch(_NUMBER, part.strip()):
            found.append(float(part))
        elif _WORD.fullmatch(part.strip()):
            found.append(part.strip())
        elif _INTERVAL.fullmatch(part.strip()) or _CALL.fullmatch(text.strip()):
            advice = "points are drawn from it by --samples N or Study.samples"
            raise _error(factor, text, f"{advice}; for a grid write a number of levels too, as 0:1:5 or 1e4:1e6:9log")
        else:
            advice = "write levels as 50,100,200, or a range as 0:1:5 or 1e4:1e6:9log (first:last:number of levels)"
            raise _error(factor, text, advice)
    return tuple(found)


def _range(factor: str, text: str, first: float, last: float, n: int, logarithmic: bool) -> tuple[float, ...]:
    if not 2 <= n <= MOST_LEVELS or first == last:
        raise _error(factor, text, f"two different ends and 2 to {MOST_LEVELS} levels are needed")
    if logarithmic and (first <= 0 or last <= 0):
        raise _error(factor, text, "a logarithm needs ends above zero")
    if logarithmic:
        low, high = math.log10(first), math.log10(last)
        between = [10 ** (low + (high - low) * k / (n - 1)) for k in range(1, n - 1)]
    else:
        between = [first + (last - first) * k / (n - 1) for k in range(1, n - 1)]
    return (first, *(float(f"{value:.{DIGITS}g}") for value in between), last)


def _plain_levels(factor: str, given: Any) -> tuple[Level, ...]:
    items: Iterable[Any] = given if isinstance(given, Iterable) else [given]
    found: list[Level] = []
    for item in items:
        plain = item.item() if isinstance(item, np.generic) else item
        if isinstance(plain, Sequence) and not isinstance(plain, str):
            advice = "vary the elements one by one, or give a DataFrame with a column for each element"
            raise _error(factor, given, f"a level is {shown(plain)}; {advice}")
        if not isinstance(plain, float | int | bool | str) or (isinstance(plain, float) and not math.isfinite(plain)):
            raise _error(factor, given, f"a level is {shown(plain)}; give finite numbers")
        found.append(plain if isinstance(plain, str | bool) else float(plain))
    return tuple(found)


def _error(factor: str, given: Any, advice: str) -> StudyError:
    return StudyError(f"Factor {factor}: {shown(given)}; {advice}.")
