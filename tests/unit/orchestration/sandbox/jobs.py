"""Jobs for a child process, of which some end as a stranger's binary may end."""

import os
import signal
import socket
import sys
import tempfile
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
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


def forge(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:
    """Write records to standard output, to every open descriptor and to every file in sight, and again those of old."""
    announce("forge")
    write(word="true")
    record = b'{"word": "forged"}\n'
    signed = b"0" * 64 + b' [99, {"word": "forged"}]\n'
    for descriptor in range(64):
        for content in (record, signed, b"\xff\n", b"\n"):
            with suppress(OSError):
                os.write(descriptor, content)
    for path in Path(plan["trace"]).parent.rglob("*"):
        with suppress(OSError):
            path.write_bytes(record)
    write(word="last")


def reach(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Ask for what is denied, in calls that are announced."""
    for name, attempt in {"fmi2DoStep": lambda: socket.socket(), "fmi2Reset": os.fork}.items():
        announce(name)
        try:
            attempt()
        except PermissionError:
            write(denied=name)
        announce("")


def leave(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Leave files in the working directory and in that for temporary files."""
    Path("here.txt").write_text("x")
    with tempfile.NamedTemporaryFile(delete=False, suffix=".kept"):
        write(folder=str(Path.cwd()))


def plod(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Go on for ever, with a sign of life now and then."""
    while True:
        announce("plod")
        time.sleep(0.01)


def surroundings(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Write the environment variables, the open descriptors, and whether standard input is empty."""
    write(variables=sorted(os.environ), umask=os.umask(0o077), read=sys.stdin.read())
    write(descriptors=[os.readlink(f"/proc/self/fd/{n}") for n in os.listdir("/proc/self/fd")[:-1]])


def flood(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001
    """Write large files, each as large as a file may be."""
    for i in range(1000):
        with suppress(OSError), Path(str(i)).open("wb") as file:
            file.truncate(60 * 1024**2)
    time.sleep(3600)
