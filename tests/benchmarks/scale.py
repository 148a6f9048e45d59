"""Measures how the start of a run grows with the size of the system.

    python -m tests.benchmarks.scale [--json FILE] [--wiring NAME ...] [--size COMPONENTS WIDTH PARAMETERS]

Systems of `tests.benchmarks.wide` of a size, of twice and of four times as many components. For each the processor
time of making the `System`, of writing it as a package and reading that, of `prepare`, of opening and initializing,
and of the first step, all in one process; and the memory that the process took at most. `growth` is the exponent p of
time ~ size^p from the smallest to the largest. Compilation is done before.
"""

import argparse
import gc
import math
import sys
import tempfile
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from time import process_time
from typing import Any

from rich.console import Console
from rich.table import Table

from orchestration.master.simulate import UnconnectedInputWarning, prepare
from orchestration.system.system import System
from tests.benchmarks.report import machine, versions, write_json
from tests.benchmarks.wide import STEP, WIRINGS, Size, wide_fmu, wide_system

FACTORS = (1, 2, 4)
DEFAULT = Size(components=25, width=100, parameters=800)
PHASES = ("system", "write", "read", "prepare", "enter", "first step")
SHORTEST = 1e-3  # s: the growth of less than this is not told
MB = 1e6
WIDTH = 120  # columns of the tables


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Start of a run against size.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--wiring", nargs="+", choices=WIRINGS, default=list(WIRINGS))
    parser.add_argument("--size", nargs=3, type=int, help="components, inputs and parameters of each")
    given = parser.parse_args(arguments)
    result = run(given.wiring, Size(*given.size) if given.size else DEFAULT)
    _print(result, Console(width=WIDTH))
    write_json(given.json, result)
    return 0


def run(wirings: Sequence[str] = tuple(WIRINGS), size: Size = DEFAULT) -> dict[str, Any]:
    """Measure everything.

    Returns
    -------
    dict
        ``sizes``: a record for each wiring and size: numbers of components, variables and connections, s by phase,
        and peak memory, bytes; ``growth``: exponents by wiring and phase; ``machine`` and ``versions``.
    """
    measure("chain", Size(2, 1))  # compiles
    records = [
        measure(wiring, Size(factor * size.components, size.width, size.parameters))
        for wiring in wirings
        for factor in FACTORS
    ]
    found = {wiring: [record for record in records if record["wiring"] == wiring] for wiring in wirings}
    growth = {wiring: {phase: _growth(rows, phase) for phase in PHASES} for wiring, rows in found.items()}
    return {"sizes": records, "growth": growth, "machine": machine(), "versions": versions()}


def measure(wiring: str, size: Size) -> dict[str, Any]:
    """Processor time of each phase for one system, s."""
    seconds: dict[str, float] = {}

    def timed(phase: str, work: Callable[[], Any]) -> Any:
        gc.collect()
        begin = process_time()
        result = work()
        seconds[phase] = process_time() - begin
        return result

    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        fmu, package = wide_fmu(Path(folder), size.width, size.parameters), Path(folder) / "wide.ssp"
        system = timed("system", lambda: wide_system(fmu, wiring, size))
        timed("write", lambda: system.write(package))
        timed("read", lambda: System.read(package))
        simulation = timed("prepare", lambda: prepare(system))
        timed("enter", simulation.__enter__)
        timed("first step", lambda: simulation.run(until=STEP))
        simulation.__exit__(None, None, None)
    counts = {
        "components": size.components,
        "variables": size.variables,
        "connections": len(system.connections),
    }
    return {"wiring": wiring, **counts, **seconds, "peak": _peak()}


def _growth(rows: Sequence[dict[str, Any]], phase: str) -> float | None:
    """Exponent p of time ~ size^p; None where the time is too short to tell."""
    first, last = rows[0], rows[-1]
    if len(rows) < 2 or first[phase] < SHORTEST:
        return None
    return math.log(last[phase] / first[phase]) / math.log(last["components"] / first["components"])


def _peak() -> int:
    """Most memory that the process has held, bytes."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def _print(result: dict[str, Any], console: Console) -> None:
    head = ("wiring", "components", "variables", "connections")
    table = Table(*head, *PHASES, "peak, MB", title="Processor time of the start, s")
    for record in result["sizes"]:
        seconds = (f"{record[phase]:.3f}" for phase in PHASES)
        table.add_row(*(str(record[key]) for key in head), *seconds, f"{record['peak'] / MB:.0f}")
    console.print(table)
    table = Table("growth", *PHASES)
    for wiring, found in result["growth"].items():
        table.add_row(wiring, *("-" if found[p] is None else f"{found[p]:.2f}" for p in PHASES))
    console.print(table)


if __name__ == "__main__":
    raise SystemExit(main())
