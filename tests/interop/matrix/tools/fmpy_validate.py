"""Adapter for fmpy's static check."""

from tests.interop.matrix.protocol import CHECKED, FMU, Job, Record, Tool, ToolError

TOOL = Tool("fmpy_validate", "fmpy validate", "fmpy", (FMU,))


def run(job: Job) -> Record:
    """No problem, or an error with all of them."""
    from fmpy.validation import validate_fmu

    if problems := validate_fmu(job.parts[0].fmu):
        raise ToolError("; ".join(problems))
    return CHECKED
