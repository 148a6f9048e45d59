"""Runs one job in one tool: ``python -m tests.interop.matrix.worker TOOL JOB.json OUT.npz``.

What it answers is OUT.npz and, on stdout's last line, the version of the tool; a failure is the last
line of stderr and exit code 1.
"""

import importlib.metadata
import sys
import traceback
from pathlib import Path

from tests.interop.matrix.protocol import Job
from tests.interop.matrix.tools import module

FAILED = "FAILED: "
VERSION = "VERSION: "


def main(key: str, job: str, out: str) -> int:
    """Run it; returns the exit code."""
    tool = module(key)
    sys.stdout.write(f"{VERSION}{importlib.metadata.version(tool.TOOL.distribution)}\n")
    sys.stdout.flush()
    try:
        tool.run(Job.read(Path(job))).write(Path(out))
    except Exception as error:  # whatever a tool raises is its answer
        traceback.print_exc()
        sys.stderr.write(f"\n{FAILED}{type(error).__name__}: {' '.join(str(error).split())}\n")
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
