"""Samples: the points are those of scipy and SALib, and a seed gives the same ones again."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from SALib.sample import sobol as salib_sobol
from scipy import stats
from scipy.stats import qmc

from orchestration import Study, StudyError, System
from orchestration.campaigns.design.samples import METHODS, unit_samples

MEASURE = "max(plant.x)"


@pytest.fixture
def study(loop: System) -> Study:
    """A study without a factor."""
    return Study(loop, MEASURE)


def test_points_of_sobol_are_those_of_scipy() -> None:
    expected = qmc.Sobol(3, scramble=True, rng=np.random.default_rng(5)).random_base2(3)
    assert np.array_equal(unit_samples(8, 3, "sobol", 5), expected)


def test_points_of_sobol_fill_each_eighth_once() -> None:
    """Points of Sobol are a net: in each dimension, each interval of length 1/8 has one of the first 8 points."""
    points = unit_samples(8, 4, "sobol", 0)
    assert np.array_equal(np.sort(np.floor(8 * points), axis=0), np.tile(np.arange(8.0)[:, None], 4))


def test_a_latin_hypercube_fills_each_row_and_column_once() -> None:
    points = unit_samples(11, 3, "latin-hypercube", 2)
    assert np.array_equal(np.sort(np.floor(11 * points), axis=0), np.tile(np.arange(11.0)[:, None], 3))


@pytest.mark.parametrize("method", METHODS)
def test_a_seed_gives_the_same_points_again(method: str) -> None:
    points = unit_samples(6, 2, method, 1)
    assert np.array_equal(points, unit_samples(6, 2, method, 1))
    assert not np.array_equal(points, unit_samples(6, 2, method, 2))
    assert points.shape == (6, 2)
    assert ((points > 0) & (points < 1)).all()


def test_samples_follow_their_distributions(study: Study) -> None:
    laws = {"plant.x_start": "normal(3, 0.5)", "relay.offset": stats.triang(0.5, loc=-1, scale=2)}
    points = study.samples(laws, n=16, seed=4).points
    uniform = unit_samples(16, 2, "sobol", 4)
    np.testing.assert_allclose(points["x_start"], stats.norm(3, 0.5).ppf(uniform[:, 0]), rtol=1e-14)
    assert points["offset"].tolist() == stats.triang(0.5, loc=-1, scale=2).ppf(uniform[:, 1]).tolist()


def test_levels_are_equally_likely(study: Study) -> None:
    points = study.samples({"plant.x_start": [1, 2, 5, 9]}, n=16).points
    assert points["x_start"].value_counts().to_dict() == {1.0: 4, 2.0: 4, 5.0: 4, 9.0: 4}


def test_items_of_types_other_than_real_go_by_their_names(study: Study) -> None:
    points = study.samples({"switch.flag": "true,false"}, n=4).points
    assert sorted(points["flag"]) == [0, 0, 1, 1]
    assert points["flag"].dtype == np.int64


def test_a_table_is_taken_row_by_row(study: Study) -> None:
    table = pd.DataFrame({"x_start": [0.1, 0.2], "switch.flag": [True, False], "relay.n": [3, 4]})
    points = study.samples(table).points
    assert points.columns.tolist() == ["x_start", "flag", "n"]
    assert points.to_numpy().tolist() == [[0.1, 1, 3], [0.2, 0, 4]]


def test_a_problem_of_salib_gets_saltellis_points(study: Study) -> None:
    problem = {"num_vars": 2, "names": ["plant.x_start", "relay.offset"], "bounds": [[0.0, 1.0], [-2.0, 2.0]]}
    points = study.samples(problem, n=4, seed=7).points
    assert points.to_numpy().tolist() == salib_sobol.sample(problem, 4, seed=7).tolist()
    assert len(points) == 4 * (2 * 2 + 2)


@pytest.mark.parametrize(
    ("points", "options", "message"),
    [
        ({"plant.x_start": "1:2"}, {}, "The number of samples is missing"),
        ({"plant.x_start": "1:2"}, {"n": 0}, "a whole number from 1 on"),
        ({"plant.x_start": "1:2"}, {"n": 2.5}, "a whole number from 1 on"),
        ({"plant.x_start": "1:2"}, {"n": 4, "method": "sobel"}, "did you mean sobol"),
        ({}, {"n": 4}, "without a factor"),
        ({"plant.x_start": "1:2"}, {"n": 4, "seed": -1}, "The seed of samples is -1"),
        ({"plant.x_start": "1:2"}, {"n": 4, "seed": "a"}, "The seed of samples is 'a'"),
        ({"num_vars": 1, "names": ["plant.x_start"], "bounds": [[1, 0]]}, {"n": 4}, "of SALib cannot be sampled"),
        (pd.DataFrame({"plant.x_start": []}), {}, "0 rows"),
        (pd.DataFrame({"plant.x_start": [1.0, np.nan]}), {}, "run 1 has nan"),
        ({"num_vars": 1, "names": ["plant.x_start"], "bounds": [[0, 1]]}, {"n": 3}, "a power of 2"),
        (5, {"n": 3}, "Factors are 5"),
    ],
)
def test_samples_that_cannot_be_told_are_refused(study: Study, points: Any, options: Any, message: str) -> None:
    with pytest.raises(StudyError, match=message):
        study.samples(points, **options)
