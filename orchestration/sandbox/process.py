"""Starts a worker, waits for it, and says what it wrote and how it ended; its end is never ours."""

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

from orchestration.check.findings import shown
from orchestration.sandbox.worker import TRACE_BYTES

POLL = 0.01  # s
ROOT = str(Path(__file__).parents[2])
PRINTED = 200  # bytes of what was printed that are read


@dataclass(frozen=True)
class Ending:
    """What a worker left.

    Attributes
    ----------
    lines
        The objects it wrote.
    how
        Empty if it ended by itself and was done, else a sentence's end, such as ``dies of SIGSEGV``.
    function
        The call during which it ended so, empty if in none.
    printed
        The beginning of what went to its standard output.
    """

    lines: Sequence[Mapping[str, Any]]
    how: str
    function: str
    printed: str


def work(plan: Mapping[str, Any], folder: Path, timeout: float) -> Ending:
    """Run a worker.

    Parameters
    ----------
    plan
        What it has to do; written to `folder`, where its files go too.
    timeout
        How long it may write nothing, s.
    """
    results, trace, printed = folder / "results", folder / "trace", folder / "printed"
    results.write_bytes(b"")
    trace.write_bytes(bytes(TRACE_BYTES))
    path = folder / "plan.json"
    path.write_text(json.dumps({**plan, "results": str(results), "trace": str(trace)}), encoding="utf-8")
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
    lines = _lines(results)
    done = any("done" in line for line in lines)
    function = shown(_beginning(trace, TRACE_BYTES))
    said = shown(_beginning(printed, PRINTED))
    how = f"does not return within {timeout:g} s" if late else "" if done else _death(process.returncode)
    return Ending(lines, how, "" if done else function, said)


def _wait(process: subprocess.Popen[bytes], results: Path, timeout: float) -> bool:
    """Whether the worker was silent for too long."""
    size, heard = -1, time.monotonic()
    while process.poll() is None:
        now = results.stat().st_size if results.exists() else 0
        if now != size:
            size, heard = now, time.monotonic()
        elif time.monotonic() - heard > timeout:
            return True
        time.sleep(POLL)
    return False


def _beginning(path: Path, most: int) -> str:
    """The first bytes of a file, empty if the binary removed it."""
    try:
        with path.open("rb") as file:
            return file.read(most).rstrip(b"\0").decode(errors="replace")
    except OSError:
        return ""


def _lines(path: Path) -> list[dict[str, Any]]:
    """The lines that are whole."""
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
