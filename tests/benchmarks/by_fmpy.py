"""A sweep as people write it with fmpy and joblib: each run unzips its FMUs, loads them and steps them in Python.

The components step in the order of the system, each with the latest values of the others, so the numbers are those of
Gauss-Seidel. Nothing but fmpy, joblib and NumPy is used.
"""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from orchestration.system.system import System

FORCE, ERROR = ("plant", "F_ext"), ("controller", "e")


@dataclass(frozen=True)
class Sweep:
    """A system in plain values, which another process can take.

    Attributes
    ----------
    files
        FMU files by component, in the order of stepping.
    starts
        Start values by component and name.
    links
        Source and its output for each input of a component.
    step, stop_time
        Communication step and stop time, s.
    """

    files: Mapping[str, str]
    starts: Mapping[str, Mapping[str, float]]
    links: Mapping[str, Mapping[str, tuple[str, str]]]
    step: float
    stop_time: float

    @classmethod
    def of(cls, system: System, stop_time: float) -> "Sweep":
        """Return the values of a system."""
        links: dict[str, dict[str, tuple[str, str]]] = {component.name: {} for component in system.components}
        for c in system.connections:
            links[c.target][c.input] = (c.source, c.output)
        return cls(
            {c.name: str(c.path) for c in system.components},
            {c.name: {name: float(value) for name, value in c.start.items()} for c in system.components},
            links,
            system.run_step(),
            stop_time,
        )


class _Unit:
    """An FMU of one run, and what it exchanges."""

    def __init__(self, file: str, name: str) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave

        self.folder, description = extract(file), read_model_description(file)
        self.variables = {v.name: v for v in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by their names, those of a type in one call."""
        for kind, put in (
            ("Real", self.slave.setReal),
            ("Integer", self.slave.setInteger),
            ("Boolean", self.slave.setBoolean),
        ):
            names = [name for name in values if self.variables[name].type == kind]
            if names:
                convert: Any = {"Real": float, "Integer": int, "Boolean": bool}[kind]
                put([self.variables[name].valueReference for name in names], [convert(values[name]) for name in names])

    def get(self, names: Sequence[str]) -> dict[str, float]:
        """Variables by their names."""
        found: dict[str, float] = {}
        for kind, ask in (
            ("Real", self.slave.getReal),
            ("Integer", self.slave.getInteger),
            ("Boolean", self.slave.getBoolean),
        ):
            asked = [name for name in names if self.variables[name].type == kind]
            if asked:
                values = ask([self.variables[name].valueReference for name in asked])
                found |= dict(zip(asked, map(float, values), strict=True))
        return found

    def end(self) -> None:
        """Free the FMU and its folder."""
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def measured(sweep: Sweep, given: Mapping[str, float]) -> tuple[float, float, float]:
    """Make one run with other start values; return peak force, largest error, and rms error in contact."""
    units = {name: _Unit(file, name) for name, file in sweep.files.items()}
    try:
        force, error = _stepped(sweep, units, given)
    finally:
        for unit in units.values():
            unit.end()
    touching = force[:-1] > 0
    squares = np.add.accumulate((error * error)[touching])
    rms = float(np.sqrt(squares[-1] / len(squares))) if len(squares) else float("nan")
    return float(force.max()), float(error.max()), rms


def _stepped(sweep: Sweep, units: Mapping[str, _Unit], given: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Norms of the force at the communication points, and of the error over the steps."""
    for name, unit in units.items():
        varied = {path.partition(".")[2]: value for path, value in given.items() if path.startswith(f"{name}.")}
        unit.set({**sweep.starts[name], **varied})
        unit.slave.setupExperiment(startTime=0.0)
        unit.slave.enterInitializationMode()
    shown = {
        name: [output for output, v in unit.variables.items() if v.causality == "output"]
        for name, unit in units.items()
    }
    values = {name: unit.get(shown[name]) for name, unit in units.items()}
    for _ in units:  # until the last output has reached the last input
        for name, unit in units.items():
            unit.set({into: values[source][output] for into, (source, output) in sweep.links[name].items()})
            values[name] = unit.get(shown[name])
    for unit in units.values():
        unit.slave.exitInitializationMode()
    n = round(sweep.stop_time / sweep.step)
    force, error = np.empty(n + 1), np.empty(n)
    force[0] = _norm(values, *FORCE)
    for k in range(n):
        t = k * sweep.step
        for name, unit in units.items():
            unit.set({into: values[source][output] for into, (source, output) in sweep.links[name].items()})
            unit.slave.doStep(currentCommunicationPoint=t, communicationStepSize=sweep.step)
            values[name] = unit.get(shown[name])
        force[k + 1], error[k] = _norm(values, *FORCE), _norm(values, *ERROR)
    return force, error


def _norm(values: Mapping[str, Mapping[str, float]], component: str, array: str) -> float:
    first, second = (values[component][f"{array}[{i}]"] for i in (1, 2))
    return float(np.sqrt(first * first + second * second))


def time_sweep(sweep: Sweep, rows: Sequence[Mapping[str, float]], workers: int) -> tuple[float, np.ndarray]:
    """Make runs by processes of joblib, which are there already; return the wall time, s, and the measures of each."""
    from joblib import Parallel, delayed

    with Parallel(n_jobs=workers) as parallel:
        parallel(delayed(measured)(short_of(sweep), row) for row in list(rows)[:1] * workers)
        begin = perf_counter()
        found = list(parallel(delayed(measured)(sweep, row) for row in rows))
    return perf_counter() - begin, np.array(found)


def short_of(sweep: Sweep) -> Sweep:
    """The sweep with runs of two steps, so that processes have imported what they need."""
    return Sweep(sweep.files, sweep.starts, sweep.links, sweep.step, 2 * sweep.step)
