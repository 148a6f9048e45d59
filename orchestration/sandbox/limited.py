"""Runs a program of this machine, such as a compiler, on the files of a stranger, with limits.

    python -m orchestration.sandbox.limited MEMORY TIME FOLDER PROGRAM [ARGUMENT ...]

The process takes at most MEMORY bytes of addresses and TIME seconds of processor time, writes only below FOLDER where
the system can bound that (Landlock), gets no new privileges, and then becomes the program. `run_limited` starts it.
"""

import ctypes
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from orchestration.sandbox.confinement import Limits, end, environment, limit, starting
from orchestration.sandbox.interpreter import LONGEST_START, command, death, search_path
from orchestration.sandbox.landlock import write_only_below

MEMORY = 2 * 1024**3
"""Bytes of addresses that the program may take."""
TIME = 60.0
"""Processor time of the program, s."""
_SET_NO_NEW_PRIVILEGES = 38


@dataclass(frozen=True)
class Outcome:
    """How a program ended.

    Attributes
    ----------
    how
        Empty if the program succeeded, else a part of a sentence, such as ``ends with exit code 1``.
    errors
        What the program wrote to standard error.
    """

    how: str
    errors: str


def run_limited(program: Sequence[str], folder: Path, home: Path) -> Outcome:
    """Run a program with limits, and wait for its end.

    Parameters
    ----------
    program
        Path of the program and its arguments.
    folder
        Working directory.
    home
        Existing folder for files that the program makes; below it lies the working directory.
    """
    arguments = command("orchestration.sandbox.limited", str(MEMORY), str(TIME), str(home), *program)
    settings = {"PYTHONPATH": search_path(), "ZIG_GLOBAL_CACHE_DIR": str(home), "ZIG_LOCAL_CACHE_DIR": str(home)}
    process = subprocess.Popen(
        arguments,
        cwd=folder,
        env=environment(home, settings),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        **starting(),
    )
    try:
        errors = process.communicate(timeout=TIME * 10 + LONGEST_START)[1]
    except subprocess.TimeoutExpired:
        return Outcome(f"does not end within {TIME * 10:g} s", "")
    finally:
        end(process.pid)
        if process.poll() is None:
            process.kill()
        process.wait()
    return Outcome("" if process.returncode == 0 else death(process.returncode, "ends", "dies"), errors)


def main() -> None:
    """Confine this process, and become the program."""
    memory, time, folder, *program = sys.argv[1:]
    limit(Limits(memory=int(memory), time=float(time), files=None))
    if sys.platform.startswith("linux"):
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.prctl(_SET_NO_NEW_PRIVILEGES, 1, 0, 0, 0) == 0:
            write_only_below([Path(folder)], libc)
    if os.name != "posix":  # there the new program would not be the process that the parent waits for
        sys.exit(subprocess.run(program, check=False).returncode)
    os.execv(program[0], program)  # noqa: S606  # nosec B606


if __name__ == "__main__":
    main()
