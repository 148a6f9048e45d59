"""Keeps compiled functions between processes, in a folder named by everything that decides their machine code.

numba compares the source of a function only, and runs old code when a function that it calls has changed. So
the folder's name is a hash of every source that is compiled, and of the versions of Python and the compilers:
machine code of other sources is in another folder, and cannot be run by mistake.

The module stands here because both the loops of the master and the input scaling of an FMU keep machine code.
It takes the sources from its callers: an FMU does not know the master.
"""

import hashlib
import importlib.metadata
import os
import shutil
import sys
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from adaptimp_fmu.files.cache_folder import cache_folder, writable_cache

COMPILERS = ("numba", "llvmlite")
UNUSED_DAYS = 30  # after which a folder is removed
_DAY = 86400.0  # s


def code_folder(sources: Iterable[Path]) -> Path | None:
    """Return a folder for the machine code of source files, in ``$ADAPTIMP_CACHE`` or the user's cache folder.

    Where nothing can be written there, the folder is in a temporary cache; see `adaptimp_fmu.files.cache_folder`.
    When a folder is made, folders that have not been used for `UNUSED_DAYS` are removed.

    Parameters
    ----------
    sources
        All files whose functions are compiled.

    Returns
    -------
    Path or None
        None if nothing can be written, or a source cannot be read. Then no machine code is kept.
    """
    try:
        name = _digest(sources)
        is_new = not (cache_folder() / "kernel" / name).exists()
        folder = writable_cache("kernel", name)
        os.utime(folder)  # it is in use
    except OSError:
        return None
    if is_new:
        _remove_unused(folder)
    return folder


def _digest(sources: Iterable[Path]) -> str:
    """Hash of sources and versions."""
    digest = hashlib.sha256(sys.version.encode())
    for compiler in COMPILERS:
        digest.update(f"{compiler} {importlib.metadata.version(compiler)}\n".encode())
    for path in sorted(sources):
        digest.update(path.name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:32]


def _remove_unused(folder: Path) -> None:
    """Remove the folders beside this one that no process has used for long."""
    oldest = time.time() - UNUSED_DAYS * _DAY
    for other in folder.parent.iterdir():
        with suppress(OSError):  # another process may remove it at the same time
            if other != folder and other.stat().st_mtime < oldest:
                shutil.rmtree(other)
