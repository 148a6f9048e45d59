"""The effect of paired runs: hand-computed cases, and the published ranks of the median's interval."""

import numpy as np
import pytest

from orchestration.paper.effect import median_interval, paired_effect


@pytest.mark.parametrize(
    ("n", "low", "high"),
    # Ranks for 95 %: Conover (1999), table A3 of the binomial distribution with p = 1/2.
    [(6, 1, 6), (10, 2, 9), (20, 6, 15), (30, 10, 21), (100, 40, 61)],
)
def test_ranks_of_the_interval(n: int, low: int, high: int) -> None:
    assert median_interval(np.arange(1.0, n + 1)) == (low, high)


def test_too_few_pairs_have_no_interval() -> None:
    assert median_interval(np.arange(5.0)) == (-np.inf, np.inf)


def test_ratios_are_taken_pair_by_pair() -> None:
    found = paired_effect([2.0, 40.0, 3.0, 4.0, 5.0, 6.0], [1.0, 10.0, 2.0, 5.0, 5.0, 1.0])
    assert found.median == (1.5 + 2.0) / 2
    assert (found.low, found.high) == (0.8, 6.0)
    assert (found.larger.yes, found.larger.n) == (4, 6)


def test_the_interval_covers_the_median_as_often_as_it_says() -> None:
    random = np.random.default_rng(11)
    samples = np.sort(random.standard_cauchy((2000, 30)), axis=1)
    covered = np.mean([low <= 0 <= high for low, high in map(median_interval, samples)])
    assert 0.95 - 3 * np.sqrt(0.05 * 0.95 / 2000) < covered < 0.99
