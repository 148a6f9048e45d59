"""Measures the time per communication step of a system of the paper in six programs, and its parts.

    python -m tests.benchmarks.master [--scenario fig2|fig5] [--json FILE] [--repetitions N] [--steps N]

`bare` calls the generated C functions without FMI; `c` is a C loop of the same FMI calls as `ours`,
the compiled loop; `fmpy` is a Python loop; ecos and libcosim are independent engines (both Jacobi).
All but `bare` keep all outputs of every step (ecos only the last values); ``-silent`` ones make the
same calls and keep nothing. Repetitions alternate; each begins in the same initialized state,
restored outside the measured time. Nothing asserts a time: what is asserted is that `c` records what
`ours` records, bit by bit, and that `bare` computes the same until the tip touches the wall.
"""

import argparse
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rich.console import Console

from orchestration.paper.built_fmus import find_scenario, fmus
from orchestration.system.system import System
from tests.benchmarks.report import (
    Goal,
    Measure,
    alternate,
    machine,
    print_goals,
    print_parts,
    print_variants,
    ratios,
    statistics,
    undisturbed,
    versions,
    write_json,
)
from tests.benchmarks.rig import NEVER, BenchmarkError
from tests.benchmarks.variants import Bench
from tests.interop.peers import time_ecospy, time_libcosim, unavailable

MEANING = {
    "bare": "no FMI, no records",
    "c": "C loop",
    "c-silent": "C loop, no records",
    "ours": "loop.run",
    "ours-silent": "loop.run, no records",
    "fmpy": "Python loop",
    "ecospy": "ecos, Jacobi",
    "libcosimpy": "libcosim, Jacobi",
}
FAST, SLOW = ("bare", "c", "c-silent", "ours", "ours-silent"), ("fmpy", "ecospy", "libcosimpy")
RATIOS = (
    *(("c", "bare"), ("ours", "bare"), ("ours", "c"), ("ours-silent", "c-silent"), ("ours-silent", "bare")),
    *(("fmpy", "ours"), ("ecospy", "ours"), ("libcosimpy", "ours")),
)
LIMITS = {"ours/c": 1.1, "ours/bare": 1.25}
SCENARIOS = ("fig2", "fig5")
SLOW_STEPS, REPETITIONS = 2_000, 15
CHECKED_STEPS = 1000  # of the Python loop
_CALLS = {"loop": (0, 0, 0), "set": (1, 0, 0), "set_step": (1, 1, 0), "get": (0, 0, 1)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time per step of a system of the paper.")
    parser.add_argument("--scenario", choices=SCENARIOS, default=SCENARIOS[0])
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, help="at least 9 for a record")
    parser.add_argument("--steps", type=int, help="steps per repetition of bare, c, ours; the whole run if not given")
    given = parser.parse_args(arguments)
    result, console = run(given.scenario, given.steps, given.repetitions), Console()
    print_variants(result, MEANING, console)
    print_parts(result, console)
    print_goals(result, console)
    write_json(given.json, result)
    return 0


def run(name: str = "fig2", n_steps: int | None = None, repetitions: int = REPETITIONS) -> dict[str, Any]:
    """Check and measure everything.

    Parameters
    ----------
    name
        One of `SCENARIOS`.
    n_steps
        Steps per repetition of the fast variants, all of the scenario if None; the slow ones make a
        tenth, at most `SLOW_STEPS`.
    repetitions
        Rounds; in each one every variant runs once.

    Returns
    -------
    dict
        Per variant ns per step (see `statistics`), ``ratios``, ``per_fmu`` (ns per step of each
        component's calls, measured alone), ``parts`` (their sums beside the wholes), ``goals``,
        ``checks``, ``machine`` and ``versions``.

    Raises
    ------
    BenchmarkError
        If a loop does not compute what it should.
    """
    about = find_scenario(name)
    system = about.system(fmus(about.models.values()))
    n_steps = n_steps or round(system.run_stop_time() / system.run_step())
    with Bench(system, n_steps) as b, TemporaryDirectory() as folder:
        checks = check(b, n_steps)
        missing = {engine: why for engine in SLOW[1:] if (why := unavailable(engine))}
        steps = dict.fromkeys(FAST, n_steps) | dict.fromkeys(SLOW, min(SLOW_STEPS, max(1, n_steps // 10)))
        measures = {k: v for k, v in _measures(b, system, Path(folder)).items() if k not in missing}
        seconds = alternate(measures, steps, repetitions)
        per_fmu = _per_fmu(b, n_steps, repetitions)
        copies = _copies(b, n_steps, repetitions)
    quiet = {variant: undisturbed(seconds[variant], n_steps) for variant in FAST}
    found = ratios(RATIOS, seconds, steps)
    return {
        "scenario": name,
        **{variant: statistics(values, steps[variant]) for variant, values in seconds.items()},
        **{variant: {"unavailable": why} for variant, why in missing.items()},
        "ratios": found,
        "per_fmu": per_fmu,
        "parts": _parts(per_fmu, copies, quiet),
        "goals": [Goal(pair, found[pair]["undisturbed"], limit).record() for pair, limit in LIMITS.items()],
        "checks": checks,
        "machine": machine(),
        "versions": versions(),
    }


def _measures(b: Bench, system: System, folder: Path) -> Mapping[str, Measure]:
    """Wall time of n steps, by variant; each is called once per round, in this order."""
    ssp = system.write(folder / f"{system.name}.ssp")
    step_ns = round(system.run_step() * 1e9)
    return {
        "bare": b.time_bare,
        "c": b.time_c,
        "ours": b.time_ours,
        "c-silent": partial(b.time_c, every=NEVER),
        "ours-silent": partial(b.time_ours, every=NEVER),
        "fmpy": b.time_fmpy,
        "ecospy": lambda n: np.array([time_ecospy(ssp, system.run_step(), n)]),
        "libcosimpy": lambda n: np.array([time_libcosim(ssp, step_ns, n)]),
    }


def check(b: Bench, n_steps: int) -> dict[str, Any]:
    """Compare what the loops compute; also compiles and warms them up.

    Raises
    ------
    BenchmarkError
        If they differ.
    """
    ours = b.records(b.time_ours, n_steps)
    b.check(ours, "c", b.time_c, n_steps)
    b.check(ours, "fmpy", b.time_fmpy, min(CHECKED_STEPS, n_steps))
    touched = b.first_contact(ours)
    equal = b.check_bare(ours[:touched])
    if equal < touched - 1:
        msg = f"The bare functions differ from the real run after {equal} steps; the tip touches at step {touched}."
        raise BenchmarkError(msg)
    return {"c_equals_ours_bitwise": True, "steps_compared": n_steps, "bare_equals_ours_steps": equal}


def _per_fmu(b: Bench, n_steps: int, repetitions: int) -> dict[str, dict[str, float]]:
    """Time in ns per step of each component alone, with the inputs it has in the run.

    The fastest of every piece in alternating repetitions. ``do_step`` is what setting and stepping
    take more than setting; the copying of recorded inputs is subtracted everywhere.
    """
    inputs = b.inputs(b.records(b.time_ours, n_steps))
    measures: dict[str, Measure] = {}
    for i, (name, given) in enumerate(inputs.items()):
        measures[f"{name} bare_loop"] = lambda _, name=name, given=given: b.time_unit(name, given, step=False)
        measures[f"{name} bare"] = lambda _, name=name, given=given: b.time_unit(name, given, step=True)
        for key, calls in _CALLS.items():
            measures[f"{name} {key}"] = lambda _, i=i, given=given, calls=calls: b.time_component(i, given, calls)
    seconds = alternate(measures, dict.fromkeys(measures, n_steps), repetitions)
    ns = {key: undisturbed(pieces, n_steps) for key, pieces in seconds.items()}
    return {
        name: {
            "bare": ns[f"{name} bare"] - ns[f"{name} bare_loop"],
            "set": ns[f"{name} set"] - ns[f"{name} loop"],
            "do_step": ns[f"{name} set_step"] - ns[f"{name} set"],
            "get": ns[f"{name} get"] - ns[f"{name} loop"],
        }
        for name in inputs
    }


def _copies(b: Bench, n_steps: int, repetitions: int) -> dict[str, float]:
    """Time in ns per step of the copies that a step makes besides its calls, each measured alone."""
    measures: dict[str, Measure] = {
        "loop": b.time_copies,
        "links": partial(b.time_copies, links=True),
        "records": partial(b.time_copies, records=True),
        "bare": b.time_bare_copies,
    }
    seconds = alternate(measures, dict.fromkeys(measures, n_steps), repetitions)
    ns = {key: undisturbed(pieces, n_steps) for key, pieces in seconds.items()}
    return {**{key: ns[key] - ns["loop"] for key in ("links", "records", "bare")}, "loop": ns["loop"]}


def _parts(
    per_fmu: Mapping[str, Mapping[str, float]], copies: Mapping[str, float], quiet: Mapping[str, float]
) -> dict[str, dict[str, float | None]]:
    """Parts in ns per step, their sum, and the whole; what is left is the loop, and what a part costs more in it.

    ``recording`` of `ours` is what the run takes less if it keeps nothing.
    """
    calls = {key: sum(times[key] for times in per_fmu.values()) for key in ("bare", "set", "do_step", "get")}
    fmi = {key: calls[key] for key in ("set", "do_step", "get")}
    columns = {
        "bare": {"do_step": calls["bare"], "link copies": copies["bare"]},
        "c": {**fmi, "link copies": copies["links"], "recording": copies["records"]},
        "ours": {**fmi, "link copies": copies["links"], "recording": quiet["ours"] - quiet["ours-silent"]},
    }
    rows = ("set", "do_step", "get", "link copies", "recording")
    return {
        name: {
            **{row: parts.get(row) for row in rows},
            "sum": sum(parts.values()),
            "whole": quiet[name],
            "left": quiet[name] - sum(parts.values()),
        }
        for name, parts in columns.items()
    }


if __name__ == "__main__":
    raise SystemExit(main())
