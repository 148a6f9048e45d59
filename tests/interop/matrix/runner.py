"""Runs a job with a tool in a process of its own, and judges the outcome."""

import os
import re
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.interop.matrix.protocol import FMU, Job, Record, Tool
from tests.interop.matrix.worker import FAILED, VERSION

ROOT = Path(__file__).parents[3]
TIMEOUT = 900.0  # s; the slowest that finishes takes about a third of it


@dataclass(frozen=True)
class Answer:
    """What a tool gave: a record, or why there is none; and its version, if it is installed."""

    record: Record | None
    failure: str = ""
    version: str = ""


def ask(tool: Tool, job: Job, timeout: float = TIMEOUT) -> Answer:
    """Run a job in a tool, in a process of its own.

    Parameters
    ----------
    timeout
        Seconds of wall time after which the process is ended and the answer is a failure.
    """
    with TemporaryDirectory() as name:
        folder = Path(name)
        job.write(folder / "job.json")
        command = [*_python(tool), "-m", "tests.interop.matrix.worker", tool.key, str(folder / "job.json")]
        command.append(str(folder / "out.npz"))
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": name}
        try:
            done = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=timeout, check=False
            )
        except subprocess.TimeoutExpired:
            return Answer(None, f"no result after {timeout:g} s")
        version = "".join(re.findall(f"^{VERSION}(.+)$", done.stdout, re.MULTILINE)[:1])
        if done.returncode == 0 and (folder / "out.npz").exists():
            return Answer(Record.read(folder / "out.npz"), version=version)
        return Answer(None, _failure(done, job), version)


def _python(tool: Tool) -> list[str]:
    """The interpreter of a tool's environment."""
    if not tool.requirements:
        return [sys.executable]
    wanted = [word for requirement in tool.requirements for word in ("--with", requirement)]
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    return ["uv", "run", "--quiet", "--no-project", "--python", python, *wanted, "python"]


def _failure(done: subprocess.CompletedProcess[str], job: Job) -> str:
    """Why, in one line without the folders of files and, so that FMUs can be told together, without their name."""
    if done.returncode < 0:
        return f"the process ends with {signal.Signals(-done.returncode).name}"
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    said = [line.removeprefix(FAILED) for line in lines if line.startswith(FAILED)]
    message = said[-1] if said else (lines[-1] if lines else f"exit code {done.returncode}")
    message = re.sub(r"(\.\.\.)?/\S*/", "", message)  # files without their folders
    return message.replace(job.name, "X") if job.kind == FMU else message
