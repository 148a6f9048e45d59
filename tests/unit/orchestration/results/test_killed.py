"""Tests that a killed process leaves the old file, and rows that can be read."""

import os
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu.files.locks import locked_new_file
from orchestration import OrchestrationError, Result
from orchestration.results import arrow_table
from orchestration.results.parquet_file import ParquetSink
from orchestration.results.texts import ROW_BYTES
from tests.unit.orchestration.stored import NAMES, UNITS, assert_same_values, described, files, sample, stream

N_ROWS = 200
pytestmark = [
    pytest.mark.usefixtures("small_groups"),
    pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL and no locks of this kind"),
]
PROGRAM = """
import os, signal, sys
from pathlib import Path
from orchestration.results import arrow_table
from orchestration.results.parquet_file import ParquetSink
from tests.unit.orchestration.stored import NAMES, UNITS, described, sample
arrow_table.ROW_GROUP_BYTES = int(sys.argv[2])
result = described(sample(200))
ticks = {"steps_per_tick": result.steps_per_tick, "sample_times": result.sample_times}
with ParquetSink(Path(sys.argv[1]), NAMES, UNITS, **ticks) as sink:
    sink.append(result.time, result.rows)
    os.kill(os.getpid(), signal.SIGKILL)
"""


def killed(path: Path, group_bytes: int) -> Path:
    """The draft that a process leaves which was killed after `N_ROWS` rows."""
    done = subprocess.run([sys.executable, "-c", PROGRAM, str(path), str(group_bytes)], check=False)
    assert done.returncode == -9
    (draft,) = path.parent.glob("*.part")
    return draft


def test_complete_groups_of_a_killed_stream_can_be_read(tmp_path: Path, small_groups: int) -> None:
    (tmp_path / "x.parquet").write_text("old")
    draft = killed(tmp_path / "x.parquet", 8 * (len(NAMES) + 1) * small_groups)
    assert (tmp_path / "x.parquet").read_text() == "old"
    back, whole = Result.read(draft), described(sample(N_ROWS))
    kept = (N_ROWS - 1) // small_groups * small_groups  # the last group was in memory
    assert kept > 0
    assert len(back.time) == kept
    assert_same_values(back, Result(whole.time[:kept], NAMES, whole.rows[:kept]))
    assert (back.units, back.steps_per_tick, back.sample_times) == (UNITS, whole.steps_per_tick, whole.sample_times)
    assert (back.status, back.message) == ("interrupted", "The process was killed.")


def test_the_next_writer_keeps_the_rows_of_a_killed_one(tmp_path: Path, small_groups: int) -> None:
    draft = killed(tmp_path / "x.parquet", 8 * (len(NAMES) + 1) * small_groups)
    before = Result.read(draft)
    stream(ParquetSink(tmp_path / "x.parquet", NAMES), sample(10), 10)
    assert files(tmp_path) == ["x.parquet", "x.partial.parquet"]
    back = Result.read(tmp_path / "x.partial.parquet")
    assert_same_values(back, before)
    assert (back.status, back.units) == ("interrupted", UNITS)


def test_a_draft_without_rows_is_removed(tmp_path: Path) -> None:
    killed(tmp_path / "x.parquet", 2**24)
    stream(ParquetSink(tmp_path / "x.parquet", NAMES), sample(10), 10)
    assert files(tmp_path) == ["x.parquet"]


def test_a_draft_cut_anywhere_gives_whole_groups_or_an_error(tmp_path: Path, small_groups: int) -> None:
    whole = killed(tmp_path / "x.parquet", 8 * (len(NAMES) + 1) * small_groups).read_bytes()
    cut = tmp_path / "cut.parquet.0.part"
    lengths = set()
    for end in (*range(0, len(whole), 101), len(whole)):
        cut.write_bytes(whole[:end])
        with suppress(OrchestrationError):
            lengths.add(len(Result.read(cut).time))
    cut.write_bytes(whole[:200])
    with pytest.raises(OrchestrationError, match="does not hold a result: it ends before its first row"):
        Result.read(cut)
    assert lengths == {small_groups, 2 * small_groups, 3 * small_groups}


def test_two_writers_of_one_file_do_not_mix(tmp_path: Path) -> None:
    first, second = (ParquetSink(tmp_path / "x.parquet", NAMES) for _ in range(2))
    one, two = sample(130), sample(70)
    with first:
        first.append(one.time[:65], one.rows[:65])
        stream(second, two, 7)
        assert_same_values(Result.read(tmp_path / "x.parquet"), two)
        first.append(one.time[65:], one.rows[65:])
    assert_same_values(Result.read(tmp_path / "x.parquet"), one)
    assert files(tmp_path) == ["x.parquet"]


def test_a_link_in_the_place_of_a_draft_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("mine")
    (tmp_path / "x.parquet.part").symlink_to(tmp_path / "precious")
    stream(ParquetSink(tmp_path / "x.parquet", NAMES), sample(10), 10)
    assert (tmp_path / "precious").read_text() == "mine"
    (tmp_path / "link").symlink_to(tmp_path / "precious")
    with pytest.raises(FileExistsError):
        locked_new_file(tmp_path / "link")
    assert os.readlink(tmp_path / "link") == str(tmp_path / "precious")


def test_texts_of_a_killed_stream_can_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrow_table, "ROW_GROUP_BYTES", 60 * (8 * (len(NAMES) + 1) + 2 * ROW_BYTES))
    result = sample(N_ROWS)
    texts = {"m.s": np.array([f"größer {k}" for k in range(N_ROWS)], object), "m.t": np.full(N_ROWS, "", object)}
    with ParquetSink(tmp_path / "x.parquet", NAMES, texts=tuple(texts)) as sink:
        sink.append(result.time, result.rows, texts)
        (draft,) = tmp_path.glob("*.part")
        shutil.copy(draft, tmp_path / "copy.parquet.0.part")
    back = Result.read(tmp_path / "copy.parquet.0.part")
    assert len(back.time) == 180
    assert_same_values(back, Result(result.time[:180], NAMES, result.rows[:180]))
    assert {name: column.tolist() for name, column in back.texts.items()} == {
        name: column[:180].tolist() for name, column in texts.items()
    }
