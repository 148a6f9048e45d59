"""Adapter for ecos through ecospy."""

from pathlib import Path

from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Record, Tool
from tests.interop.peers import run_ecospy

TOOL = Tool("ecospy", "ecospy", "ecospy", (FMU, SYSTEM), "`set_real`, `set_bool` before each step")


def run(job: Job) -> Record:
    """An SSP package, its one parameter set named."""
    values = run_ecospy(Path(job.ssp), job.step, job.n_steps, job.columns, job.stimulus)
    return Record(values, job.columns)
