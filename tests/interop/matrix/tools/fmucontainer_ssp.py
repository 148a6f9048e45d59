"""Adapter for a container FMU that fmu_manipulation_toolbox makes of an SSP package by itself, run by fmpy."""

import logging
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.interop.matrix.protocol import SYSTEM, Job, Record, Tool, ToolError, ordered

TOOL = Tool("fmucontainer_ssp", "fmucontainer X.ssp", "fmu-manipulation-toolbox", (SYSTEM,))


def run(job: Job) -> Record:
    """As ``fmucontainer -container X.ssp:STEP`` does."""
    from fmpy import read_model_description, simulate_fmu
    from fmu_manipulation_toolbox.assembly import Assembly

    logging.getLogger("fmu_manipulation_toolbox").setLevel(logging.ERROR)
    with TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(job.ssp, folder / "system.ssp")
        Assembly("system.ssp", default_step_size=job.step, fmu_directory=folder).make_fmu()
        container = str(next(folder.glob("*.fmu")))
        outputs = [v.name for v in read_model_description(container).modelVariables if v.causality == "output"]
        if not outputs:
            msg = "the container has no outputs; the packages' start values are not in it either"
            raise ToolError(msg)
        result = simulate_fmu(
            container, stop_time=job.n_steps * job.step, step_size=job.step, output_interval=job.step, output=outputs
        )
        return ordered(job, {name: result[name] for name in outputs})
