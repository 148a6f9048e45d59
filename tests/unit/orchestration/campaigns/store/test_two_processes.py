"""Tests that processes which use one store at the same time do not harm each other."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from orchestration.campaigns.store import writer as writer_module
from orchestration.campaigns.store.row_files import Place
from tests.unit.orchestration.campaigns.store.rows import (
    COLUMNS,
    MEASURES,
    STUDY,
    Store,
    append,
    assert_rows,
    files,
    keys,
)

N_RUNS, N_PROCESSES = 300, 3
PROGRAM = """
import random, sys
from orchestration.campaigns.store import writer as writer_module
from tests.unit.orchestration.campaigns.store.rows import COLUMNS, STUDY, Store, append

writer_module.MOST_FILES = 5
numbers = list(range(int(sys.argv[2])))
random.Random(sys.argv[3]).shuffle(numbers)
store = Store.open(sys.argv[1])
with store.writer(STUDY, COLUMNS) as writer:
    print("ready", flush=True)
    sys.stdin.readline()
    for k in numbers:
        append(writer, [k])
"""


def test_processes_that_make_the_same_runs_leave_each_once(tmp_path: Path) -> None:
    started = [
        subprocess.Popen(
            [sys.executable, "-W", "error::UserWarning", "-c", PROGRAM, str(tmp_path), str(N_RUNS), str(i)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for i in range(N_PROCESSES)
    ]
    for process in started:
        assert process.stdout is not None
        assert process.stdin is not None
        assert process.stdout.readline() == "ready\n"
    for process in started:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    store, before, looks = Store.open(tmp_path), 0, 0
    while any(process.poll() is None for process in started):
        there = int(store.find(keys(range(N_RUNS)), MEASURES, STUDY).own.sum())
        assert there >= before  # no run is ever absent once it was there
        before, looks = there, looks + 1
    for process in started:
        process.communicate()
        assert process.returncode == 0
    assert looks > 0
    assert_rows(store.table(STUDY), range(N_RUNS))
    assert len(files(store)) == 1
    assert list((tmp_path / "unfinished").glob("*.part")) == []


def test_files_are_merged_while_no_other_process_does_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store, done = Store.open(tmp_path), []

    @contextmanager
    def lock(path: Path) -> Iterator[None]:
        done.append(path.relative_to(tmp_path).as_posix())
        yield
        done.append("free")

    def merge(place: Place) -> None:
        done.append(f"merge {place.rows.name}")

    monkeypatch.setattr(writer_module, "waiting_lock", lock)
    monkeypatch.setattr(writer_module, "merge", merge)
    with store.writer(STUDY, COLUMNS) as writer:
        append(writer, [1])
    assert done == [f"unfinished/study={STUDY}.lock", f"merge study={STUDY}", "free"]


def test_processes_that_make_a_folder_a_store_at_once_agree(tmp_path: Path) -> None:
    program = "import sys; from orchestration.campaigns.store.store import Store; input(); Store.open(sys.argv[1])"
    command = [sys.executable, "-c", program, str(tmp_path / "runs")]
    started = [subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(3)]
    for process in started:
        _, said = process.communicate("go\n")
        assert (process.returncode, said) == (0, "")
    assert [path.name for path in (tmp_path / "runs").iterdir()] == ["store.json"]
