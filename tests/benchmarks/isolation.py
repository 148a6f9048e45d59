"""Measures what isolation costs: time per step and isolated component, and time until the first step.

    python -m tests.benchmarks.isolation [--json FILE] [--repetitions N] [--steps N] [--alone]

Fig. 2 without isolation, with its controller and with all five components in processes of their own. ``--alone`` gives
the processes a real-time priority, which the system must allow: then they have the processor's cores for
themselves, also on a machine that others use.

What is asserted is that all record the same bits.
"""

import argparse
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from orchestration.master.simulate import prepare
from orchestration.paper.built_fmus import find_scenario, fmus
from orchestration.system.system import System
from tests.benchmarks.report import machine, versions

STEPS, REPETITIONS, WARM = 4000, 9, 100
PRIORITY = 5  # among real-time priorities: a low one
CHOICES: Mapping[str, Any] = {"none": None, "controller": ["controller"], "all five": True}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time per step with isolated components.")
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--repetitions", type=int, default=REPETITIONS)
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--alone", action="store_true", help="with a real-time priority")
    given = parser.parse_args(arguments)
    result = run(given.steps, given.repetitions, alone=given.alone)
    _print(result)
    if given.json is not None:
        given.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return 0


def run(steps: int, repetitions: int, *, alone: bool = False) -> dict[str, Any]:
    """Measure each choice in turn; times in microseconds per step and component, and in seconds.

    Raises
    ------
    AssertionError
        If two choices do not record the same bits.
    """
    about = find_scenario("fig2")
    system = about.system(fmus(about.models.values()))
    step_times: dict[str, list[float]] = {name: [] for name in CHOICES}
    starts: dict[str, list[float]] = {name: [] for name in CHOICES}
    rows: dict[str, np.ndarray] = {}
    for _ in range(repetitions):
        for name, isolate in CHOICES.items():
            started, seconds, rows[name] = _measured(system, isolate, steps, alone=alone)
            starts[name].append(started)
            step_times[name].append(1e6 * seconds / steps)
    for name, found in rows.items():
        if found.tobytes() != rows["none"].tobytes():
            msg = f"{name} does not record the bits of a run without isolation."
            raise AssertionError(msg)
    return {
        "machine": machine(),
        "versions": versions(),
        "alone": alone,
        "microseconds_per_step": {name: median(times) for name, times in step_times.items()},
        "added_per_component": {
            name: (median(step_times[name]) - median(step_times["none"])) / n
            for name, n in (("controller", 1), ("all five", len(system.components)))
        },
        "start_seconds": {name: median(times) for name, times in starts.items()},
    }


def _measured(system: System, isolate: Any, steps: int, *, alone: bool) -> tuple[float, float, np.ndarray]:
    """Seconds until a run is ready and of its steps, and its rows."""
    began = perf_counter()
    with prepare(system, (steps + WARM) * system.run_step(), isolate=isolate) as simulation:
        started = perf_counter() - began
        simulation.run(until=float(simulation.grid.times[WARM]))
        with _Priority(wanted=alone):
            began = perf_counter()
            simulation.run()
            seconds = perf_counter() - began
        return started, seconds, simulation.result().rows


class _Priority:
    """Gives this process and its children a real-time priority within a context."""

    def __init__(self, *, wanted: bool) -> None:
        self._wanted = wanted

    def __enter__(self) -> None:
        if self._wanted:
            self._set(os.SCHED_FIFO, PRIORITY)

    def __exit__(self, *_: object) -> None:
        if self._wanted:
            self._set(os.SCHED_OTHER, 0)

    @staticmethod
    def _set(policy: int, priority: int) -> None:
        own = os.getpid()
        children = Path(f"/proc/{own}/task/{own}/children").read_text(encoding="ascii").split()
        for process in (own, *map(int, children)):
            os.sched_setscheduler(process, policy, os.sched_param(priority))


def _print(result: Mapping[str, Any]) -> None:
    table = Table("isolated", "us per step", "added per component, us", "start, s")
    for name, microseconds in result["microseconds_per_step"].items():
        added = result["added_per_component"].get(name)
        start = f"{result['start_seconds'][name]:.3f}"
        table.add_row(name, f"{microseconds:.2f}", "" if added is None else f"{added:.2f}", start)
    Console().print(table)


if __name__ == "__main__":
    raise SystemExit(main())
