"""The process that a stranger's binary runs in: ``python -m orchestration.sandbox.worker PLAN``.

It writes one JSON object per line to a file: which experiment begins and ends, what it found, what it
measured. Before each call into the binary it leaves the function's name in a small shared file. So the
parent knows what happened even if this process dies or never comes back, and whatever the binary prints.
"""

import json
import mmap
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from orchestration.check.findings import Finding, Severity

TRACE_BYTES = 64
MOST_WRITTEN = 64 * 1024**2  # bytes that a file may grow to: a binary that prints for ever fills no disk
MOST_MEMORY = 8 * 1024**3  # bytes of addresses
KNOWN = ("random", "moves")


def main() -> None:
    """Run what the plan says."""
    plan = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    with Path(plan["results"]).open("a", encoding="utf-8") as results:

        def write(**line: Any) -> None:
            results.write(json.dumps(line) + "\n")
            results.flush()

        if plan["task"] == "loop":
            from orchestration.check.closed_loop import run

            _limit(0)
            run(plan, write)
        else:
            _limit(MOST_MEMORY)
            _experiments(plan, write)
        write(done=True)
    os._exit(0)  # without the destructors of a library that may crash in them


def _experiments(plan: dict[str, Any], write: Callable[..., None]) -> None:
    from orchestration.check.dynamic.experiments import BASE, experiment
    from orchestration.check.dynamic.instance import Binary, MissingError, RefusedError

    with Path(plan["trace"]).open("r+b") as file, mmap.mmap(file.fileno(), TRACE_BYTES) as trace:

        def announce(function: str) -> None:
            trace[:] = function.encode().ljust(TRACE_BYTES, b"\0")

        announce("loading the library")
        try:
            binary = Binary(plan, announce)
        except OSError as failed:
            write(begin="loading")
            write(refused=f"the library cannot be loaded: {failed}.")
            return
        announce("")
        for name in plan["experiments"]:
            write(begin=name)
            failed = False
            try:
                for found in experiment(name)(binary):
                    failed |= isinstance(found, Finding) and found.severity == Severity.ERROR
                    write(**_line(found))
            except (RefusedError, MemoryError, OverflowError) as refused:
                failed = True
                write(refused=str(refused) or "the memory does not suffice.")
            except MissingError as missing:
                failed = True
                write(missing=str(missing))
            if failed and name in BASE:
                return
            write(known={key: binary.plan[key] for key in KNOWN if key in binary.plan}, end=name)


def _line(found: Finding | str) -> dict[str, Any]:
    return {"fact": found} if isinstance(found, str) else {"finding": [found.rule, found.severity, found.message]}


def _limit(memory: int) -> None:
    """Bound what the process may write and take, where the system can."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_WRITTEN, MOST_WRITTEN))
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))


if __name__ == "__main__":
    main()
