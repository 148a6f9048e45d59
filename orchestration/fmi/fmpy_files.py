"""Files in fmpy's package folder that this package uses: the schemas of FMI, and the library that formats messages.

The folder is found without importing fmpy, which takes half a second.
"""

from importlib.util import find_spec
from pathlib import Path

from orchestration.errors import ArchiveError


def fmpy_file(*parts: str) -> Path:
    """Path of a file below fmpy's package folder; the file need not exist.

    Raises
    ------
    ArchiveError
        If fmpy is not installed.
    """
    found = find_spec("fmpy")
    if found is None or found.origin is None:
        msg = "The package fmpy, which holds the schemas of FMI, is not installed; install it: pip install fmpy."
        raise ArchiveError(msg)
    return Path(found.origin).parent.joinpath(*parts)
