"""Tests that finished runs are kept, found again and never twice in a table."""

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.store import row_files, row_table
from orchestration.campaigns.store import writer as writer_module
from orchestration.campaigns.store.row_files import StoreWarning
from orchestration.campaigns.store.row_table import RowColumns
from orchestration.campaigns.store.store import Store
from orchestration.errors import StoreError
from tests.unit.orchestration.campaigns.store.rows import (
    COLUMNS,
    FAILED_EVERY,
    MEASURES,
    STUDY,
    append,
    assert_rows,
    factors,
    files,
    filled,
    keys,
    outcomes,
)


def test_runs_come_back_in_order_bit_by_bit(tmp_path: Path) -> None:
    store = filled(tmp_path / "runs", [range(20, 30), range(10), range(10, 20)])
    assert_rows(store.table(STUDY), range(30))
    assert len(files(store)) == 1


def test_any_reader_of_parquet_reads_the_rows_with_their_units(tmp_path: Path) -> None:
    store = filled(tmp_path / "runs", [range(10)])
    frame = pd.read_parquet(store.folder / "rows")
    assert frame["plant.K_f"].tolist() == factors(range(10))["plant.K_f"].tolist()
    assert frame["study"].astype(str).unique().tolist() == [STUDY]
    assert store.table(STUDY).schema.field("peak").metadata[b"unit"] == b"N"


def test_the_file_does_not_depend_on_order_and_size_of_the_parts(tmp_path: Path) -> None:
    one = filled(tmp_path / "one", [range(100)])
    many = filled(tmp_path / "many", [[k] for k in reversed(range(100))])
    assert [(p.name, p.read_bytes()) for p in files(one)] == [(p.name, p.read_bytes()) for p in files(many)]


def test_runs_are_there_as_soon_as_they_are_appended(tmp_path: Path) -> None:
    store = Store.open(tmp_path)
    with store.writer(STUDY, COLUMNS) as writer:
        for done in range(1, 4):
            append(writer, [done])
            assert_rows(Store.open(tmp_path).table(STUDY), range(1, done + 1))


def test_small_files_become_one_from_time_to_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer_module, "MOST_FILES", 4)
    store = Store.open(tmp_path)
    with store.writer(STUDY, COLUMNS) as writer:
        for k in range(11):
            append(writer, [k])
            assert_rows(store.table(STUDY), range(k + 1))
        assert len(files(store)) == 2 + 3
    assert len(files(store)) == 1
    assert_rows(store.table(STUDY), range(11))


def test_a_run_that_was_made_twice_is_one_row(tmp_path: Path) -> None:
    store = filled(tmp_path, [range(5), range(3, 8)])
    filled(tmp_path, [range(6, 10)])
    assert_rows(store.table(STUDY), range(10))
    assert len(pd.read_parquet(tmp_path / "rows")) == 10


def test_a_run_that_succeeded_later_counts(tmp_path: Path) -> None:
    store = Store.open(tmp_path)
    crashed = Outcomes(np.array([3]), np.full((1, 2), np.nan), ("plant: the process has crashed.",))
    with store.writer(STUDY, COLUMNS) as writer:
        append(writer, [3])
        writer.append(keys([3]), factors([3]), crashed)
        assert store.find(keys([3]), MEASURES).messages.tolist() == [""]
    assert_rows(store.table(STUDY), [3])


def test_runs_of_all_studies_are_found(tmp_path: Path) -> None:
    filled(tmp_path, [range(10)], "a")
    store = filled(tmp_path, [range(20, 30)], "b")
    asked = [25, 3, 77, 3, 0]
    found = store.find(keys(asked), MEASURES, "b")
    assert found.present.tolist() == [True, True, False, True, True]
    assert found.own.tolist() == [True, False, False, False, False]
    expected = outcomes(asked)
    there = found.present
    assert found.measured[there].tobytes() == expected.measured[there].tobytes()
    assert np.isnan(found.measured[~there]).all()
    assert found.messages[there].tolist() == [expected.messages[i] for i in np.flatnonzero(there)]
    assert found.messages[4] != ""
    assert 0 % FAILED_EVERY == 0


def test_runs_with_other_measures_are_not_found(tmp_path: Path) -> None:
    store = filled(tmp_path, [range(5)])
    assert not store.find(keys(range(5)), (*MEASURES, "effort")).present.any()
    assert store.find(keys(range(5)), MEASURES[:1]).present.all()


def test_studies_with_other_columns_share_a_store(tmp_path: Path) -> None:
    store = filled(tmp_path, [range(5)], "a")
    with store.writer("b", RowColumns({"plant.m2": "kg"}, {"effort": "N.m"})) as writer:
        writer.append(keys([1]), {"plant.m2": np.ones(1)}, Outcomes(np.array([0]), np.ones((1, 1)), ("",)))
    assert_rows(store.table("a"), range(5))
    assert store.table("b").column_names == ["number", "key", "plant.m2", "effort", "message"]
    assert store.find(keys([1]), ("effort",)).measured.tolist() == [[1.0]]


def test_a_damaged_file_costs_its_own_runs_only_and_stays(tmp_path: Path) -> None:
    store = filled(tmp_path, [range(10)])
    (whole,) = files(store)
    content = whole.read_bytes()
    filled(tmp_path, [range(10, 12)], "other")
    cut = [content[:length] for length in range(0, len(content), 37)]
    altered = [content[:k] + bytes([content[k] ^ 1]) + content[k + 1 :] for k in range(0, len(content), 37)]
    for damaged in cut + altered:
        whole.write_bytes(damaged)
        with pytest.warns(StoreWarning, match=r"is damaged, or is no file of a store; its runs are made anew"):
            found = store.find(keys(range(12)), MEASURES)
        assert found.present.tolist() == [False] * 10 + [True] * 2
    with pytest.warns(StoreWarning, match="is damaged"):
        filled(tmp_path, [range(5)])
    assert whole in files(store)
    whole.unlink()
    assert_rows(store.table(STUDY), range(5))


def test_files_of_something_else_are_left_alone(tmp_path: Path) -> None:
    store = filled(tmp_path, [range(3)])
    folder = tmp_path / "rows" / f"study={STUDY}"
    pd.DataFrame({"x": [1.0]}).to_parquet(folder / "mine.parquet")
    (folder / "notes.txt").write_text("keep")
    with pytest.warns(StoreWarning, match=r"mine\.parquet is damaged, or is no file of a store"):
        assert_rows(store.table(STUDY), range(3))
    with pytest.warns(StoreWarning, match=r"mine\.parquet"):
        filled(tmp_path, [range(3, 6)])
    assert (folder / "mine.parquet").exists()
    assert (folder / "notes.txt").read_text() == "keep"


@pytest.mark.skipif(os.name == "nt", reason="links need a right there that users lack")
def test_a_dangling_link_is_left_out(tmp_path: Path) -> None:
    store = filled(tmp_path, [range(3)])
    (tmp_path / "rows" / f"study={STUDY}" / "dead.parquet").symlink_to(tmp_path / "nonexistent")
    with pytest.warns(
        StoreWarning, match=r"dead\.parquet is a link to a file that is not there; its runs are made anew"
    ):
        assert_rows(store.table(STUDY), range(3))


@pytest.mark.parametrize("effort", range(4))  # the hash of the content decides which file is read first
def test_a_file_of_another_study_in_the_folder_is_left_out(tmp_path: Path, effort: int) -> None:
    store = filled(tmp_path, [range(3)])
    with store.writer("other", RowColumns({}, {"effort": "N.m"})) as writer:
        writer.append(keys([1]), {}, Outcomes(np.array([0]), np.full((1, 1), float(effort)), ("",)))
    (strange,) = files(store, "other")
    moved = strange.replace(tmp_path / "rows" / f"study={STUDY}" / strange.name)
    with pytest.warns(StoreWarning, match=rf"{moved.name} has other columns than the files beside it"):
        assert_rows(store.table(STUDY), range(3))


def test_a_file_of_another_format_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        for module in (row_table, row_files):
            patch.setattr(module, "FORMAT", b"0")
        store = filled(tmp_path, [range(3)])
    with pytest.warns(StoreWarning, match="has format 0, not 1; its runs are made anew"):
        assert not store.find(keys(range(3)), MEASURES).present.any()


def test_a_failure_of_the_campaign_loses_no_run(tmp_path: Path) -> None:
    store, used = Store.open(tmp_path), []

    def fail() -> None:
        with store.writer(STUDY, COLUMNS) as writer:
            used.append(writer)
            append(writer, range(4))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert_rows(store.table(STUDY), range(4))
    with pytest.raises(StoreError, match="only within the writer's `with` block"):
        append(used[0], [5])


@pytest.mark.parametrize("name", ["key", "study", "peak"])
def test_a_column_cannot_be_there_twice(name: str) -> None:
    with pytest.raises(StoreError, match=f"The columns {name} would be there twice"):
        RowColumns({name: ""}, {"peak": "N"})


def test_rows_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    with Store.open(tmp_path).writer(STUDY, COLUMNS) as writer:
        with pytest.raises(StoreError, match=r"The factors sensor\.seed are missing"):
            writer.append(keys([1]), {k: v for k, v in factors([1]).items() if k != "sensor.seed"}, outcomes([1]))
        with pytest.raises(StoreError, match=r"Measures of shape \(2, 2\) were given; \(1, 2\) is needed"):
            writer.append(keys([1]), factors([1]), outcomes([1, 2]))
        with pytest.raises(StoreError, match=r"plant\.K_f: 2 values were given for 1 runs"):
            writer.append(keys([1]), {**factors([1]), "plant.K_f": np.ones(2)}, outcomes([1]))


def test_a_study_without_runs_is_named_with_those_that_are_there(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="there are no runs of study abc; the studies in the store are: none"):
        Store.open(tmp_path).table("abc")


def test_only_a_new_or_empty_folder_becomes_a_store(tmp_path: Path) -> None:
    (tmp_path / "x.txt").touch()
    with pytest.raises(StoreError, match=r"is no store and has other files, such as x\.txt"):
        Store.open(tmp_path)
    with pytest.raises(StoreError, match="there is no store of runs"):
        Store.open(tmp_path / "missing", new=False)
    assert not (tmp_path / "missing").exists()


@pytest.mark.parametrize(
    ("mark", "message"),
    [
        ('{"adaptimp": "store of runs", "format": 2}', "has format 2, but 1 is known"),
        ('{"adaptimp": "store of runs", "format": 0}', "is 'store of runs' of format 0, not 'store of runs' of"),
        ('{"adaptimp": "cache", "format": 1}', "is 'cache' of format 1, not 'store of runs' of format 1"),
        ('{"format": 1}', "mark cannot be read: 'adaptimp'"),
        ("{", "mark cannot be read"),
        ("[]", "mark cannot be read"),
    ],
)
def test_a_store_of_a_newer_version_or_a_damaged_mark_is_refused(tmp_path: Path, mark: str, message: str) -> None:
    Store.open(tmp_path)
    (tmp_path / "store.json").write_text(mark)
    with pytest.raises(StoreError, match=message):
        Store.open(tmp_path)
