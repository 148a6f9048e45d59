"""Measures how the cost of a step grows with components, variables per component, steps and records.

    python -m tests.benchmarks.scaling [--json FILE] [--repetitions N] [--work N]

Rings of `tests.benchmarks.trivial`. First `c`, a C loop of the same FMI calls, and `ours`, the compiled
loop, over FMUs and variables, with all outputs recorded and with none. Then `simulate`, a whole
`Simulation.run` in fresh memory with all its checks, over the number of steps of a ring of five. What
is asserted is that `c` records what `ours` records, bit by bit.
"""

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from orchestration.master.options import Options
from tests.benchmarks.overhead import time_simulation
from tests.benchmarks.report import alternate, machine, undisturbed, versions, write_json
from tests.benchmarks.rig import Rig
from tests.benchmarks.trivial import ring

SIZES, WIDTHS, STEPS = (2, 4, 8, 16, 32, 64), (1, 10, 100), (1_000, 10_000, 100_000, 1_000_000)
REPETITIONS = 9
WORK = 2_000_000  # values that a repetition moves: steps x FMUs x variables, within the next two
FEWEST_STEPS, MOST_STEPS = 500, 20_000
PIECE_VALUES = 200_000  # that are moved in the steps timed together
RING = (5, 2)  # FMUs and variables of the runs of many steps


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Cost of a step against size.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS)
    parser.add_argument("--work", type=int, default=WORK, help="values moved by a repetition")
    given = parser.parse_args(arguments)
    result = run(repetitions=given.repetitions, work=given.work)
    _print(result, Console())
    write_json(given.json, result)
    return 0


def run(
    sizes: Sequence[int] = SIZES,
    widths: Sequence[int] = WIDTHS,
    steps: Sequence[int] = STEPS,
    *,
    repetitions: int = REPETITIONS,
    work: int = WORK,
) -> dict[str, Any]:
    """Measure everything.

    Returns
    -------
    dict
        ``size``: a record per number of FMUs and variables: ns per step of `c` and `ours`, recorded
        and silent, their ratios, and ns per FMU and step; ``length``: a record per number of steps;
        ``machine`` and ``versions``.

    Raises
    ------
    BenchmarkError
        If a loop does not compute what it should.
    """
    return {
        "size": [measure_size(n, width, repetitions, work) for width in widths for n in sizes],
        "length": [measure_length(n, repetitions) for n in steps],
        "machine": machine(),
        "versions": versions(),
    }


def measure_size(n_fmus: int, width: int, repetitions: int, work: int) -> dict[str, float]:
    """Cost of a step of one ring, ns."""
    system, values = ring(n_fmus, width), n_fmus * width
    n = min(MOST_STEPS, max(FEWEST_STEPS, work // values))
    piece = max(100, PIECE_VALUES // values)
    with ExitStack() as stack:
        recorded = stack.enter_context(Rig(system, n, piece=piece))
        silent = stack.enter_context(Rig(system, n, record=(), piece=piece))
        recorded.check(recorded.records(recorded.time_ours, n), "c", recorded.time_c, n)
        measures = {
            "c": recorded.time_c,
            "ours": recorded.time_ours,
            "c_silent": silent.time_c,
            "ours_silent": silent.time_ours,
        }
        seconds = alternate(measures, dict.fromkeys(measures, n), repetitions)
    ns = {name: undisturbed(pieces, n) for name, pieces in seconds.items()}
    return {
        "fmus": n_fmus,
        "variables": width,
        "steps": n,
        **ns,
        "ours/c": ns["ours"] / ns["c"],
        "silent": ns["ours_silent"] / ns["c_silent"],
        "per_fmu": ns["ours"] / n_fmus,
        "median_ours/c": float(np.median(seconds["ours"].sum(axis=1) / seconds["c"].sum(axis=1))),
    }


def measure_length(n: int, repetitions: int) -> dict[str, float]:
    """Cost of a step of whole runs of n steps, and of the C loop into memory touched before, ns."""
    system, silent = ring(*RING), Options(record=())
    with Rig(system, n, piece=n) as rig:
        measures = {
            "c": rig.time_c,
            "simulate": lambda n: np.array([time_simulation(system, n)]),
            "simulate_silent": lambda n: np.array([time_simulation(system, n, silent)]),
        }
        seconds = alternate(measures, dict.fromkeys(measures, n), repetitions)
    ns = {name: undisturbed(pieces, n) for name, pieces in seconds.items()}
    return {"steps": n, **ns, "simulate/c": ns["simulate"] / ns["c"]}


def _print(result: dict[str, Any], console: Console) -> None:
    _table("ns per step, rings of FMUs", result["size"], console)
    _table(f"ns per step, ring of {RING[0]} FMUs with {RING[1]} variables", result["length"], console)


def _table(title: str, records: Sequence[dict[str, float]], console: Console) -> None:
    table = Table(*records[0], title=title)
    for record in records:
        shown = (f"{x:.2f}" if "/" in key or key == "silent" else f"{x:.0f}" for key, x in record.items())
        table.add_row(*shown)
    console.print(table)


if __name__ == "__main__":
    raise SystemExit(main())
