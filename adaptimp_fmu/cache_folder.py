"""The folder of built FMUs and binaries, and a temporary one in its place where nothing can be written.

`orchestration.sandbox.cache_folder` does the same for the caches of runs; neither package may import the other here.
Both share the environment variable, so that a process and its children warn once.
"""

import os
import stat
import tempfile
import warnings
from pathlib import Path

import platformdirs

VARIABLE = "ADAPTIMP_CACHE"


class TemporaryCacheWarning(UserWarning):
    """Warning that a temporary folder stands in for the folder of caches."""


def cache_folder() -> Path:
    """Return ``$ADAPTIMP_CACHE``, or else the user's cache folder; the folder may be missing."""
    return Path(os.environ.get(VARIABLE) or platformdirs.user_cache_path("adaptimp")).absolute()


def writable_cache(*parts: str) -> Path:
    """Return an existing folder in the cache to which files can be written.

    Where that is impossible, the folder is in a temporary cache of the user. Then ``$ADAPTIMP_CACHE`` names the
    temporary cache from then on, and a warning says so.

    Raises
    ------
    OSError
        If nothing can be written to the folder for temporary files either.
    """
    folder = cache_folder()
    try:
        return _written_to(folder.joinpath(*parts))
    except OSError as error:
        temporary = _temporary()
        if temporary == folder:
            raise
        os.environ[VARIABLE] = str(temporary)
        msg = (
            f"Nothing can be written to the cache {folder}: {error.strerror}. This process uses {temporary};"
            f" set {VARIABLE} to a folder that can be written to."
        )
        warnings.warn(msg, TemporaryCacheWarning, stacklevel=2)
        return _written_to(temporary.joinpath(*parts))


def _written_to(folder: Path) -> Path:
    """The folder, after a file was written to it."""
    folder.mkdir(parents=True, exist_ok=True)
    tempfile.TemporaryFile(dir=folder).close()
    return folder


def _temporary() -> Path:
    """Folder below that for temporary files, which no other user can write to: machine code is run from it."""
    user = os.getuid() if hasattr(os, "getuid") else "cache"
    folder = Path(tempfile.gettempdir()) / f"adaptimp-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
    except OSError:
        return Path(tempfile.mkdtemp(prefix="adaptimp-"))
    own = stat.S_ISDIR(status.st_mode) and status.st_uid == user and not status.st_mode & 0o022
    return folder if own or user == "cache" else Path(tempfile.mkdtemp(prefix="adaptimp-"))
