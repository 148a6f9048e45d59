"""Numba compilation with a disk cache that cannot be stale.

Numba names a cache file by the last part of the module's name and checks the time of that one file. It would restore
code compiled under another import name (``reference.arm``, ``tests.reference.arm``), which fails, and code whose callee
in another file has changed since, which is wrong. So the name of the cache file gets a stamp of both.
"""

import hashlib
from pathlib import Path

from numba import njit

SOURCES = ("arm.py", "segment.py", "controllers.py", "monolithic.py")


def compiled(function):
    """Compile a function in nopython mode; its machine code is cached until a source file here changes."""
    function.__qualname__ = f"{function.__name__}_{STAMP}"
    return njit(cache=True)(function)


def stamp():
    """Eight hex digits of the package's name and sources."""
    digest = hashlib.sha256(__name__.encode())
    for name in SOURCES:
        digest.update(Path(__file__).with_name(name).read_bytes())
    return digest.hexdigest()[:8]


STAMP = stamp()
