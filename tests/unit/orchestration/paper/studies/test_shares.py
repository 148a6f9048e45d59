"""Shares, their intervals and the values that decide, against published numbers and answers with known structure."""

import numpy as np
import pytest

from orchestration.paper.share import Share
from orchestration.paper.studies.open_values import OpenValue
from orchestration.paper.studies.shares import best_part, deciding, first_order_index, parts

N = 4096
LINEAR = OpenValue("a", "m", 0.0, 3.0, "", "")
LOG = OpenValue("b", "N", 1.0, 1000.0, "", "", log=True)
CHOICE = OpenValue("c", "", 0.0, 1.0, "", "", choices=(1.0, 0.0))


def points() -> dict[str, np.ndarray]:
    shares = np.random.default_rng(3).random((3, N))
    return {value.name: value.at(share) for value, share in zip((LINEAR, LOG, CHOICE), shares, strict=True)}


@pytest.mark.parametrize(
    ("yes", "n", "low", "high"),
    # R. G. Newcombe, "Two-sided confidence intervals for the single proportion", Stat. Med. 17 (1998), table I.
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_s_interval_as_published(yes: int, n: int, low: float, high: float) -> None:
    found = Share(yes, n)
    assert (round(found.low, 4), round(found.high, 4)) == (low, high)


def test_ends_of_the_interval() -> None:
    assert Share(0, 7).low == 0.0
    assert Share(7, 7).high == 1.0
    assert (Share(0, 0).low, Share(0, 0).high) == (0.0, 1.0)
    assert np.isnan(Share(0, 0).value)


def test_parts_of_a_range_and_of_choices() -> None:
    given = points()
    answers = (given["b"] > 10).astype(int)
    assert [name for name, _ in parts(LOG, given["b"], answers)] == ["1 to 10", "10 to 100", "100 to 1e+03"]
    assert [part.value for _, part in parts(LOG, given["b"], answers)] == [0, 1, 1]
    assert sum(part.n for _, part in parts(LINEAR, given["a"], answers)) == N
    chosen = parts(CHOICE, given["c"], (given["c"] == 1).astype(int))
    assert [(name, part.value) for name, part in chosen] == [("0", 0), ("1", 1)]


def test_index_of_answers_with_known_structure() -> None:
    given = points()
    # Yes where a lies in the upper half and b in the upper half: of the variance 3/16 each explains 1/16 alone.
    answers = ((given["a"] > 1.5) & (given["b"] > 10**1.5)).astype(int)
    for value in (LINEAR, LOG):
        # Share of one half estimated from 2048 answers: standard deviation 0.011 of 0.5, so 2.2 % of the index, twice.
        assert first_order_index(value, given[value.name], answers) == pytest.approx(1 / 3, abs=0.05)
    assert first_order_index(CHOICE, given["c"], answers) < 0.01
    assert [value.name for value, _ in deciding([LINEAR, CHOICE, LOG], given, answers, 0.1)] in (["a", "b"], ["b", "a"])


def test_index_of_what_is_the_same_everywhere() -> None:
    assert first_order_index(LINEAR, points()["a"], np.ones(N, dtype=int)) == 0.0


def test_index_of_chance_is_about_nothing() -> None:
    coin = np.random.default_rng(5).integers(0, 2, N)
    # 15 degrees of freedom over 4096 answers: a chi-square of mean 15 and deviation 5.5, over 4096; four deviations.
    assert first_order_index(LOG, points()["b"], coin) < 4 * 5.5 / N


def test_what_chance_gives_decides_nothing() -> None:
    few = 256
    random = np.random.default_rng(6)
    given = {f"v{i}": random.random(few) for i in range(20)}
    values = [OpenValue(name, "", 0.0, 1.0, "", "") for name in given]
    coin = random.integers(0, 2, few)
    # 15 degrees of freedom over 256 answers: the index of chance has a deviation of 5.5 / 256, and some are above 2 %.
    assert max(first_order_index(value, given[value.name], coin) for value in values) > 0.02
    assert deciding(values, given, coin, 0.02) == []
    half = (given["v3"] < 0.5).astype(int)
    assert [value.name for value, _ in deciding(values, given, half, 0.02)] == ["v3"]


def test_one_part_is_enough_where_all_answers_are_yes() -> None:
    given = points()
    where, found = best_part([LINEAR, CHOICE, LOG], given, (given["b"] > 100).astype(int))
    assert where == [("b", "100 to 1e+03")]
    assert found.value == 1.0


def test_the_best_part_of_one_value_and_in_it_of_another() -> None:
    given = points()
    answers = ((given["b"] > 100) & (given["c"] == 1)).astype(int)
    where, found = best_part([LINEAR, CHOICE, LOG], given, answers)
    assert where == [("b", "100 to 1e+03"), ("c", "1")]
    assert found.value == 1.0
    assert found.n == answers.sum()
