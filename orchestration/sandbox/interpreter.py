"""Starts a module of this package in an interpreter of its own, and says how such a process died."""

import os
import signal
import sys
from pathlib import Path

LONGEST_START = 120.0  # s that an interpreter may need to start and import its program on a machine that is busy
_ROOT = str(Path(__file__).parents[2])


def command(module: str, *arguments: str) -> list[str]:
    """Return the command that runs a module; the working directory holds no modules for it."""
    return [sys.executable, "-P", "-m", module, *arguments]


def search_path() -> str:
    """Return the ``PYTHONPATH`` with which an interpreter finds this package and what this process finds."""
    return os.pathsep.join(filter(None, (_ROOT, os.environ.get("PYTHONPATH"))))


def death(code: int, ends: str, dies: str) -> str:
    """Return the end of a sentence on a process that has ended.

    Parameters
    ----------
    code
        Its return code as `subprocess` gives it.
    ends, dies
        Verbs for an exit and for a signal, such as ``ends the process`` and ``dies``.
    """
    if code >= 0:
        return f"{ends} with exit code {code}"
    try:
        return f"{dies} of {signal.Signals(-code).name}"
    except ValueError:
        return f"{dies} of signal {-code}"
