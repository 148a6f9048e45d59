"""Extremes of results: by hand, of files in parts, and of files without rows."""

from pathlib import Path

import numpy as np
import pytest

from orchestration.results import arrow_table
from orchestration.results.columns import Columns
from orchestration.results.extremes import extremes, extremes_of_file
from orchestration.results.formats import parts_of, write_columns

NAMES = ("a.x", "a.y")


def columns(n: int) -> Columns:
    """A number of rows of two columns: one that falls and rises, one that is constant."""
    time = 0.5 + 0.1 * np.arange(n)
    rows = np.column_stack([np.abs(np.arange(n) - 70.0), np.full(n, -2.0)])
    return Columns(time, NAMES, rows, {"a.x": "m"}, metadata={"system": "s"}, status="failed", message="It broke.")


def test_parts_give_what_the_whole_gives() -> None:
    whole = columns(200)
    parts = [
        Columns(whole.time[i:j], NAMES, whole.rows[i:j], whole.units) for i, j in ((0, 1), (1, 1), (1, 150), (150, 200))
    ]
    for found in (extremes([whole]), extremes(parts)):
        assert (found.rows, found.span) == (200, (0.5, whole.time[-1]))
        assert found.smallest.tolist() == [0.0, -2.0]
        assert found.largest.tolist() == [129.0, -2.0]
        assert found.last.tolist() == [129.0, -2.0]


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_file_is_read_in_groups_of_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str) -> None:
    monkeypatch.setattr(arrow_table, "ROW_GROUP_BYTES", 64 * 8 * (len(NAMES) + 1))
    path, whole = tmp_path / f"x.{suffix}", columns(200)
    write_columns(whole, path)
    assert [len(part.time) for part in parts_of(path)] == ([64, 64, 64, 8] if suffix == "parquet" else [200])
    found, expected = extremes_of_file(path), extremes([whole])
    assert (found.names, found.rows, found.span) == (NAMES, 200, expected.span)
    for name in ("smallest", "largest", "last"):
        assert getattr(found, name).tobytes() == getattr(expected, name).tobytes()
    if suffix == "parquet":
        assert (found.units["a.x"], found.metadata["system"]) == ("m", "s")
        assert (found.status, found.message) == ("failed", "It broke.")


def test_without_rows_there_are_no_numbers(tmp_path: Path) -> None:
    write_columns(columns(0), tmp_path / "x.parquet")
    found = extremes_of_file(tmp_path / "x.parquet")
    assert (found.names, found.rows, found.span) == (NAMES, 0, None)
    assert np.isnan([found.smallest, found.largest, found.last]).all()


def test_a_value_that_is_missing_hides_no_other() -> None:
    whole = columns(3)
    whole.rows[0, 0] = np.nan
    found = extremes([Columns(whole.time[:1], NAMES, whole.rows[:1]), Columns(whole.time[1:], NAMES, whole.rows[1:])])
    assert (found.smallest[0], found.largest[0]) == (68.0, 69.0)
