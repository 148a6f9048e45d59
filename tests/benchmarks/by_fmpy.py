"""A sweep as people write it with fmpy and joblib: each run unzips its FMUs, loads them and steps them in Python.

The components step in the order of the system, each with the latest values of the others, so the numbers are those of
Gauss-Seidel. Nothing but fmpy, joblib and NumPy is used.
"""

import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any

import numpy as np

from orchestration.system.system import System
from tests.benchmarks.rig import BenchmarkError

CONVERSIONS: dict[str, Any] = {"Real": None, "Integer": int, "Boolean": bool}
"""Types of FMI, and what makes a value of them out of what another component shows."""
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
    """An FMU of one run, unzipped and loaded for it."""

    def __init__(self, file: str, name: str) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave

        self.folder, description = extract(file), read_model_description(file)
        model = description.coSimulation
        if model is None:
            msg = f"{file} is not made for co-simulation."
            raise BenchmarkError(msg)
        self.variables = {v.name: v for v in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=model.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()

    def of_type(self, kind: str, names: Iterable[str]) -> list[str]:
        """Those names whose variables have a type."""
        return [name for name in names if self.variables[name].type == kind]

    def references(self, names: Iterable[str]) -> list[int]:
        """Value references of variables."""
        return [self.variables[name].valueReference for name in names]

    def end(self) -> None:
        """Free the FMU and its folder."""
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


class _Loop:
    """The components of one run, and where the values are that they exchange."""

    def __init__(self, sweep: Sweep, units: Mapping[str, _Unit]) -> None:
        shown = [
            (name, kind, output)
            for name, unit in units.items()
            for kind in CONVERSIONS
            for output in unit.of_type(kind, [n for n, v in unit.variables.items() if v.causality == "output"])
        ]
        self.column = {(name, output): j for j, (name, _, output) in enumerate(shown)}
        self.values: list[Any] = [0.0] * len(shown)
        self.parts = []
        for name, unit in units.items():
            given, sets, gets = sweep.links[name], [], []
            for kind, convert in CONVERSIONS.items():
                inputs = unit.of_type(kind, given)
                if inputs:
                    put, taken = getattr(unit.slave, f"set{kind}"), [self.column[given[i]] for i in inputs]
                    sets.append((put, unit.references(inputs), taken, convert))
                outputs = [output for owner, of_kind, output in shown if (owner, of_kind) == (name, kind)]
                if outputs:
                    begin = self.column[name, outputs[0]]
                    get = getattr(unit.slave, f"get{kind}")
                    gets.append((get, unit.references(outputs), begin, begin + len(outputs)))
            self.parts.append((unit.slave, sets, gets))

    def step(self, t: float, h: float | None) -> None:
        """Let each component take its inputs, step unless h is None, as during initialization, and show its outputs."""
        values = self.values
        for slave, sets, gets in self.parts:
            for put, references, taken, convert in sets:
                put(references, [convert(values[j]) for j in taken] if convert else [values[j] for j in taken])
            if h is not None:
                slave.doStep(t, h)
            for get, references, begin, end in gets:
                values[begin:end] = get(references)

    def norm(self, component: str, array: str) -> float:
        """Euclidean norm of an array of two outputs."""
        first, second = (self.values[self.column[component, f"{array}[{i}]"]] for i in (1, 2))
        return float(np.sqrt(first * first + second * second))


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
        starts = {**sweep.starts[name], **varied}
        for kind, convert in CONVERSIONS.items():
            names = unit.of_type(kind, starts)
            if names:
                values = [(convert or float)(starts[n]) for n in names]
                getattr(unit.slave, f"set{kind}")(unit.references(names), values)
        unit.slave.setupExperiment(startTime=0.0)
        unit.slave.enterInitializationMode()
    loop, n = _Loop(sweep, units), round(sweep.stop_time / sweep.step)
    for _ in range(len(units) + 1):  # until the last output has reached the last input
        loop.step(0.0, None)
    for unit in units.values():
        unit.slave.exitInitializationMode()
    force, error = np.empty(n + 1), np.empty(n)
    force[0] = loop.norm(*FORCE)
    for k in range(n):
        loop.step(k * sweep.step, sweep.step)
        force[k + 1], error[k] = loop.norm(*FORCE), loop.norm(*ERROR)
    return force, error


def timed(sweep: Sweep, given: Mapping[str, float]) -> tuple[float, tuple[float, float, float]]:
    """Make one run; return its processor time, s, and its measures."""
    begin = process_time()
    found = measured(sweep, given)
    return process_time() - begin, found


def time_sweep(sweep: Sweep, rows: Sequence[Mapping[str, float]], workers: int) -> tuple[dict[str, float], np.ndarray]:
    """Make runs by processes of joblib, which are there already.

    Returns
    -------
    dict and ndarray
        Time of a run, s: ``wall``, of all runs together divided by their number, and ``processor``; and the measures,
        shape (n, 3).
    """
    from joblib import Parallel, delayed

    with Parallel(n_jobs=workers) as parallel:
        parallel(delayed(measured)(short_of(sweep), row) for row in list(rows)[:1] * workers)
        begin = perf_counter()
        found: Any = parallel(delayed(timed)(sweep, row) for row in rows)
        seconds = perf_counter() - begin
    processor = float(np.mean([seconds for seconds, _ in found]))
    times = {"wall": seconds / len(rows), "processor": processor}
    return times, np.array([measures for _, measures in found])


def short_of(sweep: Sweep) -> Sweep:
    """The sweep with runs of two steps, so that processes have imported what they need."""
    return Sweep(sweep.files, sweep.starts, sweep.links, sweep.step, 2 * sweep.step)
