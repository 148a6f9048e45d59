"""The folder of caches, and a temporary one in its place where nothing can be written, or another user wrote.

The environment variable names the temporary one from then on, so that a process and its children warn once.
"""

import errno
import os
import stat
import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

import platformdirs

from adaptimp_fmu.files.temporary_folder import folder_until_exit

VARIABLE = "ADAPTIMP_CACHE"
TAG = "CACHEDIR.TAG"
"""Name of the file that marks a folder as a cache, by which programs for backups know it (bford.info/cachedir)."""
TAG_TEXT = b"Signature: 8a477f597d28d172789f06886806bc55\n# This folder was made by adaptimp.\n"


class TemporaryCacheWarning(UserWarning):
    """Warning that a temporary folder stands in for the folder of caches."""


def cache_folder() -> Path:
    """Return ``$ADAPTIMP_CACHE``, or else the user's cache folder; the folder may be missing."""
    return Path(os.environ.get(VARIABLE) or platformdirs.user_cache_path("adaptimp")).absolute()


def writable_cache(*parts: str) -> Path:
    """Return an existing folder in the cache to which files can be written.

    Where that is impossible, or the cache belongs to another user, the folder is in a temporary cache of the user.
    Then ``$ADAPTIMP_CACHE`` names the temporary cache from then on, and a warning says so.

    Raises
    ------
    OSError
        If nothing can be written to the folder for temporary files either.
    """
    folder = cache_folder()
    try:
        made = _written_to(folder.joinpath(*parts))
        for trusted in (folder, made):
            _require_trust(trusted)
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
    return made


def tagged_cache(name: str) -> Path:
    """Return a folder in the cache for the files of another program; errors and warnings as of `writable_cache`.

    A folder that is new is marked, so that it can be told from one that the other program has made.
    """
    folder = writable_cache(name)
    with suppress(OSError):  # the mark matters only to who clears the cache
        if not any(folder.iterdir()):
            (folder / TAG).write_bytes(TAG_TEXT)
    return folder


def is_trusted(path: Path) -> bool:
    """Return whether a file or folder is there and belongs to this user or to the administrator.

    Machine code is run from the cache, so whatever another user has put there counts as missing.
    """
    try:
        status = path.lstat()
    except OSError:
        return False
    return not hasattr(os, "getuid") or status.st_uid in (0, os.getuid())


def _require_trust(folder: Path) -> None:
    """Refuse a folder of another user."""
    if not is_trusted(folder.resolve()):
        raise PermissionError(errno.EPERM, "It belongs to another user")


def _written_to(folder: Path) -> Path:
    """The folder, after a file was written to it."""
    folder.mkdir(parents=True, exist_ok=True)
    tempfile.TemporaryFile(dir=folder).close()
    return folder


def _temporary() -> Path:
    """Folder below that for temporary files, which no other user can write to: machine code is run from it."""
    try:
        _stand_in().mkdir(mode=0o700, exist_ok=True)
    except OSError:
        return folder_until_exit()
    return temporary_cache() or folder_until_exit()


def temporary_cache() -> Path | None:
    """Return the temporary cache of this user; None if it is not there, or another user could write to it.

    Examples
    --------
    >>> from adaptimp_fmu.files.cache_folder import temporary_cache
    >>> folder = temporary_cache()
    >>> folder is None or folder.name.startswith("adaptimp-")
    True
    """
    folder = _stand_in()
    try:
        status = folder.lstat()
    except OSError:
        return None
    if not hasattr(os, "getuid"):
        return folder
    own = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid() and not status.st_mode & 0o022
    return folder if own else None


def _stand_in() -> Path:
    """Where the temporary cache of this user is, if there is one."""
    user = os.getuid() if hasattr(os, "getuid") else "cache"
    return Path(tempfile.gettempdir()) / f"adaptimp-{user}"


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
        os.environ["MPLCONFIGDIR"] = str(tagged_cache("matplotlib"))
