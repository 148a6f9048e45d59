"""The size of an effect: by which ratio a quantity is larger in one run than in another with the same noise.

Source: the interval of the median from order statistics, W. J. Conover, "Practical Nonparametric Statistics", 3rd ed.
(1999), section 3.2. It asks nothing of the distribution but independent pairs.
"""

from collections.abc import Sequence

import numpy as np

from orchestration.paper.share import Share
from orchestration.paper.strength import Effect

LEVEL = 0.95
"""Confidence of the interval."""


def paired_effect(values: Sequence[float] | np.ndarray, than: Sequence[float] | np.ndarray) -> Effect:
    """How much larger values are than others, pair by pair.

    Parameters
    ----------
    values, than
        Positive numbers, shape (n,) each; a pair shares its noise.

    Examples
    --------
    >>> from orchestration.paper.effect import paired_effect
    >>> found = paired_effect([2.0, 3.0, 2.2, 2.4, 2.6, 0.9], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    >>> round(found.median, 2), found.low, found.high, found.larger.yes
    (2.3, 0.9, 3.0, 5)
    """
    ratios = np.sort(np.asarray(values, float) / np.asarray(than, float))
    low, high = median_interval(ratios)
    return Effect(float(np.median(ratios)), low, high, Share(int((ratios > 1).sum()), len(ratios)))


def shown(ratio: float) -> str:
    """A ratio with as many decimals as tell it from 1, from three to six; three digits from 2 on.

    Examples
    --------
    >>> from orchestration.paper.effect import shown
    >>> shown(1.097), shown(1.0002), shown(16.629)
    ('1.097', '1.0002', '16.6')
    """
    if ratio >= 2 or not np.isfinite(ratio):
        return f"{ratio:.3g}"
    distance = abs(ratio - 1)
    digits = min(6, max(3, int(np.ceil(-np.log10(distance))))) if distance > 0 else 3
    return f"{ratio:.{digits}f}"


def median_interval(ordered: np.ndarray) -> tuple[float, float]:
    """Interval of the median of which n ordered values are a sample, with a confidence of at least `LEVEL`.

    The ends are the k-th values from below and from above. The median lies below the k-th one if fewer than k of n
    values lie below the median, each with probability 1/2. With fewer than six values no interval has the confidence,
    and the ends are infinite.
    """
    from scipy.stats import binom

    n = len(ordered)
    k = int(binom.ppf((1 - LEVEL) / 2, n, 0.5))  # the least k with P(X <= k) >= 2.5 %
    if k == 0:
        return -np.inf, np.inf
    return float(ordered[k - 1]), float(ordered[n - k])
