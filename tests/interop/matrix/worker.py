"""Runs one job in one tool: ``python -m tests.interop.matrix.worker TOOL JOB.json OUT.npz``.

What it answers is OUT.npz and, on stdout's last line, the version of the tool; a failure is the last
line of stderr and exit code 1.
"""

import importlib.metadata
import sys
import traceback
from pathlib import Path

from tests.interop.matrix.protocol import Job, ToolError
from tests.interop.matrix.tools import module

FAILED = "FAILED: "
VERSION = "VERSION: "


def main(key: str, job: str, out: str) -> int:
    """Run it; returns the exit code."""
    tool = module(key)
    sys.stdout.write(f"{VERSION}{importlib.metadata.version(tool.TOOL.distribution)}\n")
    sys.stdout.flush()
    said = _listen()
    try:
        tool.run(Job.read(Path(job))).write(Path(out))
    except Exception as error:  # whatever a tool raises is its answer
        traceback.print_exc()
        text = str(error) if isinstance(error, ToolError) else f"{type(error).__name__}: {error}"
        text += f' The FMU\'s last message: "{said[-1]}"' if said else ""
        sys.stderr.write(f"\n{FAILED}{' '.join(text.split())}\n")
        return 1
    return 0


def _listen() -> list[str]:
    """Hear what FMUs log, in tools that call them through fmpy; else a failed call has no reason."""
    said: list[str] = []
    try:
        from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
    except ImportError:
        return said
    instantiate = FMU2Slave.instantiate

    def instantiate_listening(self, visible=False, callbacks=None, loggingOn=False) -> None:  # noqa: ARG001
        own = fmi2CallbackFunctions()
        own.logger = fmi2CallbackLoggerTYPE(lambda _e, _n, _s, _c, message: said.append(message.decode()))
        self.heard_by_the_matrix = own
        instantiate(self, visible, own, True)

    FMU2Slave.instantiate = instantiate_listening
    return said


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
