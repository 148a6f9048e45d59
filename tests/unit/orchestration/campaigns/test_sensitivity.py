"""Sensitivity indices: those of functions whose indices are known, and what is refused."""

import numpy as np
import pandas as pd
import pytest
import SALib.analyze.sobol
from SALib.sample import sobol

from orchestration import StudyError, UnknownNameError, sensitivity
from orchestration.campaigns.sensitivity import GIVEN, GRID, SALTELLI, saltelli_blocks
from tests.unit.orchestration.campaigns.tables import K, force, grid, samples

PROBLEM = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[-np.pi, np.pi]] * 3}


def ishigami(points: np.ndarray) -> np.ndarray:
    """The function of Ishigami and Homma (1990), with a = 7 and b = 0.1."""
    a, b, c = points.T
    return np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)


# Exact indices: V1 = (1 + 0.1 pi^4 / 5)^2 / 2, V2 = 7^2 / 8, V13 = 0.1^2 pi^8 (1/18 - 1/50).
V1, V2, V13 = (1 + np.pi**4 / 50) ** 2 / 2, 49 / 8, 0.01 * np.pi**8 * (1 / 18 - 1 / 50)
FIRST = np.array([V1, V2, 0]) / (V1 + V2 + V13)
TOTAL = np.array([V1 + V13, V2, V13]) / (V1 + V2 + V13)


def frame(points: np.ndarray) -> pd.DataFrame:
    return samples(pd.DataFrame(points, columns=PROBLEM["names"]), ishigami(points))


@pytest.mark.parametrize("second", [True, False])
def test_saltellis_points_give_what_salib_gives(second: bool) -> None:
    points = sobol.sample(PROBLEM, 1024, calc_second_order=second, seed=1)
    found = sensitivity(frame(points), "peak")
    theirs = SALib.analyze.sobol.analyze(
        PROBLEM, ishigami(points), calc_second_order=second, num_resamples=200, seed=np.random.default_rng(0)
    )
    assert list(found.columns) == ["S1", "S1_conf", "ST", "ST_conf"]
    assert list(found.index) == PROBLEM["names"]
    for column in found:
        np.testing.assert_array_equal(found[column], theirs[column])
    # The estimates lie within twice their own 95 % intervals.
    assert (abs(found["S1"] - FIRST) < 2 * found["S1_conf"]).all()
    assert (abs(found["ST"] - TOTAL) < 2 * found["ST_conf"]).all()
    assert found.attrs == {"method": SALTELLI, "measure": "peak", "points": len(points), "left_out": 0}


def test_a_block_with_a_failed_run_is_left_out_as_a_whole() -> None:
    points = sobol.sample(PROBLEM, 64, seed=1)
    table = frame(points)
    table.loc[11, ["peak", "status"]] = [np.nan, "failed"]
    found = sensitivity(table, "peak")
    whole = sensitivity(frame(np.delete(points, slice(8, 16), axis=0)), "peak")
    pd.testing.assert_frame_equal(found, whole, check_exact=True)
    assert (found.attrs["points"], found.attrs["left_out"]) == (63 * 8, 8)


def test_other_samples_give_first_order_indices() -> None:
    points = np.random.default_rng(5).uniform(-np.pi, np.pi, (2000, 3))
    found = sensitivity(frame(points), "peak")
    assert list(found.columns) == ["S1", "S1_conf"]
    assert found.attrs["method"] == GIVEN
    # The bootstrap's interval of 95 % holds in 19 of 20 cases; three times its width holds always.
    assert (abs(found["S1"] - FIRST) < 3 * found["S1_conf"] + 0.02).all()


def test_a_grid_gives_the_exact_shares_of_its_variance() -> None:
    table = grid({"a": [0.0, 1.0], "b": [0.0, 1.0, 2.0]}, lambda a, b: 3 * a + b + a * b)
    found = sensitivity(table, "peak")
    # By hand: rows 0 1 2 and 3 5 7, mean 3, variance 34/6; means of rows 1 and 5, of columns 1.5, 3, 4.5.
    np.testing.assert_allclose(found["S1"], [4 / (34 / 6), 1.5 / (34 / 6)], rtol=1e-14)
    # Variances of columns 2.25, 4, 6.25; of rows 2/3 and 8/3.
    np.testing.assert_allclose(found["ST"], [12.5 / 3 / (34 / 6), 5 / 3 / (34 / 6)], rtol=1e-14)
    assert found.attrs["method"] == GRID


def test_a_mean_over_seeds_is_taken_first() -> None:
    levels = {"a": [0.0, 1.0], "seed": [1, 2], "b": [0.0, 1.0, 2.0]}
    table = grid(levels, lambda a, b, seed: 3 * a + b + a * b + 100 * (seed - 1.5))
    plain = grid({"a": [0.0, 1.0], "b": [0.0, 1.0, 2.0]}, lambda a, b: 3 * a + b + a * b)
    pd.testing.assert_frame_equal(sensitivity(table, "peak"), sensitivity(plain, "peak"), rtol=1e-12)


def test_points_of_saltelli_are_known_by_themselves() -> None:
    points = sobol.sample(PROBLEM, 8, seed=2)
    assert saltelli_blocks(points) == 8
    assert saltelli_blocks(sobol.sample(PROBLEM, 8, calc_second_order=False, seed=2)) == 5
    assert saltelli_blocks(np.random.default_rng(1).uniform(size=(64, 3))) is None
    swapped = points.copy()
    swapped[[1, 2]] = swapped[[2, 1]]
    assert saltelli_blocks(swapped) is None
    assert saltelli_blocks(points[:-1]) is None
    assert saltelli_blocks(np.zeros((8, 3))) is None


REFUSED = {
    "Only seeds vary in the table": (grid({"seed": [1, 2]}, lambda seed: seed), "peak"),
    "The measure has the same value in all runs": (grid({"a": [0, 1]}, lambda a: 0 * a), "peak"),
    "1 of 2 points of the grid have no value of peak": (grid({"a": [0, 1]}, lambda a: a, lambda a: a > 0), "peak"),
    "The table holds the systems x, y": (grid({"system": ["x", "y"], "a": [0, 1]}, lambda a, **_: a), "peak"),
    "only 10 samples without a failed run; 50 are the least": (
        samples(pd.DataFrame({"a": np.arange(12.0)}), np.where(np.arange(12) > 1, 1.0, np.nan)),
        "peak",
    ),
    "is no table of a study; give what Study.run returns": (pd.DataFrame({"a": [1.0, 2.0]}), "a"),
    "Nothing varies in the table": (grid({"K_f": K[:1]}, force), "peak"),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_has_no_sensitivity_is_refused(message: str) -> None:
    table, measure = REFUSED[message]
    with pytest.raises(StudyError) as caught:
        sensitivity(table, measure)
    assert message in str(caught.value)


def test_a_wrong_measure_is_told_with_near_names() -> None:
    with pytest.raises(UnknownNameError, match=r"The table has no measure 'peek'; did you mean peak\?"):
        sensitivity(grid({"K_f": K}, force), "peek")


def test_without_salib_the_message_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "SALib.analyze.sobol", None)
    with pytest.raises(StudyError, match=r"pip install .adaptimp\[sensitivity\]"):
        sensitivity(frame(sobol.sample(PROBLEM, 8, seed=2)), "peak")
