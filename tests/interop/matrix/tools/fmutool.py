"""Adapter for the checks of fmu_manipulation_toolbox."""

import subprocess
import sys

from tests.interop.matrix.protocol import CHECKED, FMU, Job, Record, Tool, ToolError

TOOL = Tool("fmutool", "fmutool -check", "fmu-manipulation-toolbox", (FMU,))


def run(job: Job) -> Record:
    """``fmutool -input X.fmu -check``: any warning or error is reported."""
    call = "from fmu_manipulation_toolbox.cli.fmutool import fmutool; fmutool()"
    command = [sys.executable, "-c", call, "-input", job.parts[0].fmu, "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = (done.stdout + done.stderr).splitlines()
    complaints = [line.partition("|")[2].strip() for line in lines if line.startswith(("WARNING", "ERROR"))]
    if complaints or done.returncode != 0:
        raise ToolError("; ".join(complaints) or f"exit code {done.returncode}")
    return CHECKED
