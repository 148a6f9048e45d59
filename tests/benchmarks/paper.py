"""Measures how long ``adaptimp paper`` takes on a clean machine, and with everything in the cache.

    python -m tests.benchmarks.paper [--json FILE]

The command runs in fresh processes. The first one has an empty cache: it builds the FMUs, compiles the loop and the
native libraries, and measures all claims. The second one takes them from the cache. The byte code of Python and
files that the operating system has read stay in memory. Both elapsed time and processor time are told, and the load
of the machine before the first run: other jobs lengthen the former more than the latter.
"""

import argparse
import os
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from rich.console import Console
from rich.table import Table

from tests.benchmarks.report import Goal, machine, print_goals, versions, write_json

COLD_LIMIT = 90.0  # s, on two free cores
STATES = ("cold", "cached")
COMMAND = (sys.executable, "-c", "from orchestration.cli import main; main()", "paper", "-o")


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time of adaptimp paper.")
    parser.add_argument("--json", type=Path, help="file to write")
    given = parser.parse_args(arguments)
    result, console = run(), Console()
    table = Table("adaptimp paper", "elapsed, s", "processor, s")
    for state in STATES:
        table.add_row(state, *(f"{result[state][key]:.1f}" for key in ("elapsed", "processor")))
    console.print(table)
    console.print(f"Load before: {result['load']:.2f}")
    print_goals(result, console)
    write_json(given.json, result)
    return 0


def run(command: Sequence[str] = COMMAND) -> dict[str, Any]:
    """Measure the command twice with a cache that is empty at first.

    Parameters
    ----------
    command
        The command, which is given a folder for its files as its last argument.

    Returns
    -------
    dict
        ``cold`` and ``cached``, each with ``elapsed`` and ``processor``, s; ``load``: the load of the machine in the
        minute before; ``goals``, ``machine`` and ``versions``.
    """
    load = os.getloadavg()[0]
    with TemporaryDirectory() as folder:
        found = {state: _time([*command, f"{folder}/out"], f"{folder}/cache") for state in STATES}
    goal = Goal("adaptimp paper, cold, s", found["cold"]["elapsed"], COLD_LIMIT)
    return {**found, "load": load, "goals": [goal.record()], "machine": machine(), "versions": versions()}


def _time(command: Sequence[str], cache: str) -> dict[str, float]:
    """Elapsed and processor time of a command and of the processes that it starts, s."""
    begin, before = perf_counter(), _processor()
    done = subprocess.run(
        command, env={**os.environ, "ADAPTIMP_CACHE": cache}, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        msg = f"{' '.join(command)} ended with {done.returncode}:\n{done.stderr.strip()}"
        raise RuntimeError(msg)
    return {"elapsed": perf_counter() - begin, "processor": _processor() - before}


def _processor() -> float:
    """Processor time of all processes that this one has started and that have ended, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    raise SystemExit(main())
