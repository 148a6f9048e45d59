"""The folder of caches, and a temporary one in its place where nothing can be written.

The module imports nothing of this package, because compiled code depends on it. `adaptimp_fmu.cache_folder` does
the same for FMUs; both share the environment variable, so that a process and its children warn once.
"""

import os
import stat
import sys
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


def let_matplotlib_write() -> None:
    """Give matplotlib a folder in the cache if it cannot write to its own; call this before matplotlib is imported.

    Otherwise matplotlib makes a temporary folder in each process, and says so in the middle of the output.
    """
    if "matplotlib" in sys.modules or "MPLCONFIGDIR" in os.environ:
        return
    try:
        for variable, default in (("XDG_CONFIG_HOME", ".config"), ("XDG_CACHE_HOME", ".cache")):
            _written_to(Path(os.environ.get(variable) or Path.home() / default) / "matplotlib")
    except (OSError, RuntimeError):  # without a home there is no such folder either
        os.environ["MPLCONFIGDIR"] = str(writable_cache("matplotlib"))
