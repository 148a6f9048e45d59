"""Evidence that a run is stored as finely as the room allows, and that the page says how finely."""

import numpy as np
import pytest

from orchestration import Result
from orchestration.report.encoding import extremes
from orchestration.report.stored_run import COARSEST, store
from tests.unit.orchestration.report.test_encoding import unpack

ROWS = 20_000
TIME = 1e-4 * np.arange(ROWS)  # s


@pytest.fixture(scope="module")
def noisy() -> Result:
    values = np.random.default_rng(1).normal(size=(ROWS, 3))
    return Result(TIME, ("a.x", "a.y", "a.z"), values, units={"a.x": "m"}, sample_times={"a": 1e-4})


def test_all_rows_are_stored_where_they_fit(noisy: Result) -> None:
    run = store("run", noisy, 10**7)
    assert run.bins == {}
    assert {packed.bytes for packed in run.columns.values()} == {3}  # 6 bytes are for short runs
    assert run.held == ["a"]
    assert "All rows are stored." in run.note()
    assert "rounded to 3e-08 of the range" in run.note()


def test_the_last_columns_become_coarser_first(noisy: Result) -> None:
    whole = store("run", noisy, 160_000)
    run = store("run", noisy, 120_000, first=["a.z"])
    assert whole.bins == {}
    assert run.size <= 120_000
    assert next(iter(run.columns)) == "a.z"
    assert "a.z" not in run.bins
    assert set(run.bins) <= {"a.x", "a.y"}
    name, rows = next(iter(run.bins.items()))
    packed = run.columns[name]
    found = unpack(packed)
    assert len(found) == 2 * -(-ROWS // rows)
    assert np.abs(found - extremes(noisy[name], rows)).max() <= packed.rounding * (1 + 1e-9)
    assert f"the least and the largest value of {rows} rows are stored each" in run.note()


def test_no_column_becomes_coarser_than_a_plot_needs(noisy: Result) -> None:
    run = store("run", noisy, 0)
    assert {packed.count for packed in run.columns.values()} == {2 * ROWS // 16}
    assert ROWS // 16 >= COARSEST


@pytest.mark.parametrize("step", [1e-4, 1e-5, 2.0**-13, 0.1])
def test_even_times_are_stored_by_their_step(step: float) -> None:
    time = 0.5 + np.arange(1001) * step
    found = store("run", Result(time, (), np.zeros((1001, 0))), 10**6).time
    assert "data" not in found
    assert np.array_equal(found["start"] + np.arange(found["count"]) * found["step"], time)


def test_uneven_times_are_stored_to_the_last_digits() -> None:
    time = np.array([0.0, 0.1, 0.15, 3.0])
    found = store("run", Result(time, (), np.zeros((4, 0))), 10**6).time
    assert found["count"] == 4
    assert found["step"] < 1.1e-14  # s: 3 s in six bytes
