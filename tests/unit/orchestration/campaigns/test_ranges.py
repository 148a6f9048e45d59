"""Texts and sequences that mean levels, distributions and seeds."""

from typing import Any

import numpy as np
import pytest

from orchestration import StudyError
from orchestration.campaigns.design.ranges import (
    MOST_LEVELS,
    Choice,
    Interval,
    Normal,
    distribution,
    levels,
    seed_numbers,
)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("0:1:5", [0.0, 0.25, 0.5, 0.75, 1.0]),
        ("0:1:11", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),  # as they are written, not as they add up
        ("3 : -3 : 3", [3.0, 0.0, -3.0]),
        ("1e4:1e6:5log", [1e4, 31622.7766017, 1e5, 316227.766017, 1e6]),
        ("50, 100,200", [50.0, 100.0, 200.0]),
        ("true,false", ["true", "false"]),
        ("-.5", [-0.5]),
        (7, [7.0]),
        (range(3), [0.0, 1.0, 2.0]),
        (np.array([1.5, 2.5], np.float32), [1.5, 2.5]),
        ([True, False], [True, False]),
    ],
)
def test_levels(given: Any, expected: list[Any]) -> None:
    assert list(levels("x", given)) == expected


def test_ends_of_a_logarithmic_range_are_those_given() -> None:
    found = levels("x", "0.3:0.7:4log")
    assert (found[0], found[-1]) == (0.3, 0.7)


def test_levels_of_a_logarithmic_range_have_equal_ratios() -> None:
    found = np.array(levels("x", "2e-3:5e4:30log"))
    ratios = found[1:] / found[:-1]
    # each level is rounded to 12 digits, an error of at most 5e-12
    np.testing.assert_allclose(ratios, (5e4 / 2e-3) ** (1 / 29), rtol=1e-11)


@pytest.mark.parametrize(
    ("given", "advice"),
    [
        ("1e4 to 1e6", "write levels as"),
        ("1:2", "points are drawn from it"),
        ("1:2:1", "2 to 1000000 levels"),
        ("1:1:3", "two different ends"),
        ("0:1:3log", "above zero"),
        ("-1:-5:3log", "above zero"),
        ("1,2,1", "1.0 is there twice"),
        ("", "write levels as"),
        ([], "give one at least"),
        ([1.0, float("nan")], "give finite numbers"),
        ([float("inf")], "give finite numbers"),
        ([[1.0, 2.0]], "vary the elements one by one"),
        (None, "give finite numbers"),
        ([None], "give finite numbers"),
        ({"a": 1}.items(), "vary the elements one by one"),
    ],
)
def test_levels_that_cannot_be_told_are_refused(given: Any, advice: str) -> None:
    with pytest.raises(StudyError, match=rf"^Factor plant\.K_f: .*{advice}"):
        levels("plant.K_f", given)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("1:2", Interval(1.0, 2.0)),
        ("1e4:1e6 log", Interval(1e4, 1e6, logarithmic=True)),
        ("uniform(-1, 1)", Interval(-1.0, 1.0)),
        ("loguniform(1, 10)", Interval(1.0, 10.0, logarithmic=True)),
        ("normal(1, 0.1)", Normal(1.0, 0.1)),
        ("1,2,3", Choice((1.0, 2.0, 3.0))),
        ("0:1:3", Choice((0.0, 0.5, 1.0))),
    ],
)
def test_distributions(given: str, expected: object) -> None:
    assert distribution("x", given) == expected


@pytest.mark.parametrize(
    ("given", "advice"),
    [
        ("2:1", "the first end must be below the second"),
        ("0:1 log", "above zero"),
        ("normal(1, 0)", "must be positive"),
        ("beta(1, 2)", "write a:b"),
        ("1:2:3:4", "write a:b"),
    ],
)
def test_distributions_that_cannot_be_told_are_refused(given: str, advice: str) -> None:
    with pytest.raises(StudyError, match=advice):
        distribution("x", given)


def test_quantiles() -> None:
    shares = np.array([0.0, 0.25, 0.5, 1.0])
    assert Interval(1.0, 3.0).ppf(shares).tolist() == [1.0, 1.5, 2.0, 3.0]
    np.testing.assert_allclose(Interval(1.0, 100.0, logarithmic=True).ppf(shares), [1, 10**0.5, 10, 100], rtol=1e-15)
    # standard normal distribution: 84.134474606854 % lie below one deviation
    np.testing.assert_allclose(Normal(2.0, 0.5).ppf(np.array([0.5, 0.84134474606854])), [2.0, 2.5], rtol=1e-13)
    assert Choice((7.0, 8.0, 9.0)).ppf(np.array([0.0, 0.34, 0.99, 1.0])).tolist() == [0, 1, 2, 2]


@pytest.mark.parametrize(
    ("given", "expected"),
    [("1-3", (1, 2, 3)), ("1-2,9", (1, 2, 9)), (range(1, 4), (1, 2, 3)), (5, (5,)), ([2.0], (2,))],
)
def test_seeds(given: Any, expected: tuple[int, ...]) -> None:
    assert seed_numbers(given) == expected


@pytest.mark.parametrize("given", ["a", "3-1,x", [1.5], [-1], [2**31], [True], "1-2,2", "3-1", []])
def test_seeds_that_are_no_whole_numbers_are_refused(given: Any) -> None:
    with pytest.raises(StudyError, match="Factor seed"):
        seed_numbers(given)


def test_a_wrong_text_of_seeds_is_told_how_seeds_are_written() -> None:
    with pytest.raises(StudyError, match=r"^Factor seed: '1-x'; write seeds as 1-30 or 1,2,5\.$"):
        seed_numbers("1-x")


def test_seeds_in_falling_order_are_told_how_to_be_written() -> None:
    with pytest.raises(StudyError, match=r"^Factor seed: '5-1'; the first seed of 5-1 is above the last; write 1-5\.$"):
        seed_numbers("5-1")


@pytest.mark.parametrize("given", ["1-1000001", "0-2147483647", "1-600000,700000-1200000", range(1_000_001)])
def test_too_many_seeds_are_refused(given: Any) -> None:
    with pytest.raises(StudyError, match=rf"^Factor seed: .*; these are \d+ seeds; give {MOST_LEVELS} at most\.$"):
        seed_numbers(given)


def test_many_seeds_of_which_one_is_there_twice_are_told_at_once() -> None:
    with pytest.raises(StudyError, match=r"the level 500000\.0 is there twice; give each level once\.$"):
        seed_numbers("1-500000,500000,600000-1000000")


@pytest.mark.parametrize("given", ["1e4:1e6", "1e4:1e6 log", "normal(1, 0.1)"])
def test_a_distribution_as_a_grid_is_told_how_points_are_drawn(given: str) -> None:
    with pytest.raises(
        StudyError, match=r"points are drawn from it by --samples N or Study\.samples; for a grid write"
    ):
        levels("plant.K_f", given)
