"""Lets the processes that tests start share the bytecode of the modules they import.

A process that has to compile the packages to bytecode first needs three times as long to run a figure. Where Python
writes no bytecode, as with PYTHONDONTWRITEBYTECODE, that holds for each of several hundred processes. So a run of the
tests has a folder for it, beside no source file.
"""

import os
import shutil
import tempfile

import pytest

PREFIX, SWITCHED_OFF = "PYTHONPYCACHEPREFIX", "PYTHONDONTWRITEBYTECODE"
_folders: list[str] = []


def pytest_configure(config: pytest.Config) -> None:
    """Make the folder and name it to all later processes; the workers of xdist inherit the name."""
    if PREFIX not in os.environ and not hasattr(config, "workerinput"):
        _folders.append(tempfile.mkdtemp(prefix="adaptimp-bytecode-"))
        os.environ[PREFIX] = _folders[-1]
        os.environ.pop(SWITCHED_OFF, None)


def pytest_unconfigure() -> None:
    """Remove the folder, in the process that made it."""
    for folder in _folders:
        shutil.rmtree(folder, ignore_errors=True)
