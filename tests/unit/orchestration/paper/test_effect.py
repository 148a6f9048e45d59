"""The effect size is checked against counted cases, and its interval against the binomial distribution."""

import numpy as np
import pytest
from scipy.stats import binom

from orchestration.paper.effect import LEVEL, median_interval, paired_effect, shown


def test_a_counted_case() -> None:
    found = paired_effect([1.1, 1.2, 1.3, 1.4, 1.5, 0.9], np.ones(6))
    assert found.median == pytest.approx(1.25)
    assert (found.low, found.high) == (0.9, 1.5), "of six pairs the interval is the whole range"
    assert (found.larger.yes, found.larger.n) == (5, 6)


def test_pairs_stay_together() -> None:
    values = np.array([10.0, 1.0, 3.0, 7.0, 2.0, 5.0])
    found = paired_effect(2 * values, values)
    assert (found.median, found.low, found.high) == (2.0, 2.0, 2.0)


@pytest.mark.parametrize("n", [6, 7, 20, 30, 100, 1000])
def test_the_interval_has_its_confidence_and_no_shorter_one_has_it(n: int) -> None:
    low, high = (int(end) for end in median_interval(np.arange(n, dtype=float)))
    assert high == n - 1 - low, "as many values below as above"
    assert 1 - 2 * binom.cdf(low, n, 0.5) >= LEVEL
    assert 1 - 2 * binom.cdf(low + 1, n, 0.5) < LEVEL


@pytest.mark.parametrize("n", [1, 5])
def test_too_few_pairs_have_no_interval(n: int) -> None:
    assert median_interval(np.arange(n, dtype=float)) == (-np.inf, np.inf)


def test_the_ends_of_an_interval_of_too_few_pairs_are_shown() -> None:
    found = paired_effect([1.1, 1.2], [1.0, 1.0])
    assert (shown(found.low), shown(found.high), shown(np.nan)) == ("-inf", "inf", "nan")


def test_the_interval_covers_the_median_as_often_as_it_says() -> None:
    random = np.random.default_rng(11)
    samples = np.sort(random.standard_cauchy((2000, 30)), axis=1)
    covered = np.mean([low <= 0 <= high for low, high in map(median_interval, samples)])
    assert 0.95 - 3 * np.sqrt(0.05 * 0.95 / 2000) < covered < 0.99
