"""Adapter for fmuloader, a binding of FMI's functions without a loop of its own."""

import xml.etree.ElementTree as ET
from typing import Any
from zipfile import ZipFile

import numpy as np

from tests.interop.matrix.protocol import FMU, Job, Record, Tool

TOOL = Tool(
    "fmuloader",
    "fmuloader",
    "fmuloader",
    (FMU,),
    "`set_real`, `set_boolean` before each step",
    requirements=("fmuloader==0.1.2rc0", "numpy"),
)


def run(job: Job) -> Record:
    """The loop is written here; the first inputs are set in initialization mode."""
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

    part = job.parts[0]
    with ZipFile(part.fmu) as archive:
        about = ET.fromstring(archive.read("modelDescription.xml"))
    slave: Any = Fmi2Slave(part.fmu, model_identifier=next(about.iter("CoSimulation")).attrib["modelIdentifier"])
    slave.instantiate(part.name, Fmi2Type.CO_SIMULATION, guid=about.attrib["guid"])
    slave.setup_experiment(start_time=0.0)
    slave.enter_initialization_mode()
    _set(job, slave, 0)
    slave.exit_initialization_mode()
    rows = [_get(job, slave)]
    for k in range(job.n_steps):
        _set(job, slave, k)
        slave.do_step(k * job.step, job.step)
        rows.append(_get(job, slave))
    slave.terminate()
    slave.free_instance()
    return Record(np.array(rows, dtype=float), job.columns)


def _set(job: Job, slave: Any, k: int) -> None:
    """The inputs of step k."""
    for path, values in job.stimulus.items():
        part, name = job.split(path)
        setter = getattr(slave, f"set_{part.types[name].lower()}")
        setter([part.references[name]], [part.value(name, values[k])])


def _get(job: Job, slave: Any) -> list[float]:
    """All columns now."""
    found = []
    for part, name in map(job.split, job.columns):
        found += getattr(slave, f"get_{part.types[name].lower()}")([part.references[name]])
    return found
