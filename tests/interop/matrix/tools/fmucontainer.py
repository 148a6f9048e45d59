"""Adapter for a container FMU by fmu_manipulation_toolbox, run by fmpy."""

import logging
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

import numpy as np

from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Record, Tool, ordered

TOOL = Tool(
    "fmucontainer",
    "fmucontainer",
    "fmu-manipulation-toolbox",
    (FMU, SYSTEM),
    "a container with this one FMU, in fmpy's `simulate_fmu`; inputs are inputs of the container",
)
OUTPUT, INPUT = "shown.", "driven."


def run(job: Job) -> Record:
    """Parallel stepping; start values are the container's."""
    with TemporaryDirectory() as folder:
        return simulated(job, packed(job, Path(folder)))


def packed(job: Job, folder: Path) -> Path:
    """Write ``container.fmu``; inputs in the stimulus and all outputs are its own."""
    from fmu_manipulation_toolbox.assembly import AssemblyNode

    logging.getLogger("fmu_manipulation_toolbox").setLevel(logging.ERROR)
    quiet = {"auto_link": False, "auto_input": False, "auto_output": False}
    node = AssemblyNode("container.fmu", step_size=job.step, **quiet)
    # Initialization goes once through the FMUs and cuts a loop before its first: the plant, whose motion at the
    # start needs no input.
    for part in (job.parts[-1], *job.parts[:-1]):
        node.add_fmu(f"{part.name}.fmu", part.fmu)
        for name, value in part.start.items():
            if f"{part.name}.{name}" not in job.stimulus:
                node.add_start_value(f"{part.name}.fmu", name, str(part.value(name, value)).lower())
    for source, output, target, input_ in job.connections:
        node.add_link(f"{source}.fmu", output, f"{target}.fmu", input_)
    for path in job.stimulus:
        part, name = job.split(path)
        node.add_input(INPUT + path, f"{part.name}.fmu", name)
    for path in job.columns:
        part, name = job.split(path)
        node.add_output(f"{part.name}.fmu", name, OUTPUT + path)
    node.make_fmu(folder)
    return folder / "container.fmu"


def simulated(job: Job, container: Path) -> Record:
    """The container in fmpy."""
    from fmpy import simulate_fmu

    types = {"Real": "f8", "Integer": "i4", "Boolean": "?"}
    fields = [(INPUT + path, types[job.split(path)[0].types[job.split(path)[1]]]) for path in job.stimulus]
    inputs = np.zeros(job.n_steps + 1, [("time", "f8"), *fields])
    inputs["time"] = np.arange(job.n_steps + 1) * job.step
    for path, values in job.stimulus.items():
        inputs[INPUT + path] = values
    result = simulate_fmu(
        str(container),
        stop_time=job.n_steps * job.step,
        step_size=job.step,
        output_interval=job.step,
        input=cast("Any", inputs if fields else None),  # fmpy takes None too, which its annotation forgets
        output=[OUTPUT + column for column in job.columns],
    )
    return ordered(job, {column: result[OUTPUT + column] for column in job.columns})
