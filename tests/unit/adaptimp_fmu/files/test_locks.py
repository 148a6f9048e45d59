"""Tests that one process at a time has a lock that others wait for."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from adaptimp_fmu.files.locks import waiting_lock

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no locks of this kind, nor SIGKILL")
COUNTED, WORKERS = 300, 4
PROGRAM = """
import os, signal, sys
from pathlib import Path
from adaptimp_fmu.files.locks import waiting_lock
with waiting_lock(Path(sys.argv[1])):
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_who_reads_and_writes_under_the_lock_loses_no_count(tmp_path: Path) -> None:
    counter = tmp_path / "counter"
    counter.write_text("0")

    def count() -> None:
        for _ in range(COUNTED):
            with waiting_lock(tmp_path / "counter.lock"):
                counter.write_text(str(int(counter.read_text()) + 1))

    workers = [threading.Thread(target=count) for _ in range(WORKERS)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert int(counter.read_text()) == COUNTED * WORKERS


def test_the_lock_of_a_killed_process_is_free(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM, str(tmp_path / "lock")], check=False)
    assert done.returncode == -9
    with waiting_lock(tmp_path / "lock"):
        assert (tmp_path / "lock").exists()
