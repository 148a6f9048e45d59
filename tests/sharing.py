"""Folders that one of several test processes makes, and that all of them use.

pytest-xdist runs the tests in several worker processes, and each worker sets up its own fixtures. What
takes long to make, and is only read afterwards, is made once for all workers of a run.
"""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Folder of this run of the tests with what the first worker made that asked for it.

    The other workers wait until the folder is whole. If `make` fails, each worker that asks tries again,
    so that every test which needs the folder shows the error.

    Parameters
    ----------
    name
        Name of the folder, the same in all workers and for no other purpose.
    make
        Fills an empty folder. The folder is renamed afterwards, so files in it must not hold its path.
    """
    own = factory.getbasetemp()
    # The worker's folder lies in that of the run; without workers there is only one folder.
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    folder, draft = shared / name, shared / f"{name}.draft"
    with FileLock(shared / f"{name}.lock"):
        if not folder.is_dir():
            shutil.rmtree(draft, ignore_errors=True)
            draft.mkdir()
            make(draft)
            draft.rename(folder)
    return folder
