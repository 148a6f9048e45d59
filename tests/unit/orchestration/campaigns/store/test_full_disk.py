"""Tests that a full disk is reported, and that the runs that were written before are kept."""

from pathlib import Path

import pytest

from orchestration.campaigns.store.row_files import StoreWarning
from orchestration.campaigns.store.store import Store
from orchestration.errors import StoreError
from tests.unit.orchestration.campaigns.store.rows import COLUMNS, STUDY, append, assert_rows, files
from tests.unit.orchestration.results.test_full_disk import full_disk


def test_a_full_disk_keeps_what_was_written(tmp_path: Path) -> None:
    store, n = Store.open(tmp_path), 2000

    def fill() -> None:
        with store.writer(STUDY, COLUMNS) as writer:
            append(writer, range(10))
            append(writer, range(10, n))

    with full_disk(), pytest.raises(StoreError, match=r"cannot be written: File too large; .* are kept\.$"):
        fill()
    assert_rows(store.table(STUDY), range(10))
    assert list((tmp_path / "unfinished").iterdir()) == []


def test_files_that_cannot_be_merged_are_kept_as_they_are(tmp_path: Path) -> None:
    store = Store.open(tmp_path)
    writer = store.writer(STUDY, COLUMNS)
    for k in range(0, 200, 20):
        append(writer, range(k, k + 20))
    with full_disk(), pytest.warns(StoreWarning, match=r"cannot be merged: File too large; no run is lost"):
        writer.close()
    assert_rows(store.table(STUDY), range(200))
    assert len(files(store)) == 10
