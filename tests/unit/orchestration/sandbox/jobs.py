"""Jobs for a child process, of which some end as a stranger's binary may end."""

import os
import signal
import time
from collections.abc import Mapping
from typing import Any

from orchestration.sandbox.worker import TRACE_BYTES, Announce, Write


def echo(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:
    """Write what the plan says."""
    announce("echo")
    for word in plan["words"]:
        write(word=word)


def die(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Die in a call with a long name, after a line."""
    write(word="last")
    announce("x" * (TRACE_BYTES + 1))
    os.kill(os.getpid(), signal.SIGKILL)


def hang(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Never come back."""
    announce("hang")
    while True:
        time.sleep(1)


def swallow(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Ask for more memory than the plan allows, and write whether that was refused."""
    try:
        write(size=len(bytes(plan["bytes"])))
    except MemoryError:
        write(refused=True)
