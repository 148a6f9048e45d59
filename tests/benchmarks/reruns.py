"""Measures what a run costs whose FMUs stay open, beside a run of its own, and what a run costs whose FMU crashes.

    python -m tests.benchmarks.reruns [--json FILE] [--repetitions N]

Fig. 7 with the algorithm iterative: short runs, which show what is spent beside the steps, and whole ones; then short
runs with the controller in a process of its own. Then runs of a small FMU in a process of its own that crashes in
each run. Runs of both kinds alternate, so that other work on the machine disturbs both alike.

What is asserted is that both kinds record the same bits.
"""

import argparse
import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from rich.console import Console
from rich.table import Table

from orchestration.errors import SimulationError
from orchestration.master.options import Options
from orchestration.master.reruns import Reruns
from orchestration.master.simulate import simulate
from orchestration.paper.built_fmus import find_scenario, fmus
from orchestration.results.result import Result
from orchestration.system.system import System
from tests.benchmarks.report import machine, versions
from tests.pooled.fmus import Deed, compiled, system_of

REPETITIONS, WARM = 10, 3
RECORD = ("plant.F_ext", "controller.e")
CHOICES: Mapping[str, tuple[float, Any]] = {
    "0.01 s": (0.01, None),
    "2 s": (2.0, None),
    "0.01 s, controller isolated": (0.01, ["controller"]),
}
"""Stop time, s, and isolated components."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time per run with FMUs that stay open.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS)
    given = parser.parse_args(arguments)
    result = run(given.repetitions)
    _print(result)
    if given.json is not None:
        given.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return 0


def run(repetitions: int = REPETITIONS) -> dict[str, Any]:
    """Measure each choice; times in seconds per run, ratios within pairs of runs.

    Raises
    ------
    AssertionError
        If two runs of a pair do not end in the same way.
    """
    about = find_scenario("fig7")
    system = about.system(fmus(about.models.values()))
    stiffness = [{"plant.K_f": 1e4 + 1e3 * k} for k in range(repetitions + WARM)]
    found = {
        name: _pairs(system, stiffness, (system.run_step(), stop_time), "iterative", isolate=isolate)
        for name, (stop_time, isolate) in CHOICES.items()
    }
    with tempfile.TemporaryDirectory() as folder:
        compiled(Path(folder) / "library")
        small = system_of(Path(folder), Path(folder) / "library", Path(folder) / "library")
        crashes = [{"m.deed": float(Deed.CRASH), "m.p": float(k)} for k in range(repetitions + WARM)]
        found["crash"] = _pairs(small, crashes, (0.125, 1.0), "gauss-seidel", isolate=["m"])
    return {"machine": machine(), "versions": versions(), "runs": found}


def _pairs(
    system: System, points: Sequence[Mapping[str, float]], times: tuple[float, float], algorithm: str, *, isolate: Any
) -> dict[str, float]:
    """Medians of the times of both kinds of runs, and of their ratio; the first runs are not measured.

    `times` are the step and the stop time, s.
    """
    step, stop_time = times
    record = RECORD if "plant" in system else None
    again, alone = list[float](), list[float]()
    with Reruns(system, stop_time, algorithm, Options(record=record, isolate=isolate)) as runs:
        for point in points:
            seconds, mine = _timed(lambda point=point: runs.run(point, step))
            again.append(seconds)
            seconds, other = _timed(
                lambda point=point: simulate(
                    system.set(point), stop_time, step, algorithm, record=record, isolate=isolate
                )
            )
            alone.append(seconds)
            if mine != other:
                msg = f"Two runs of {system.name} with {dict(point)} do not record the same bits."
                raise AssertionError(msg)
    kept = list(zip(again[WARM:], alone[WARM:], strict=True))
    return {
        "kept_open": median(a for a, _ in kept),
        "of_its_own": median(b for _, b in kept),
        "ratio": median(b / a for a, b in kept),
    }


def _timed(make: Callable[[], Result]) -> tuple[float, bytes | str]:
    """Seconds of a run, and its rows or the sentence with which it fails."""
    began = perf_counter()
    try:
        result = make()
    except SimulationError as error:
        return perf_counter() - began, str(error)
    return perf_counter() - began, result.rows.tobytes()


def _print(result: Mapping[str, Any]) -> None:
    table = Table("runs", "FMUs stay open, ms", "run of its own, ms", "ratio")
    for name, found in result["runs"].items():
        times = (f"{1e3 * found[key]:.1f}" for key in ("kept_open", "of_its_own"))
        table.add_row(name, *times, f"{found['ratio']:.1f}")
    Console().print(table)


if __name__ == "__main__":
    raise SystemExit(main())
