"""Fails a thousand times in one process, in many ways, and says what that has left behind.

    python -m tests.faults.shim.thousand FAULTY HEALTHY TORN

TORN is an FMU whose library cannot be loaded. Standard output gets one JSON object: what the process holds after the
first runs, after each further part of them, and after all.
"""

import gc
import os
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from itertools import cycle, islice
from pathlib import Path

from orchestration import Fmu, OrchestrationError, RunInterrupted, simulate, stream
from tests.faults.shim.codes import Fault
from tests.faults.shim.documented import RUNS
from tests.faults.shim.fmus import AFTER, STEP, STOP, coupled
from tests.faults.shim.offspring import print_line

RUNS_IN_ALL, FIRST, PART = 1000, 400, 100
FAILURES = (
    ("fmi2Instantiate", Fault.ERROR, 0),
    ("fmi2EnterInitializationMode", Fault.ERROR, 0),
    ("fmi2ExitInitializationMode", Fault.FATAL, 0),
    ("fmi2DoStep", Fault.ERROR, AFTER),
    ("fmi2DoStep", Fault.FATAL, AFTER),
    ("fmi2GetReal", Fault.NAN, AFTER),
    ("fmi2GetFMUstate", Fault.ERROR, 1),
    ("fmi2SetFMUstate", Fault.ERROR, 1),
    ("fmi2Terminate", Fault.ERROR, 0),
)


def main() -> int:
    """Fail, count, and tell; returns the exit code."""
    faulty, healthy, torn = map(Path, sys.argv[1:])
    ways = [_run(faulty, healthy, failure, name) for name in RUNS for failure in FAILURES]
    ways += [_crashed(faulty, healthy)]
    ways += [_torn(torn), _streamed(faulty, healthy), _interrupted(faulty, healthy), _alone(faulty)] * 3
    kinds: Counter[str] = Counter()
    held = []
    for number, way in enumerate(islice(cycle(ways), RUNS_IN_ALL), start=1):
        try:
            way()
        except (OrchestrationError, RunInterrupted) as error:
            kinds[type(error).__name__] += 1
        if number >= FIRST and number % PART == 0:
            held.append(_held())
    resident = [at["resident"] for at in held]
    print_line({"before": held[0], "after": held[-1], "resident": resident, "errors": dict(kinds)})
    return 0


def _run(faulty: Path, healthy: Path, failure: tuple[str, Fault, int], name: str) -> Callable[[], object]:
    function, fault, after = failure
    system = coupled(faulty, healthy, fault, function, after)
    return lambda: simulate(system, STOP, STEP, RUNS[name])


def _torn(torn: Path) -> Callable[[], object]:
    return lambda: simulate(coupled(torn, torn, None, ""), STOP, STEP)


def _crashed(faulty: Path, healthy: Path) -> Callable[[], object]:
    system = coupled(faulty, healthy, Fault.SEGMENTATION, "fmi2DoStep")
    return lambda: simulate(system, STOP, STEP, isolate=["faulty"])


def _streamed(faulty: Path, healthy: Path) -> Callable[[], object]:
    system = coupled(faulty, healthy, Fault.ERROR, "fmi2DoStep")
    return lambda: stream("rows.parquet", system, STOP, STEP)


def _interrupted(faulty: Path, healthy: Path) -> Callable[[], object]:
    def stop(*_: int) -> None:
        raise KeyboardInterrupt

    return lambda: simulate(coupled(faulty, healthy, None, ""), STOP, STEP, progress=stop)


def _alone(faulty: Path) -> Callable[[], object]:
    def drive() -> None:
        with Fmu(faulty) as fmu:
            fmu.set(nothing=1.0)

    return drive


def _held() -> dict[str, int]:
    """Mappings, descriptors, threads, temporary files, and resident memory in kB."""
    gc.collect()
    resident = re.search(r"VmRSS:\s+(\d+)", Path("/proc/self/status").read_text(encoding="utf-8"))
    return {
        "mappings": len(Path("/proc/self/maps").read_text(encoding="utf-8").splitlines()),
        "descriptors": len(os.listdir("/proc/self/fd")),
        "threads": len(os.listdir("/proc/self/task")),
        "temporary": len(os.listdir(tempfile.gettempdir())),
        "resident": int(resident[1]) if resident else 0,
    }


if __name__ == "__main__":
    raise SystemExit(main())
