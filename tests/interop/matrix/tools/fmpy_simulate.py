"""Adapter for fmpy's loop for one FMU."""

from typing import Any, cast

import numpy as np

from tests.interop.matrix.protocol import FMU, Job, Record, Tool, ordered

TOOL = Tool(
    "fmpy_simulate",
    "fmpy simulate_fmu",
    "fmpy",
    (FMU,),
    "the argument `input`, a structured array; `step_size` and `output_interval` are both the step",
)


def run(job: Job) -> Record:
    """Through the documented call; tunable parameters are columns of `input` too."""
    from fmpy import simulate_fmu

    part = job.parts[0]
    types = {"Real": "f8", "Integer": "i4", "Boolean": "?"}
    names = [job.split(path)[1] for path in job.stimulus]
    inputs = np.zeros(job.n_steps + 1, [("time", "f8"), *((name, types[part.types[name]]) for name in names)])
    inputs["time"] = np.arange(job.n_steps + 1) * job.step
    for path, values in job.stimulus.items():
        inputs[job.split(path)[1]] = values
    outputs = [job.split(column)[1] for column in job.columns]
    result = simulate_fmu(
        part.fmu,
        stop_time=job.n_steps * job.step,
        step_size=job.step,
        output_interval=job.step,
        input=cast("Any", inputs if names else None),  # fmpy takes None too, which its annotation forgets
        output=outputs,
    )
    return ordered(job, {f"{part.name}.{name}": result[name] for name in outputs})
