"""Adapter for CoFMuPy, formerly CoFMPy."""

import csv
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.interop.matrix.protocol import FMU, LOOP_AT_ONCE, SYSTEM, Job, Record, Tool, ordered

TOOL = Tool(
    "cofmupy",
    "CoFMuPy",
    "cofmupy",
    (FMU, SYSTEM),
    "a CSV stream with `previous` interpolation",
    algorithm=LOOP_AT_ONCE,
    requirements=("cofmupy==1.0.0", "numpy"),
)


def run(job: Job) -> Record:
    """Its Jacobi loop, before which it steps what has no inputs; inputs start with what initialization gives here."""
    from cofmupy import Coordinator

    fmus = [
        {"id": p.name, "name": p.name, "path": p.fmu, "initialization": {**p.initial, **p.start}} for p in job.parts
    ]
    connections = [
        {"source": {"id": a, "variable": b, "unit": "", "type": "fmu"}, "target": [_end(c, d)]}
        for a, b, c, d in job.connections
    ]
    with TemporaryDirectory() as folder:
        table = Path(folder) / "inputs.csv"
        _write(job, table)
        for path in job.stimulus:
            part, name = job.split(path)
            source = {"type": "csv", "path": str(table), "variable": path, "interpolation": "previous"}
            connections.append({"source": source, "target": [_end(part.name, name)]})
        config = {"fmus": fmus, "connections": connections, "cosim_method": "jacobi", "iterative": False}
        coordinator = Coordinator()
        coordinator.start({**config, "edge_sep": " -> ", "root": folder, "data_storages": []})
        for _ in range(job.n_steps):
            coordinator.do_step(job.step)
    found = coordinator.get_results()
    return ordered(job, {f"{key[0]}.{key[1]}": values for key, values in found.items() if key != "time"}, first=1)


def _end(component: str, variable: str) -> dict[str, str]:
    return {"id": component, "variable": variable, "unit": "", "type": "fmu"}


def _write(job: Job, table: Path) -> None:
    """The stimulus; times are a hundredth of a step early, because it sums its own."""
    with table.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["t", *job.stimulus])
        for k in range(job.n_steps + 1):
            rows.writerow([repr((k - 0.01) * job.step), *(repr(values[k]) for values in job.stimulus.values())])
