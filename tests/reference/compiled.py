"""Compilation with numba, with a cache on disk that cannot be stale.

Numba names a cache file by the last part of the name of the module, and checks the time of that one source file. So
numba would restore code that was compiled under another import name (``reference.arm``, ``tests.reference.arm``), which
fails. Numba would also restore code whose callee in another file has changed since, which is wrong. So the name of the
cache file gets a stamp of the import name and of all sources.
"""

import hashlib
from pathlib import Path

from numba import njit

SOURCES = ("arm.py", "segment.py", "controllers.py", "monolithic.py")


def compiled(function):
    """Compile a function to machine code, which is cached until a source file of the reference changes."""
    function.__qualname__ = f"{function.__name__}_{STAMP}"
    return njit(cache=True)(function)


def stamp():
    """Return eight hexadecimal digits that change with the name of the package and with its sources."""
    digest = hashlib.sha256(__name__.encode())
    for name in SOURCES:
        digest.update(Path(__file__).with_name(name).read_bytes())
    return digest.hexdigest()[:8]


STAMP = stamp()
