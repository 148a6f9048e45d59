"""Measures campaigns: `Study.run` beside the bare functions, and beside a sweep over fmpy with joblib.

    python -m tests.benchmarks.campaign [--runs N] [--repetitions N] [--fmpy-runs N] [--memory-runs N] [--json FILE]

The system is Fig. 7's loop, 2 s at 10 kHz, with three measures and no rows kept. `bare` calls the generated functions
of the FMUs without checks, measures and FMI; `engine` makes chunks of runs on one core, as a worker of a study does.
Both are measured in processor time, which other jobs disturb less, and all else is wall time. Repetitions alternate,
and ratios are medians over rounds. The memory is the peak of a fresh process that makes many short runs, when a tenth
of them is made, and at the end. Nothing asserts a time: what is asserted is that the sweep over fmpy measures the same,
bit by bit.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter, process_time, thread_time
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from orchestration.campaigns.engines.choice import engine_for
from orchestration.campaigns.study import Study
from orchestration.paper.built_fmus import find_scenario, fmus
from orchestration.system.system import System
from tests.benchmarks.by_fmpy import Sweep, time_sweep
from tests.benchmarks.report import Goal, alternate, machine, print_goals, ratios, statistics, versions, write_json
from tests.benchmarks.rig import BenchmarkError
from tests.benchmarks.start import child
from tests.benchmarks.variants import Bench

SAMPLE_TIME, STOP_TIME = 1e-4, 2.0  # s
MEASURES = ("peak_force", "max_e", "rms_e_contact")
VARIED = "plant.K_f"
WALLS = (1e4, 1e6)  # N/m
RUNS, REPETITIONS, FMPY_RUNS, MEMORY_RUNS = 10_000, 9, 8, 100_000
CHUNK = 25  # runs that `engine` makes in a call: a fifth of a second
SECONDS_LIMIT, RATE_LIMIT, WORKERS_LIMIT, FMPY_LIMIT, MEMORY_LIMIT = 60.0, 0.95, 1.85, 60.0, 1.05


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Runs per second of campaigns, and their memory.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--runs", type=int, default=RUNS, help="runs of the large study")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, help="at least 9 for a record")
    parser.add_argument("--fmpy-runs", type=int, default=FMPY_RUNS, help="runs of the sweep over fmpy")
    parser.add_argument("--memory-runs", type=int, default=MEMORY_RUNS, help="short runs of the fresh process")
    parser.add_argument("--stop-time", type=float, default=STOP_TIME, help="of all runs but the short ones, s")
    given = parser.parse_args(arguments)
    numbers = {"runs": given.runs, "fmpy_runs": given.fmpy_runs, "memory_runs": given.memory_runs}
    result, console = run(given.repetitions, stop_time=given.stop_time, **numbers), Console()
    _print(result, console)
    print_goals(result, console)
    write_json(given.json, result)
    return 0


def run(
    repetitions: int = REPETITIONS,
    *,
    runs: int = RUNS,
    fmpy_runs: int = FMPY_RUNS,
    memory_runs: int = MEMORY_RUNS,
    stop_time: float = STOP_TIME,
) -> dict[str, Any]:
    """Measure everything.

    Parameters
    ----------
    repetitions
        Rounds of the comparisons.
    runs, fmpy_runs, memory_runs
        Runs of the large study, of the sweep over fmpy, and of the study in a fresh process.
    stop_time
        Stop time of all runs but those of the fresh process, s.

    Returns
    -------
    dict
        ``bare`` and ``engine``, ns per step (see `statistics`); ``ratios``; ``study``, ``one/two`` and
        ``fmpy_per_run``, each of wall times and of processor times, s; ``rss``, peak bytes at a tenth and at the end;
        ``goals``, ``machine`` and ``versions``.

    Raises
    ------
    BenchmarkError
        If the sweep over fmpy does not measure what the study measures.
    """
    system = _system()
    n_steps = round(stop_time / SAMPLE_TIME)
    seconds = _engine_and_bare(system, n_steps, repetitions)
    steps = dict.fromkeys(seconds, n_steps)
    study = _study(system, runs, stop_time)
    large = _seconds(study, 2)
    speedup = _workers(system, max(2, runs // 20), stop_time, repetitions)
    fmpy = _beside_fmpy(system, fmpy_runs, stop_time)
    memory = child("campaign", str(memory_runs))
    found = ratios((("engine", "bare"),), seconds, steps)
    return {
        **{variant: statistics(values, n_steps) for variant, values in seconds.items()},
        "ratios": found,
        "runs": runs,
        "study": large,
        "one/two": speedup,
        "fmpy_per_run": fmpy,
        "rss": memory,
        "goals": [goal.record() for goal in _goals(found, (large, speedup, fmpy), memory, runs)],
        "machine": machine(),
        "versions": versions(),
    }


def _system() -> System:
    about = find_scenario("fig7")
    return about.system(fmus(about.models.values())).with_sample_time(SAMPLE_TIME)


def _study(system: System, runs: int, stop_time: float) -> Study:
    low, high = WALLS
    study = Study(system, measure=list(MEASURES), stop_time=stop_time)
    return study.grid({VARIED: np.geomspace(low, high, runs).tolist()})


def _seconds(study: Study, workers: int) -> dict[str, float]:
    """Wall time and processor time of a study, s; a study before has compiled its library."""
    begin, processor = perf_counter(), process_time()
    table = study.run(workers=workers)
    seconds = {"wall": perf_counter() - begin, "processor": process_time() - processor}
    if not (table["status"].to_numpy() == "complete").all():
        msg = "Runs of the study failed."
        raise BenchmarkError(msg)
    return seconds


def _engine_and_bare(system: System, n_steps: int, repetitions: int) -> dict[str, np.ndarray]:
    """Processor times of n steps, s, shape (n_repetitions, 1), by variant."""
    study = _study(system, CHUNK, n_steps * SAMPLE_TIME)
    job = study._setting.job(next(iter(study._setting.systems)), study._design)
    engine, points = engine_for(job.task), job.points(np.arange(CHUNK))

    def time_engine(n: int) -> np.ndarray:
        begin = thread_time()
        outcomes = engine.make(points)
        seconds = thread_time() - begin
        if any(outcomes.messages) or n != n_steps:
            msg = f"The engine failed: {outcomes.messages}."
            raise BenchmarkError(msg)
        return np.array([seconds / CHUNK])

    with Bench(system.set({VARIED: WALLS[0]}), n_steps) as bench:

        def time_bare(n: int) -> np.ndarray:
            bench.restore()
            begin = thread_time()
            bench.bare.run(bench.times, bench.step, 0, n)
            return np.array([thread_time() - begin])

        measures = {"bare": time_bare, "engine": time_engine}
        return alternate(measures, dict.fromkeys(measures, n_steps), repetitions)


def _workers(system: System, runs: int, stop_time: float, repetitions: int) -> dict[str, float]:
    """Ratios of the times of a smaller study with one worker and with two, medians over rounds.

    The ratio of processor times is the ratio of wall times on a machine without other jobs, if no worker waits.
    """
    study = _study(system, runs, stop_time)
    rounds = [[_seconds(study, workers) for workers in (1, 2)] for _ in range(max(1, repetitions // 3))]
    return {
        "wall": float(np.median([one["wall"] / two["wall"] for one, two in rounds])),
        "processor": 2 * float(np.median([one["processor"] / two["processor"] for one, two in rounds])),
    }


def _beside_fmpy(system: System, runs: int, stop_time: float) -> dict[str, float]:
    """Time per run, s, of two workers of a study and of two processes over fmpy, which measure the same."""
    walls = np.geomspace(*WALLS, runs).tolist()
    study = _study(system, runs, stop_time)
    table = study.run(workers=2)
    times, found = time_sweep(Sweep.of(system, stop_time), [{VARIED: wall} for wall in walls], 2)
    ours = np.column_stack([table[name].to_numpy() for name in MEASURES])
    if found.tobytes() != ours.tobytes():
        msg = f"The sweep over fmpy measures something else: {found.tolist()} instead of {ours.tolist()}."
        raise BenchmarkError(msg)
    return times


def _goals(
    found: Mapping[str, Mapping[str, float]],
    times: tuple[Mapping[str, float], Mapping[str, float], Mapping[str, float]],
    memory: Mapping[str, float],
    runs: int,
) -> list[Goal]:
    """Goals, all of wall times but the first."""
    study, speedup, fmpy = (each["wall"] for each in times)
    rate, per_run = 1 / found["engine/bare"]["median_of_rounds"], study / runs
    return [
        Goal("rate of the engine / of the bare functions", rate, RATE_LIMIT, at_least=True),
        Goal("one worker / two", speedup, WORKERS_LIMIT, at_least=True),
        Goal(f"{RUNS} runs on two cores, s", per_run * RUNS, SECONDS_LIMIT),
        Goal("fmpy with joblib / study, time per run", fmpy / per_run, FMPY_LIMIT, at_least=True),
        Goal("peak memory at the end / at a tenth", memory["end"] / memory["tenth"], MEMORY_LIMIT),
    ]


def _print(result: Mapping[str, Any], console: Console) -> None:
    """Print the numbers besides the goals."""
    table = Table("ns per step, processor time", "minimum", "median", title="Fig. 7 at 10 kHz")
    for variant in ("bare", "engine"):
        table.add_row(variant, *(f"{result[variant][key]:.1f}" for key in ("minimum_ns", "median_ns")))
    console.print(table)
    table = Table("what", "wall time", "processor time / 2 cores")
    study, speedup, fmpy = result["study"], result["one/two"], result["fmpy_per_run"]
    table.add_row(f"{result['runs']} runs, s", f"{study['wall']:.4g}", f"{study['processor'] / 2:.4g}")
    table.add_row("one worker / two", f"{speedup['wall']:.3f}", f"{speedup['processor']:.3f}")
    table.add_row("fmpy with joblib, s per run", f"{fmpy['wall']:.3g}", f"{fmpy['processor'] / 2:.3g}")
    table.add_row("peak memory at the end, MB", f"{result['rss']['end'] / 1e6:.0f}", "")
    console.print(table)


if __name__ == "__main__":
    raise SystemExit(main())
