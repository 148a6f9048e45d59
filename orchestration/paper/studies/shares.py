"""Statistics of yes-or-no answers over many settings: shares with their confidence, and the values that decide.

Source: E. Plischke, E. Borgonovo and C. L. Smith, "Global sensitivity measures from given data", Eur. J. Oper. Res. 226
(2013).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from orchestration.paper.share import Share
from orchestration.paper.studies.open_values import OpenValue

BINS = 16  # of a range, for the first-order index
SURE = 0.999  # of values that decide nothing, the share whose index is no larger than `index_of_chance`


def share(answers: np.ndarray) -> Share:
    """The share of yes among answers of 0 or 1, shape (n,)."""
    return Share(int(answers.sum()), len(answers))


def parts(value: OpenValue, points: np.ndarray, answers: np.ndarray, thirds: int = 3) -> list[tuple[str, Share]]:
    """Shares where an open value lies in each part of its range, or has each of its choices.

    Parameters
    ----------
    points
        The value at each setting, shape (n,).
    answers
        0 or 1, shape (n,).

    Returns
    -------
    list
        For each part, from the lowest values on, its name and the share.
    """
    return [(name, share(answers[members])) for name, members in members_of(value, points, thirds)]


def members_of(value: OpenValue, points: np.ndarray, thirds: int = 3) -> list[tuple[str, np.ndarray]]:
    """Which settings lie in each part of the range of an open value, or have each of its choices.

    Returns
    -------
    list
        For each part, from the lowest values on, its name and whether a setting lies there, bool, shape (n,).
    """
    if value.choices:
        return [(f"{choice:g}", points == choice) for choice in sorted({*value.choices})]
    ends = value.at(np.arange(thirds + 1) / thirds)
    number = np.clip(np.searchsorted(ends, points, side="right") - 1, 0, thirds - 1)
    return [(f"{ends[i]:.3g} to {ends[i + 1]:.3g}", number == i) for i in range(thirds)]


def first_order_index(value: OpenValue, points: np.ndarray, answers: np.ndarray) -> float:
    """The part of the variance of the answers that an open value explains alone, from 0 to 1.

    It is the variance of the shares over `BINS` parts of the range, less what chance gives them, over the variance of
    the answers. An answer that is the same everywhere has no variance, and the index is 0.
    """
    whole = share(answers)
    variance = whole.value * (1 - whole.value)
    if not whole.n or not variance:
        return 0.0
    found = [part for _, part in parts(value, points, answers, BINS) if part.n]
    between = sum(part.n * (part.value - whole.value) ** 2 for part in found) / whole.n
    by_chance = (len(found) - 1) / (whole.n - 1) * variance
    return float(np.clip((between - by_chance) / variance, 0, 1))


def deciding(
    values: Sequence[OpenValue], points: Mapping[str, np.ndarray], answers: np.ndarray, least: float
) -> list[tuple[OpenValue, float]]:
    """The open values whose first-order index is at least `least`, and above that of chance, the largest first."""
    n = len(answers)
    found = [(value, first_order_index(value, points[value.name], answers)) for value in values]
    return sorted(
        (pair for pair in found if pair[1] >= max(least, index_of_chance(pair[0], n))), key=lambda pair: -pair[1]
    )


def index_of_chance(value: OpenValue, n: int) -> float:
    """The first-order index that a value which decides nothing hardly ever exceeds, with n answers.

    The variance between the parts, times n over the variance of the answers, is then a chi-square with one degree of
    freedom less than there are parts.
    """
    from scipy.stats import chi2

    freedom = (len({*value.choices}) or BINS) - 1
    return float(chi2.ppf(SURE, freedom) - freedom) / max(n, 1)


def best_part(
    values: Sequence[OpenValue], points: Mapping[str, np.ndarray], answers: np.ndarray
) -> tuple[list[tuple[str, str]], Share]:
    """A part of the space, given by parts of one or two open values, in which many answers are yes.

    The first value and its part are those with the largest share by the lower end of its interval, and the second ones
    are those with the largest share within the first part. It is a decision tree of two levels, along its best branch;
    another pair of parts may have a larger share. Where all answers in the first part are yes, there is no second one.

    Returns
    -------
    tuple
        Name and part of each value, and the share there.
    """
    where: list[tuple[str, str]] = []
    chosen = np.ones(len(answers), dtype=bool)
    while len(where) < 2 and not (where and answers[chosen].all()):
        found = [
            (value.name, name, chosen & members)
            for value in values
            if value.name not in dict(where)
            for name, members in members_of(value, points[value.name])
        ]
        name, part, chosen = max(found, key=lambda row: share(answers[row[2]]).low)
        where.append((name, part))
    return where, share(answers[chosen])
