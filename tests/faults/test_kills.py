"""Commands that are killed leave whole files and no folders: a few moments of `tests.faults.kills`."""

import sys
from pathlib import Path

import pytest

from tests.faults.kills import WORKLOADS, Workload, kill

CHEAP = [workload for workload in WORKLOADS if workload.name != "paper"]  # which takes minutes the first time
MOMENTS = 2


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
@pytest.mark.parametrize("workload", CHEAP, ids=lambda workload: workload.name)
def test_a_kill_leaves_whole_files_and_no_folder(workload: Workload, tmp_path: Path) -> None:
    _, faults = kill(workload, MOMENTS, 7, tmp_path)
    assert faults == []
