"""Time per communication step of the five-FMU system of Fig. 2, in six programs.

    python -m tests.benchmarks.master [--json FILE] [--repetitions N] [--steps N]

`bare` calls the generated C functions without FMI; `c` is a C loop of the same FMI calls as `ours`,
the compiled loop; `fmpy` is a Python loop; ecos and libcosim are independent engines (both Jacobi).
All but `bare` keep all 40 outputs of every step (ecos only the last values). Repetitions alternate;
each begins in the same initialized state, restored outside the measured time. Nothing asserts a
time: what is asserted is that `c` records what `ours` records, bit by bit, and that `bare` computes
the same until the tip touches the wall.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from rich.console import Console

from orchestration.paper.provide import fmus, scenario
from orchestration.system import System
from tests.benchmarks.report import machine, print_tables, ratios, statistics, undisturbed, versions
from tests.benchmarks.variants import Bench, BenchmarkError, Measure, bench
from tests.interop.peers import time_ecospy, time_libcosim, unavailable

FAST, SLOW = ("bare", "c", "ours"), ("fmpy", "ecospy", "libcosimpy")
STEPS, SLOW_STEPS, REPETITIONS = 20_000, 2_000, 15
CHECKED_STEPS = 1000  # long before the tip touches the wall, at about 1 s
_CALLS = {"loop": (0, 0, 0), "set": (1, 0, 0), "set_step": (1, 1, 0), "get": (0, 0, 1)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time per step of the system of Fig. 2.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, help="at least 9 for a record")
    parser.add_argument("--steps", type=int, default=STEPS, help="steps per repetition of bare, c, ours")
    given = parser.parse_args(arguments)
    result = run(given.steps, given.repetitions)
    print_tables(result, Console())
    if given.json is not None:
        given.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return 0


def run(n_steps: int = STEPS, repetitions: int = REPETITIONS) -> dict[str, Any]:
    """Check and measure everything.

    Parameters
    ----------
    n_steps
        Steps per repetition of the fast variants; the slow ones make a tenth, at most `SLOW_STEPS`.
    repetitions
        Rounds; in each one every variant runs once.

    Returns
    -------
    dict
        Per variant ns per step (see `statistics`), ``ratios``, ``per_fmu`` (ns per step of each
        component's calls, measured alone), ``checks``, ``machine`` and ``versions``.

    Raises
    ------
    BenchmarkError
        If a loop does not compute what it should.
    """
    about = scenario("fig2")
    system = about.system(fmus(about.units.values()))
    with bench(system, n_steps) as b, TemporaryDirectory() as folder:
        checks = _check(b, n_steps)
        missing = {name: why for name in SLOW[1:] if (why := unavailable(name))}
        steps = dict.fromkeys(FAST, n_steps) | dict.fromkeys(SLOW, min(SLOW_STEPS, max(1, n_steps // 10)))
        measures = {k: v for k, v in _measures(b, system, Path(folder)).items() if k not in missing}
        rounds: dict[str, list[np.ndarray]] = {name: [] for name in measures}
        for _ in range(repetitions):
            for name, measure in measures.items():
                rounds[name].append(measure(steps[name]))
        seconds = {name: np.array(pieces) for name, pieces in rounds.items()}
        per_fmu = _per_fmu(b, n_steps, repetitions)
    return {
        **{name: statistics(values, steps[name]) for name, values in seconds.items()},
        **{name: {"unavailable": why} for name, why in missing.items()},
        "ratios": ratios(seconds, steps),
        "per_fmu": per_fmu,
        "checks": checks,
        "machine": machine(),
        "versions": versions(),
    }


def _measures(b: Bench, system: System, folder: Path) -> Mapping[str, Measure]:
    """Wall time of n steps, by variant; each is called once per round, in this order."""
    ssp = system.write(folder / "fig2.ssp")
    step_ns = round(system.step * 1e9)
    return {
        "bare": b.time_bare,
        "c": b.time_c,
        "ours": b.time_ours,
        "fmpy": b.time_fmpy,
        "ecospy": lambda n: np.array([time_ecospy(ssp, system.step, n)]),
        "libcosimpy": lambda n: np.array([time_libcosim(ssp, step_ns, n)]),
    }


def _check(b: Bench, n_steps: int) -> dict[str, Any]:
    """Compare what the loops compute; also compiles and warms them up.

    Raises
    ------
    BenchmarkError
        If they differ.
    """
    ours = b.records(b.time_ours, n_steps)
    checked = min(CHECKED_STEPS, n_steps)
    for name, measure, n in (("c", b.time_c, n_steps), ("fmpy", b.time_fmpy, checked)):
        records = b.records(measure, n)
        if records.tobytes() != ours[: n + 1].tobytes():
            row = int(np.argwhere(records != ours[: n + 1])[0][0])
            msg = f"The records of {name} differ from ours, first in row {row}."
            raise BenchmarkError(msg)
    equal = b.check_bare(ours[: checked + 1])
    if equal < checked:
        msg = f"The bare functions differ from the real run after {equal} steps."
        raise BenchmarkError(msg)
    return {"c_equals_ours_bitwise": True, "steps_compared": n_steps, "bare_equals_ours_steps": equal}


def _per_fmu(b: Bench, n_steps: int, repetitions: int) -> dict[str, dict[str, float]]:
    """Time in ns per step of each component alone, with the inputs it has in the run.

    The fastest of every piece in alternating repetitions. ``do_step`` is what setting and stepping
    take more than setting; the copying of recorded inputs is subtracted everywhere.
    """
    inputs = b.inputs(b.records(b.time_ours, n_steps))
    times: dict[str, dict[str, list[np.ndarray]]] = {
        c.name: {key: [] for key in ("bare", "bare_loop", *_CALLS)} for c in b.system.components
    }
    for _ in range(repetitions):
        for i, (name, found) in enumerate(times.items()):
            found["bare_loop"].append(b.time_unit(name, inputs[name], step=False))
            found["bare"].append(b.time_unit(name, inputs[name], step=True))
            for key, calls in _CALLS.items():
                found[key].append(b.time_component(i, inputs[name], calls))
    least = {
        name: {key: undisturbed(np.array(pieces), n_steps) for key, pieces in found.items()}
        for name, found in times.items()
    }
    return {
        name: {
            "bare": ns["bare"] - ns["bare_loop"],
            "set": ns["set"] - ns["loop"],
            "do_step": ns["set_step"] - ns["set"],
            "get": ns["get"] - ns["loop"],
        }
        for name, ns in least.items()
    }


if __name__ == "__main__":
    raise SystemExit(main())
