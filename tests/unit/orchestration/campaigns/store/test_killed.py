"""Tests that a killed process loses no run that it appended, and disturbs no process that comes later.

A program kills itself before one of the things that it does to the file system, or when it has written half of a file;
this is done for each of them.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from adaptimp_fmu.files.locks import locked_new_file
from tests.unit.orchestration.campaigns.store.rows import (
    COLUMNS,
    MEASURES,
    STUDY,
    Store,
    assert_rows,
    files,
    filled,
    keys,
)

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL and no locks of this kind")
N_RUNS = 7
PROGRAM = """
import io, os, signal, sys
import pandas, pyarrow.parquet  # once, before the forks
from pathlib import Path
from orchestration.campaigns.store import writer as writer_module
from tests.unit.orchestration.campaigns.store.rows import COLUMNS, STUDY, Store, append

folder, n_runs = Path(sys.argv[1]), int(sys.argv[2])
writer_module.MOST_FILES = 3
DONE_TO_FILES = {"open", "os.rename", "os.remove", "os.mkdir", "os.scandir", "fcntl.flock"}

def campaign(place, moment):
    count = 0
    def may_die():
        nonlocal count
        if count == moment:
            os.kill(os.getpid(), signal.SIGKILL)
        count += 1
    def look(event, arguments):
        if event in DONE_TO_FILES and (event == "fcntl.flock" or str(folder) in repr(arguments)):
            may_die()
    class Halves(io.FileIO):
        def write(self, content):
            for part in (content[: len(content) // 2], content[len(content) // 2 :]):
                super().write(part)
                may_die()
    sys.addaudithook(look)
    os.fdopen = Halves
    appended = os.open(place.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    with Store.open(place).writer(STUDY, COLUMNS) as writer:
        for k in range(n_runs):
            append(writer, [k])
            os.write(appended, b"x")

moment, status = 0, 1
while status != 0:  # until the program comes to its end before the moment
    process = os.fork()
    if process == 0:
        campaign(folder / str(moment), moment)
        os._exit(0)
    status = os.waitpid(process, 0)[1]
    if status not in (0, signal.SIGKILL):
        sys.exit(f"the program ended with {status} at moment {moment}")
    moment += 1
print(moment - 1)
"""


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Path, int]]:
    """Folder of the store of each moment, and the number of runs whose appending had returned."""
    folder = tmp_path_factory.mktemp("killed")
    command = [sys.executable, "-c", PROGRAM, str(folder), str(N_RUNS)]
    moments = int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert moments > 5 * N_RUNS  # each run opens a draft, locks it, writes two halves and renames it
    places = [folder / str(moment) for moment in range(moments)]
    return [(place, _length(place.with_suffix(".log"))) for place in places]


def _length(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0


def test_no_appended_run_is_lost(killed: list[tuple[Path, int]]) -> None:
    assert {appended for _, appended in killed} == set(range(N_RUNS + 1))
    for place, appended in killed:
        if appended:
            found = Store.open(place).find(keys(range(N_RUNS)), MEASURES, STUDY)
            assert found.own.tolist()[:appended] == [True] * appended
            assert_rows(Store.open(place).table(STUDY), range(int(found.own.sum())))


def test_the_next_process_completes_the_store_and_tidies_up(killed: list[tuple[Path, int]], tmp_path: Path) -> None:
    undisturbed = files(filled(tmp_path, [range(N_RUNS)]))
    for place, _ in killed:
        store = Store.open(place)
        missing = [k for k, own in enumerate(store.find(keys(range(N_RUNS)), MEASURES, STUDY).own) if not own]
        filled(place, [missing])
        assert [(p.name, p.read_bytes()) for p in files(store)] == [(p.name, p.read_bytes()) for p in undisturbed]
        assert list((place / "unfinished").glob("*.part")) == []
        assert sorted(path.name for path in place.iterdir()) == ["rows", "store.json", "unfinished"]


def test_drafts_of_living_processes_stay(tmp_path: Path) -> None:
    Store.open(tmp_path).writer(STUDY, COLUMNS)
    living, dead = tmp_path / "unfinished" / "living.part", tmp_path / "unfinished" / "dead.part"
    descriptor = locked_new_file(living)
    assert descriptor is not None
    dead.touch()
    Store.open(tmp_path)
    assert (living.exists(), dead.exists()) == (True, False)
    os.close(descriptor)
    Store.open(tmp_path)
    assert not living.exists()
