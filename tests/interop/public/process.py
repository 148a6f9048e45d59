"""Runs an examination in a process of its own."""

import os
import re
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[3]
TIMEOUT = 600.0  # s; a check of an FMU that hangs in several calls takes minutes
LONGEST = 200  # characters of a reason


@dataclass(frozen=True)
class Examination:
    """The file that an examination wrote, or why there is none."""

    out: Path | None
    failure: str = ""


def examined(way: str, path: Path, timeout: float = TIMEOUT) -> Examination:
    """Examine an FMU in a way of `tests.interop.public.examine`; the answer is put beside the FMU."""
    out = path.with_name(f"{way}.{'json' if way in ('about', 'check') else 'npz'}")
    command = [sys.executable, "-m", "tests.interop.public.examine", way, str(path), str(out)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    try:
        done = subprocess.run(
            command, cwd=path.parent, env=environment, capture_output=True, timeout=timeout, check=False
        )
    except subprocess.TimeoutExpired:
        return Examination(None, f"no result after {timeout:g} s")
    if done.returncode == 0 and out.exists():
        return Examination(out)
    if done.returncode < 0:
        return Examination(None, f"the process ends with {signal.Signals(-done.returncode).name}")
    return Examination(None, _reason(done.stderr.decode(errors="replace"), done.returncode))


def _reason(printed: str, code: int) -> str:
    """The last error that was raised, in one line and without folders."""
    starts = [match.start() for match in re.finditer(r"^[\w.]+(Error|Exception|Interrupt)?: ", printed, re.MULTILINE)]
    message = " ".join(printed[starts[-1] :].split()) if starts else f"exit code {code}"
    message = re.sub(r"/\S*/", "", message.rpartition("orchestration.errors.")[2])
    return message if len(message) <= LONGEST else f"{message[: LONGEST - 3]}..."
