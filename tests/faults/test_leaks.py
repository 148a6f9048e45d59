"""A thousand runs that fail in one process leave nothing behind in it."""

import json
import os
import statistics
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from adaptimp_fmu.package import definition
from tests.faults.shim.fmus import decay, healthy, misbehaving
from tests.faults.shim.thousand import FIRST, PART, RUNS_IN_ALL
from tests.strangers.fmus import packed

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/proc says what a process holds")

REPOSITORY = Path(__file__).parents[2]
GROWTH = 10
"""Accepted growth of the resident memory, kB for each run; a library that stays loaded takes 60 kB or more.

A pool of the process takes 6 MB at once, at some time, and never again (3,000 runs). So the growth is that of the
median part of the runs, in which a leak shows as in any other part.
"""


@pytest.fixture
def fmus(tmp_path: Path) -> list[Path]:
    """The FMU that misbehaves, a healthy one, and one whose library is no library."""
    torn = tmp_path / "torn"
    torn.write_text("not a library")
    description = definition(decay("Torn", 1.0, 0.0))[1].decode()
    return [misbehaving(tmp_path), healthy(tmp_path), packed(tmp_path / "Torn.fmu", torn, description)]


def test_a_thousand_failures_leave_nothing(fmus: list[Path], tmp_path: Path) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    environment = {**os.environ, "TMPDIR": str(scratch), "PYTHONPATH": str(REPOSITORY)}
    command = [sys.executable, "-m", "tests.faults.shim.thousand", *fmus]
    process = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    told = json.loads(process.stdout)
    before, after = told["before"], told["after"]
    errors = ("InitializationError", "SimulationError", "ArchiveError", "RunInterrupted", "SignalError")
    assert min(told["errors"].get(kind, 0) for kind in errors) > 20
    assert sum(told["errors"].values()) > 0.9 * RUNS_IN_ALL  # algorithms without states ignore faults in states
    assert (after["descriptors"], after["threads"]) == (before["descriptors"], before["threads"])
    assert after["temporary"] == before["temporary"]
    assert list(scratch.iterdir()) == []
    # The allocator of Python maps new arenas now and then; a library that stays loaded has five mappings.
    assert after["mappings"] - before["mappings"] < 30
    growth = statistics.median(later - earlier for earlier, later in pairwise(told["resident"]))
    assert len(told["resident"]) == (RUNS_IN_ALL - FIRST) // PART + 1
    assert growth < GROWTH * PART
