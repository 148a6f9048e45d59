"""Adapter for libcosim through libcosimpy."""

from pathlib import Path

from tests.interop.matrix.protocol import FMU, NANOSECONDS, SYSTEM, Job, Record, Tool
from tests.interop.peers import run_libcosim

TOOL = Tool(
    "libcosim",
    "libcosimpy",
    "libcosimpy",
    (FMU, SYSTEM),
    "an override manipulator before each step",
    clock=NANOSECONDS,
)


def run(job: Job) -> Record:
    """An SSP package; row 0 is not shown."""
    values = run_libcosim(Path(job.ssp), round(job.step * 1e9), job.n_steps, job.columns, job.stimulus)
    return Record(values, job.columns, first=1)
