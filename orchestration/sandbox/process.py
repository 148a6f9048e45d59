"""Runs a job in a child process that may crash or hang without harm, and reports what it wrote and how it ended."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orchestration.sandbox.worker import DONE, STARTED, TRACE_BYTES

POLL = 0.01  # s
LONGEST_START = 120.0  # s that an interpreter may need to start and import the job on a machine that is busy
ROOT = str(Path(__file__).parents[2])
PRINTED = 200  # bytes of what was printed that are read


@dataclass(frozen=True)
class Ending:
    """How a job in a child process ended, and what it left; `function` and `printed` may hold any characters.

    Attributes
    ----------
    lines
        JSON objects that the job wrote.
    how
        Empty if the job came to its end, else the end of a sentence, such as ``dies of SIGSEGV``.
    function
        Last announcement of a job whose process ended too early; empty if the job had announced nothing.
    printed
        The beginning of the process's standard output.
    """

    lines: Sequence[Mapping[str, Any]]
    how: str
    function: str
    printed: str


def work(job: str, plan: Mapping[str, Any], folder: Path, *, timeout: float, memory: int | None = None) -> Ending:
    """Run a job in a child process and wait for its end.

    Parameters
    ----------
    job
        The job's function as ``module:function``; `orchestration.sandbox.worker` describes its arguments.
    plan
        Data for the job that JSON can hold. The plan is written to `folder`, and so are the results.
    timeout
        Longest time that the job may write nothing, s; the start of the process does not count.
    memory
        Bytes of addresses that the process may take; None sets no limit.
    """
    results, trace, printed = folder / "results", folder / "trace", folder / "printed"
    results.write_bytes(b"")
    trace.write_bytes(bytes(TRACE_BYTES))
    path = folder / "plan.json"
    given = {"job": job, "memory": memory, "results": str(results), "trace": str(trace)}
    path.write_text(json.dumps({**plan, **given}), encoding="utf-8")
    with printed.open("wb") as out:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "orchestration.sandbox.worker", str(path)],
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=subprocess.DEVNULL,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, (ROOT, os.environ.get("PYTHONPATH"))))},
        )
        try:
            late = _wait(process, results, timeout)
        finally:
            if process.poll() is None:
                process.kill()
            process.wait()
    written = _lines(results)
    done = any(DONE in line for line in written)
    lines = [line for line in written if not {STARTED, DONE} & set(line)]
    function = _beginning(trace, TRACE_BYTES)
    said = _beginning(printed, PRINTED)
    how = f"does not return within {timeout:g} s" if late else "" if done else _death(process.returncode)
    return Ending(lines, how, "" if done else function, said)


def _wait(process: subprocess.Popen[bytes], results: Path, timeout: float) -> bool:
    """Wait for the end of a process; returns whether the process wrote nothing for too long."""
    size, heard = -1, time.monotonic()
    while process.poll() is None:
        now = results.stat().st_size if results.exists() else 0
        if now != size:
            size, heard = now, time.monotonic()
        elif time.monotonic() - heard > (timeout if size else max(timeout, LONGEST_START)):
            return True
        time.sleep(POLL)
    return False


def _beginning(path: Path, most: int) -> str:
    """Return the first bytes of a file as text; empty if the binary removed the file."""
    try:
        with path.open("rb") as file:
            return file.read(most).rstrip(b"\0").decode(errors="replace")
    except OSError:
        return ""


def _lines(path: Path) -> list[dict[str, Any]]:
    """Return the objects in the complete lines of the results."""
    found = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines() if path.exists() else ():
        try:
            value = json.loads(line)
        except ValueError:
            continue
        if isinstance(value, dict):
            found.append(value)
    return found


def _death(code: int) -> str:
    if code >= 0:
        return f"ends the process with exit code {code}"
    try:
        return f"dies of {signal.Signals(-code).name}"
    except ValueError:
        return f"dies of signal {-code}"
