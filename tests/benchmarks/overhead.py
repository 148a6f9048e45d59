"""Measures the cost of the master: time per communication step of five FMUs that compute next to nothing.

    python -m tests.benchmarks.overhead [--json FILE] [--repetitions N] [--steps N]

A chain with 4 links and a ring with 30. `c` is a C loop of the same FMI calls as `ours`, the compiled
loop, with the same records; ``-silent`` keeps and fetches only what is connected, ``-tenth`` records
every tenth step; `simulate` is a whole `Simulation.run`, in fresh memory, with all its checks. `fmpy`
is a Python loop, ecos and libcosim are independent engines. `container` is the system as one FMU made
by fmu_manipulation_toolbox (sequential), stepped and recorded by the C loop.

What is asserted is that `c`, `fmpy` and `container` record what `ours` records, bit by bit.
"""

import argparse
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
from rich.console import Console

from orchestration.master.simulate import Options, UnconnectedInputWarning, prepare
from orchestration.system.system import System
from tests.benchmarks.container import contained
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
from tests.benchmarks.trivial import chain, ring
from tests.interop.peers import time_ecospy, time_libcosim, unavailable

MEANING = {
    "c": "C loop",
    "ours": "loop.run",
    "c-tenth": "C loop, every 10th step",
    "ours-tenth": "loop.run, every 10th step",
    "c-silent": "C loop, no records",
    "ours-silent": "loop.run, no records",
    "simulate": "Simulation.run",
    "container": "container FMU, C loop",
    "fmpy": "Python loop",
    "ecospy": "ecos, Jacobi",
    "libcosimpy": "libcosim, Jacobi",
}
ENGINES = {"ecospy": "ecospy", "libcosimpy": "libcosimpy"}
RATIOS = (
    *(("ours", "c"), ("ours-tenth", "c-tenth"), ("ours-silent", "c-silent"), ("simulate", "c")),
    *(("container", "ours"), ("fmpy", "ours"), ("ecospy", "ours"), ("libcosimpy", "ours")),
)
STEPS, SLOW_STEPS, REPETITIONS = 40_000, 2_000, 15
PIECE = 10_000  # steps: about a millisecond, in which a call from Python is lost
N_FMUS = 5


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time per step of five trivial FMUs.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, help="at least 9 for a record")
    parser.add_argument("--steps", type=int, default=STEPS, help="steps per repetition of the fast variants")
    given = parser.parse_args(arguments)
    result, console = run(given.steps, given.repetitions), Console()
    for name, found in result["systems"].items():
        console.rule(name)
        print_variants(found, MEANING, console)
    print_goals(result, console)
    write_json(given.json, result)
    return 0


def run(n_steps: int = STEPS, repetitions: int = REPETITIONS) -> dict[str, Any]:
    """Check and measure both systems.

    Returns
    -------
    dict
        ``systems``: by name, per variant ns per step (see `statistics`) and ``ratios``; ``goals``,
        ``machine`` and ``versions``.

    Raises
    ------
    BenchmarkError
        If a loop does not compute what it should.
    """
    found = {system.name: measure(system, n_steps, repetitions) for system in (chain(N_FMUS), ring(N_FMUS, 6))}
    goals = [goal for name, result in found.items() for goal in _goals(name, result)]
    return {"systems": found, "goals": goals, "machine": machine(), "versions": versions()}


def measure(system: System, n_steps: int, repetitions: int) -> dict[str, Any]:
    """Check and measure one system; see `run`."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        rig = stack.enter_context(Rig(system, n_steps, piece=PIECE))
        silent = stack.enter_context(Rig(system, n_steps, record=(), piece=PIECE))
        container = stack.enter_context(Rig(contained(system, folder), n_steps, piece=PIECE))
        ours = rig.records(rig.time_ours, n_steps)
        rig.check(ours, "c", rig.time_c, n_steps)
        rig.check(ours, "fmpy", rig.time_fmpy, min(n_steps, SLOW_STEPS))
        container.check(ours, "container", container.time_c, n_steps)
        missing = {name: why for name in ENGINES if (why := unavailable(name))}
        slow = min(SLOW_STEPS, n_steps)
        steps = {name: slow if name in ("fmpy", *ENGINES) else n_steps for name in MEANING}
        fast: dict[str, Measure] = {
            "c": rig.time_c,
            "ours": rig.time_ours,
            "c-tenth": partial(rig.time_c, every=10),
            "ours-tenth": partial(rig.time_ours, every=10),
            "c-silent": silent.time_c,
            "ours-silent": silent.time_ours,
            "simulate": lambda n: np.array([time_simulation(system, n)]),
            "container": container.time_c,
            "fmpy": rig.time_fmpy,
        }
        measures = {**fast, **_engines(system, folder)}
        seconds = alternate({k: v for k, v in measures.items() if k not in missing}, steps, repetitions)
    return {
        **{name: statistics(values, steps[name]) for name, values in seconds.items()},
        **{name: {"unavailable": why} for name, why in missing.items()},
        "ratios": ratios(RATIOS, seconds, steps),
    }


def time_simulation(system: System, n: int, options: Options | None = None) -> float:
    """Wall time of `Simulation.run` over n steps, s; all outputs are recorded unless `options` say otherwise."""
    with catch_warnings():
        simplefilter("ignore", UnconnectedInputWarning)
        prepared = prepare(system, n * system.run_step(), options=options)
    with prepared as simulation:
        begin = perf_counter()
        simulation.run()
        return perf_counter() - begin


def _engines(system: System, folder: Path) -> Mapping[str, Measure]:
    ssp = system.write(folder / f"{system.name}.ssp")
    step_ns = round(system.run_step() * 1e9)
    return {
        "ecospy": lambda n: np.array([time_ecospy(ssp, system.run_step(), n)]),
        "libcosimpy": lambda n: np.array([time_libcosim(ssp, step_ns, n)]),
    }


def _goals(name: str, result: Mapping[str, Any]) -> list[dict[str, Any]]:
    quiet = {pair: ratio["undisturbed"] for pair, ratio in result["ratios"].items()}
    goals = [
        Goal(f"{name}: ours, ns per step", result["ours"]["undisturbed_ns"], 500.0),
        *(Goal(f"{name}: {pair}", quiet[pair], 1.1) for pair in ("ours/c", "ours-silent/c-silent")),
        *(Goal(f"{name}: {pair}", quiet[pair], 5.0, at_least=True) for pair in ("ecospy/ours",) if pair in quiet),
        Goal(f"{name}: fmpy/ours", quiet["fmpy/ours"], 50.0, at_least=True),
    ]
    return [goal.record() for goal in goals]


if __name__ == "__main__":
    raise SystemExit(main())
