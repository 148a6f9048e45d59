"""The program of a child process that runs an untrusted binary: ``python -m orchestration.sandbox.worker PLAN``.

The plan, a JSON file, names a job, ``module:function``; the child process imports it and calls it:

    job(plan, write, announce)

`write` appends one JSON object, given as keyword arguments, to the file of results. `announce` leaves a
short text in a small shared file. A job announces each function of the binary before the call. So the parent
process knows what happened even if the child process dies or hangs, whatever the binary prints.
"""

import json
import mmap
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

TRACE_BYTES = 64
STARTED, DONE = "started", "done"  # lines of the worker itself
MOST_WRITTEN = 64 * 1024**2  # bytes that a file may grow to: a binary that prints for ever fills no disk

Write = Callable[..., None]
Announce = Callable[[str], None]


def main() -> None:
    """Run the job that the plan names."""
    plan = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    module, _, function = plan["job"].partition(":")
    job = getattr(import_module(module), function)
    with (
        Path(plan["results"]).open("a", encoding="utf-8") as results,
        Path(plan["trace"]).open("r+b") as file,
        mmap.mmap(file.fileno(), TRACE_BYTES) as trace,
    ):

        def write(**line: Any) -> None:
            results.write(json.dumps(line) + "\n")
            results.flush()

        def announce(function: str) -> None:
            trace[:] = function.encode()[:TRACE_BYTES].ljust(TRACE_BYTES, b"\0")

        _limit(plan["memory"])
        write(**{STARTED: True})
        job(plan, write, announce)
        write(**{DONE: True})
    os._exit(0)  # without the destructors of a library that may crash in them


def _limit(memory: int | None) -> None:
    """Limit the file size and the memory of the process, where the system can."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_WRITTEN, MOST_WRITTEN))
        if memory is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))


if __name__ == "__main__":
    main()
