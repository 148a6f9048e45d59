"""The program of a child process that runs an untrusted binary: ``python -m orchestration.sandbox.worker``.

The plan, a JSON object on standard input, names a job, ``module:function``; the child process imports it and calls it:

    job(plan, write, announce)

`write` sends one JSON object, given as keyword arguments, to the parent. `announce` leaves a short text in a small
shared memory. A job announces each function of the binary before the call, and an empty text after it. So the parent
process knows what happened even if the child process dies or hangs, whatever the binary prints.

Before the job begins, the process is confined; see `orchestration.sandbox.confinement`.
"""

import json
import mmap
import os
import socket
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from orchestration.sandbox.channel import Sender
from orchestration.sandbox.confinement import Limits, limit, seal

TRACE_BYTES = 64  # of an announcement
COUNT_BYTES = 8  # before it: how often something was announced
STARTED, DONE = "started", "done"  # records of the worker itself

Write = Callable[..., None]
Announce = Callable[[str], None]


def main() -> None:
    """Run the job that the plan names."""
    plan = json.loads(sys.stdin.buffer.read())
    sender = Sender(_channel(Path(plan["printed"])), bytes.fromhex(plan.pop("key")))
    module, _, function = plan["job"].partition(":")
    job = getattr(import_module(module), function)
    with Path(plan["trace"]).open("r+b") as file, mmap.mmap(file.fileno(), COUNT_BYTES + TRACE_BYTES) as trace:
        count = 0

        def write(**record: Any) -> None:
            sender.send(record)

        def announce(function: str) -> None:
            nonlocal count
            count += 1
            trace[COUNT_BYTES:] = function.encode()[:TRACE_BYTES].ljust(TRACE_BYTES, b"\0")
            trace[:COUNT_BYTES] = count.to_bytes(COUNT_BYTES, "little")

        write(**{STARTED: _confine(plan)})
        job(plan, write, announce)
        write(**{DONE: True})
    os._exit(0)  # without the destructors of a library that may crash in them


def _channel(printed: Path) -> int:
    """Take standard output for the channel; what a binary prints goes to a file, and it has nothing to read."""
    channel = os.dup(1)
    for descriptor, path, flags in ((1, printed, os.O_WRONLY | os.O_CREAT | os.O_APPEND), (0, os.devnull, os.O_RDONLY)):
        opened = os.open(path, flags)
        os.dup2(opened, descriptor)
        os.close(opened)
    return channel


def _confine(plan: dict[str, Any]) -> list[str]:
    """Confine this process as the plan says; returns the measures that are in force."""
    measures = limit(Limits(memory=plan["memory"], time=plan["time"]), plan["parent"])
    if plan["denials"] is None:
        return measures + seal([Path(folder) for folder in plan["folders"]])
    with socket.socket(fileno=plan["denials"]) as teller:
        return measures + seal([Path(folder) for folder in plan["folders"]], teller)


if __name__ == "__main__":
    main()
