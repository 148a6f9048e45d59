"""Runs systems whose FMU misbehaves, each in a process of its own, and says how each process ended.

    python -m tests.faults.shim.offspring FAULTY HEALTHY

Standard input has a `Case` on each line, standard output gets a `Report` on each line, both as JSON. A process is a
fork of this one, which has compiled all loops and made the runs of healthy FMUs already; so a case takes milliseconds.
A fault that is a status only needs no process of its own.
"""

import json
import os
import select
import signal
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from orchestration import Isolation, OrchestrationError, Result, SimulationError, simulate
from tests.faults.shim.codes import FIRST_BESIDE_STATUS, Fault
from tests.faults.shim.documented import COMPLETE, ENDED, FAILED, HANGS, KILLED, RUNS
from tests.faults.shim.fmus import AFTER, STEP, STOP, coupled

REFUSED = "refused"


@dataclass(frozen=True)
class Case:
    """A run: the fault, the function that makes it, and how long the run may take, s.

    Attributes
    ----------
    limit
        Longest time that a call may take in a process of the component's own, s; None for a component that is not
        isolated.
    """

    fault: str
    function: str
    algorithm: str
    after: int = AFTER
    patience: float = 300.0
    limit: float | None = None


@dataclass(frozen=True)
class Report:
    """How a run ended.

    Attributes
    ----------
    outcome
        A word of the documented table; ``ended`` if the process ended before the run did; ``refused`` if an error
        has no place for rows.
    detail
        The error's message, the signal's name, or the exit code and what is on standard error.
    rows
        Number of rows.
    same
        Whether these rows are the first ones of a healthy run, bitwise.
    """

    outcome: str
    detail: str = ""
    rows: int = 0
    same: bool = True


def main() -> int:
    """Answer each case; returns the exit code."""
    faulty, partner = map(Path, sys.argv[1:])
    healthy = {
        name: simulate(coupled(faulty, partner, None, ""), STOP, STEP, algorithm) for name, algorithm in RUNS.items()
    }
    for line in sys.stdin:
        case = Case(**json.loads(line))
        run = _run if Fault[case.fault] < FIRST_BESIDE_STATUS else _in_child
        print_line(asdict(run(case, (faulty, partner), healthy[case.algorithm])))
    return 0


def print_line(content: dict) -> None:
    """Write an object on a line of standard output."""
    sys.stdout.write(json.dumps(content) + "\n")
    sys.stdout.flush()


def _in_child(case: Case, fmus: tuple[Path, Path], healthy: Result) -> Report:
    reader, writer = os.pipe()
    errors = tempfile.TemporaryFile("w+")
    child = os.fork()
    if child == 0:
        os.close(reader)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.dup2(errors.fileno(), 2)
        report = _run(case, fmus, healthy)
        os.write(writer, json.dumps(asdict(report)).encode())
        os._exit(0)
    os.close(writer)
    in_time = bool(select.select([reader], [], [], case.patience)[0])
    if not in_time:
        os.kill(child, signal.SIGKILL)
    said = b"".join(iter(lambda: os.read(reader, 65536), b""))
    os.close(reader)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if not in_time:
        return Report(HANGS)
    if code < 0:
        return Report(KILLED, signal.Signals(-code).name)
    if said:
        return Report(**json.loads(said))
    with errors:
        errors.seek(0)
        return Report(ENDED, f"{code}: {errors.read().strip()}")


def _run(case: Case, fmus: tuple[Path, Path], healthy: Result) -> Report:
    try:
        system = coupled(*fmus, Fault[case.fault], case.function, case.after)
        isolate = None if case.limit is None else Isolation([system.components[0].name], time_limit=case.limit)
        result = simulate(system, STOP, STEP, RUNS[case.algorithm], isolate=isolate)
    except SimulationError as error:
        count = len(error.result.time) if error.result else 0
        same = not error.result or error.result.rows.tobytes() == healthy.rows[:count].tobytes()
        return Report(FAILED, str(error), count, same)
    except OrchestrationError as error:
        return Report(REFUSED, str(error))
    return Report(COMPLETE, result.message, len(result.time), result.rows.tobytes() == healthy.rows.tobytes())


if __name__ == "__main__":
    raise SystemExit(main())
