"""Measures the time per inner step of a whole system as one program, beside its bare functions and our loop.

    python -m tests.benchmarks.containers [--scenario fig2|fig5] [--json FILE] [--repetitions N] [--steps N]

`c` is the system's C form, which makes all steps of a piece in one call; `bare` calls the generated functions
without checks; both record nothing. `ours` is the compiled loop over the five FMUs, `fmu` the same loop over one FMU
that is the whole system; it makes one inner step per call. `fmu-1000` makes 1000 of them per call, and records every
1000th step. All others record all outputs of every step. Repetitions alternate; each begins in the same initialized
state, made outside the measured time. Nothing asserts a time: what is asserted is that all forms record what `ours`
records, bit by bit.
"""

import argparse
import shutil
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from adaptimp_fmu import PLATFORMS
from orchestration.containers.wasm.module import write_wasm
from orchestration.paper.built_fmus import find_scenario, fmus
from orchestration.system.system import System
from tests.benchmarks.container import contained
from tests.benchmarks.forms import CProgram, time_module, whole_system
from tests.benchmarks.report import (
    Goal,
    Measure,
    alternate,
    machine,
    print_goals,
    print_variants,
    ratios,
    statistics,
    versions,
    write_json,
)
from tests.benchmarks.rig import Rig
from tests.benchmarks.sizes import BINARY_LIMIT, MODULE_LIMIT, sizes
from tests.benchmarks.variants import Bench
from tests.untested import needs

MEANING = {
    "bare": "generated functions, no records",
    "c": "C form, no records",
    "c-rows": "C form, step by step",
    "fmu": "one FMU in loop.run",
    "fmu-1000": "one FMU in loop.run, long steps",
    "ours": "five FMUs in loop.run",
    "fmucontainer": "its FMU in loop.run, plant first",
    "wasm": "WebAssembly in node, no records",
}
RATIOS = (
    *(("c", "bare"), ("fmu-1000", "bare"), ("fmu-1000", "ours"), ("c-rows", "ours"), ("fmu", "ours")),
    *(("wasm", "c"), ("fmucontainer", "ours"), ("fmucontainer", "fmu")),
)
LIMITS = {"c/bare": 1.05, "fmu-1000/bare": 1.05, "fmu-1000/ours": 0.8, "wasm/c": 1.6}
NO_NODE = needs("node is not installed", "nodejs")
LONG = 1000  # inner steps of a long step
SCENARIOS = ("fig2", "fig5")
REPETITIONS = 15


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time per inner step of a system of the paper as one program.")
    parser.add_argument("--scenario", choices=SCENARIOS, default="fig5")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, help="at least 9 for a record")
    parser.add_argument("--steps", type=int, help="steps per repetition; the whole run if not given")
    parser.add_argument("--platform", nargs="+", choices=PLATFORMS, default=list(PLATFORMS), help="binaries to measure")
    given = parser.parse_args(arguments)
    result, console = run(given.scenario, given.steps, given.repetitions, given.platform), Console()
    print_variants(result, MEANING, console)
    _print_sizes(result["bytes"], console)
    print_goals(result, console)
    write_json(given.json, result)
    return 0


def run(
    name: str = "fig5",
    n_steps: int | None = None,
    repetitions: int = REPETITIONS,
    platforms: Iterable[str] = tuple(PLATFORMS),
) -> dict[str, Any]:
    """Check and measure everything.

    Parameters
    ----------
    name
        One of `SCENARIOS`.
    n_steps
        Inner steps per repetition, a multiple of `LONG`; all of the scenario if None.
    repetitions
        Rounds; in each one every variant runs once.
    platforms
        Platforms whose binaries are measured.

    Returns
    -------
    dict
        Per variant ns per step (see `statistics`), ``ratios``, ``bytes`` (see `sizes`), ``goals``, ``machine`` and
        ``versions``. The goals of times hold for medians of ratios within rounds.

    Raises
    ------
    BenchmarkError
        If a form does not compute what `ours` computes.
    """
    about = find_scenario(name)
    system = about.system(fmus(about.models.values()))
    n_steps = n_steps or round(system.run_stop_time() / system.run_step())
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        measures = _measures(system, n_steps, folder, stack)
        steps = dict.fromkeys(measures, n_steps)
        seconds = alternate(measures, steps, repetitions)
        measured = sizes(system, folder, platforms)
    found = ratios(RATIOS, seconds, steps)
    return {
        "scenario": name,
        **{variant: statistics(values, n_steps) for variant, values in seconds.items()},
        **({} if "wasm" in seconds else {"wasm": {"unavailable": NO_NODE}}),
        "ratios": found,
        "bytes": measured,
        "goals": [goal.record() for goal in _goals(found, measured)],
        "machine": machine(),
        "versions": versions(),
    }


def _measures(system: System, n: int, folder: Path, stack: ExitStack) -> dict[str, Measure]:
    """Wall time of n inner steps, by variant; what they need is on the stack, and computes the same in all."""
    whole = whole_system(system, folder)
    bench = stack.enter_context(Bench(system, n))
    one = stack.enter_context(Rig(whole, n))
    long = stack.enter_context(Rig(replace(whole, step=LONG * system.run_step()), n // LONG, piece=2))
    theirs = stack.enter_context(Rig(contained(_plant_first(system), folder), n))
    program = CProgram(system, folder / "c")
    rows = partial(program.time_rows, rig=bench)
    ours = bench.records(bench.time_ours, n)
    bench.check(ours, "c-rows", rows, n)
    one.check(ours, "fmu", one.time_ours, n)
    long.check(np.ascontiguousarray(ours[::LONG]), "fmu-1000", long.time_ours, n // LONG)
    module = {"wasm": partial(time_module, write_wasm(system, folder / "speed.wasm"))} if shutil.which("node") else {}
    return {
        "bare": bench.time_bare,
        "c": partial(program.time, rig=bench),
        "c-rows": rows,
        "fmu": one.time_ours,
        "fmu-1000": lambda n: long.time_ours(n // LONG),
        "ours": bench.time_ours,
        "fmucontainer": theirs.time_ours,
        **module,
    }


def _goals(found: Mapping[str, Mapping[str, float]], measured: Mapping[str, int]) -> list[Goal]:
    """Goals of the ratios and sizes that were measured."""
    goals = [Goal(pair, found[pair]["median_of_rounds"], limit) for pair, limit in LIMITS.items() if pair in found]
    limits = {"wasm": MODULE_LIMIT} | dict.fromkeys(PLATFORMS, BINARY_LIMIT)
    return goals + [Goal(f"{what}, bytes", size, limits[what]) for what, size in measured.items() if what in limits]


def _print_sizes(measured: Mapping[str, int], console: Console) -> None:
    """Print the sizes."""
    table = Table("what", "bytes")
    for what, size in measured.items():
        table.add_row(what, str(size))
    console.print(table)


def _plant_first(system: System) -> System:
    """The system with the plant before the others.

    fmu_manipulation_toolbox cuts the loop of links before its first FMU, which then gets zeros at initialization.
    The controller refuses these: the arm is stretched. The plant takes them. The cost of a step is the same.
    """
    *others, plant = system.components
    return replace(system, components=(plant, *others))


if __name__ == "__main__":
    raise SystemExit(main())
