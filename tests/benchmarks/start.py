"""Measures the cost of a run besides its steps: imports, compilation and memory.

    python -m tests.benchmarks.start [--json FILE] [--repetitions N] [--rows N]

Everything is measured in fresh processes (`tests.benchmarks.child`): the import of packages; the first
`simulate` of two trivial components, after the imports, with an empty folder of machine code (cold) and with
what this left there (cached), in elapsed time and in processor time, which other jobs disturb less; and the
peak memory of long runs above that of runs of ten rows. The byte code of Python and the files of the
packages are cached by the operating system.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from tests.benchmarks.report import Goal, machine, print_goals, versions, write_json
from tests.benchmarks.trivial import trivial_fmu

MODULES = (
    *("numpy", "numba", "fmpy", "pyarrow.parquet", "casadi"),
    *(
        "orchestration",
        "orchestration.system.system",
        "orchestration.master.simulate",
        "orchestration.master.kernel.step_control",
    ),
    *("orchestration.cli", "adaptimp_fmu", "fmus.catalog"),
)
ALGORITHMS = ("gauss-seidel", "iterative", "newton", "adaptive")
REPETITIONS, ROWS, FEW_ROWS = 5, 1_000_000, 10
COLD_REPETITIONS = 2  # compilation takes long
COLUMNS_PER_FMU = 10  # of the four FMUs of the runs that measure memory
CACHED_LIMIT = 0.7  # s, of gauss-seidel
PLAIN_LIMIT, GENERAL_LIMIT = 1.5, 6.0  # s of processor time, cold: the plain loop, the loop of all algorithms
MEMORY_FACTOR, MEMORY_EXTRA = 1.1, 50e6  # of the data, and bytes
MB = 1e6


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Imports, compilation and memory.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS)
    parser.add_argument("--rows", type=int, default=ROWS, help="rows of the runs that measure memory")
    parser.add_argument("--algorithms", nargs="+", choices=ALGORITHMS, default=ALGORITHMS)
    given = parser.parse_args(arguments)
    result, console = run(given.repetitions, given.rows, given.algorithms), Console()
    _print(result, console)
    write_json(given.json, result)
    return 0


def run(
    repetitions: int = REPETITIONS,
    n_rows: int = ROWS,
    algorithms: Sequence[str] = ALGORITHMS,
    modules: Sequence[str] = MODULES,
) -> dict[str, Any]:
    """Measure everything.

    Returns
    -------
    dict
        ``imports``: minimum and median, s, by module; ``first_call``: by algorithm, ``cold`` and
        ``cached``, minimum and median of the first and the second run, s; ``memory``: bytes;
        ``goals``, ``machine`` and ``versions``.
    """
    imports = {m: _spread([child("import", m)["seconds"] for _ in range(repetitions)]) for m in modules}
    first_call = {a: _first_call(a, repetitions) for a in algorithms}
    memory = measure_memory(n_rows)
    return {
        "imports": imports,
        "first_call": first_call,
        "memory": memory,
        "goals": _goals(first_call, memory),
        "machine": machine(),
        "versions": versions(),
    }


def measure_memory(n_rows: int) -> dict[str, Any]:
    """Peak memory above that of a process that records ten rows, in memory and to Parquet."""
    fmu, found = str(trivial_fmu(COLUMNS_PER_FMU)), {}
    with TemporaryDirectory() as folder:
        for name, file in (("in_memory", ()), ("streamed", (f"{folder}/rows.parquet",))):
            few, many = (child("memory", fmu, str(n), *file) for n in (FEW_ROWS, n_rows))
            found[name] = {
                "rows": n_rows,
                "data": 8 * n_rows * (4 * COLUMNS_PER_FMU + 1),  # with the times
                "above": many["peak"] - few["peak"],
                "few": few["peak"],
                "seconds": many["seconds"],
            }
    return found


def child(*arguments: str, cache: str | None = None) -> dict[str, float]:
    """What a fresh process measures, see `tests.benchmarks.child`.

    Parameters
    ----------
    cache
        ADAPTIMP_CACHE, which holds machine code too; this process's if None.
    """
    environment = dict(os.environ) if cache is None else {**os.environ, "ADAPTIMP_CACHE": cache}
    command = [sys.executable, "-m", "tests.benchmarks.child", *arguments]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        msg = f"The measuring process {arguments} ended with {run.returncode}:\n{run.stderr.strip()}"
        raise RuntimeError(msg)
    return json.loads(run.stdout)


def _first_call(algorithm: str, repetitions: int) -> dict[str, Any]:
    fmu = str(trivial_fmu(1))
    cold, cached = [], []
    for _ in range(min(repetitions, COLD_REPETITIONS)):
        with TemporaryDirectory() as cache:
            cold.append(child("simulate", fmu, algorithm, cache=cache))
            for _ in range(-(-repetitions // COLD_REPETITIONS)):
                cached.append(child("simulate", fmu, algorithm, cache=cache))
    runs = {"cold": cold, "cached": cached}
    return {
        name: {key: _spread([run[key] for run in found]) for key in ("imports", "first", "processor", "second")}
        for name, found in runs.items()
    }


def _spread(values: Sequence[float]) -> dict[str, float]:
    return {"minimum": float(np.min(values)), "median": float(np.median(values))}


def _goals(first_call: dict[str, Any], memory: dict[str, Any]) -> list[dict[str, Any]]:
    goals = []
    if "gauss-seidel" in first_call:
        times = first_call["gauss-seidel"]
        goals.append(Goal("gauss-seidel, cached, s", times["cached"]["first"]["minimum"], CACHED_LIMIT))
    for name, times in first_call.items():
        cold = times["cold"]["processor"]["minimum"]
        goals.append(Goal(f"{name}, cold, s", cold, PLAIN_LIMIT if name == "gauss-seidel" else GENERAL_LIMIT))
    rows = memory["in_memory"]
    limit = MEMORY_FACTOR * rows["data"] + MEMORY_EXTRA
    goals.append(Goal(f"{rows['rows']} rows in memory, MB", rows["above"] / MB, limit / MB))
    return [goal.record() for goal in goals]


def _print(result: dict[str, Any], console: Console) -> None:
    table = Table("import", "minimum, s", "median, s")
    for name, spread in result["imports"].items():
        table.add_row(name, *(f"{s:.3f}" for s in spread.values()))
    console.print(table)
    first = ("first, minimum", "first, median", "processor, median")
    table = Table("simulate, s", "machine code", *first, "second, minimum")
    for name, found in result["first_call"].items():
        for state, times in found.items():
            shown = (*times["first"].values(), times["processor"]["median"], times["second"]["minimum"])
            table.add_row(name, state, *(f"{s:.3f}" for s in shown))
    console.print(table)
    table = Table("memory, MB", "data", "peak above few rows", "peak of few rows", "run, s")
    for name, found in result["memory"].items():
        shown = (found["data"] / MB, found["above"] / MB, found["few"] / MB)
        table.add_row(name, *(f"{value:.1f}" for value in shown), f"{found['seconds']:.2f}")
    console.print(table)
    print_goals(result, console)


if __name__ == "__main__":
    raise SystemExit(main())
