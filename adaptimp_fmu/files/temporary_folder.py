"""Temporary folders that do not outlive their process for long, however the process ends.

Beside a folder ``adaptimp-<random>`` stands a file of the same name with the suffix ``.lock``, which its process keeps
locked. The first temporary folder of the next process sweeps: it removes the folders whose locks are free.
"""

import atexit
import os
import secrets
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from adaptimp_fmu.files.locks import lock_of_dead_owner, locked_new_file

PREFIX, LOCK = "adaptimp-", ".lock"
_RANDOM = 6  # bytes in the name of a folder
_swept: set[Path] = set()  # places in which this process has looked for folders of dead processes
_present: dict[Path, tuple[int, int]] = {}  # folders, with the descriptors of their locks and their processes


@contextmanager
def temporary_folder(place: Path | None = None) -> Iterator[Path]:
    """Make a temporary folder that is removed at the end of the context.

    What processes that have ended left in the same place is removed first, once for each process.

    Parameters
    ----------
    place
        Folder for the temporary one. Default: that of the system, which the environment variable TMPDIR chooses.

    Yields
    ------
    Path
        Absolute path of a new folder, which no other user can read or write.

    Raises
    ------
    OSError
        If the folder cannot be made.

    Examples
    --------
    >>> from adaptimp_fmu.files.temporary_folder import temporary_folder
    >>> with temporary_folder() as folder:
    ...     written = (folder / "x.txt").write_text("for a moment")
    >>> folder.exists()
    False
    """
    folder = _claimed(Path(place or tempfile.gettempdir()).absolute())
    try:
        yield folder
    finally:
        _remove(folder)


def folder_until_exit() -> Path:
    """Make a temporary folder that is removed when this process ends; errors as of `temporary_folder`."""
    folder = _claimed(Path(tempfile.gettempdir()).absolute())
    atexit.register(_remove, folder)
    return folder


def sweep(place: Path) -> None:
    """Remove the temporary folders in a place whose processes have ended.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.temporary_folder import sweep
    >>> Path("adaptimp-0123456789ab").mkdir()
    >>> Path("adaptimp-0123456789ab.lock").touch()  # of a process that was killed: nobody has the lock
    >>> sweep(Path())
    >>> list(Path().glob("adaptimp-*"))
    []
    """
    with os.scandir(place) as entries:
        locks = [Path(e.path) for e in entries if e.name.startswith(PREFIX) and e.name.endswith(LOCK)]
    for lock in locks:
        descriptor = lock_of_dead_owner(lock)
        if descriptor is not None:
            _remove_claim(lock.with_suffix(""), descriptor)


def remove_all() -> None:
    """Remove all temporary folders of this process, which is about to end without leaving their contexts."""
    for folder in list(_present):
        _remove(folder)


def runs_nothing(folder: Path) -> bool:
    """Return whether the file system of a folder is mounted so that no program in it can be run (noexec)."""
    if not hasattr(os, "statvfs"):
        return False
    with suppress(OSError):
        return bool(os.statvfs(folder).f_flag & os.ST_NOEXEC)
    return False


def _claimed(place: Path) -> Path:
    """A new folder with a lock beside it, in a place that this process has swept."""
    if place not in _swept:
        _swept.add(place)
        sweep(place)
    while True:
        folder = place / f"{PREFIX}{secrets.token_hex(_RANDOM)}"
        with suppress(FileExistsError):
            descriptor = locked_new_file(folder.with_suffix(LOCK), 0o600)
            if descriptor is None:
                continue
            _present[folder] = descriptor, os.getpid()
            try:
                folder.mkdir(0o700)
                if folder.stat().st_mode & 0o700 != 0o700:  # by the mask of the process
                    folder.chmod(0o700)
            except BaseException:
                _remove(folder)
                raise
            return folder


def _remove(folder: Path) -> None:
    """Remove a folder, if this process has made it, and not the one that this process was forked from."""
    descriptor, owner = _present.pop(folder, (0, 0))
    if owner == os.getpid():
        _remove_claim(folder, descriptor)


def _remove_claim(folder: Path, descriptor: int) -> None:
    """Remove a folder and its lock, and free the lock; what cannot be removed now is left to the next process."""
    try:
        if not _gone(folder):
            for parent, _, _ in os.walk(folder):
                Path(parent).chmod(0o700)  # an archive may have folders that nobody may write to
        if _gone(folder):
            folder.with_suffix(LOCK).unlink(missing_ok=True)
    except OSError:  # a library in it is still loaded, say
        return
    finally:
        os.close(descriptor)


def _gone(folder: Path) -> bool:
    """Remove a folder; returns whether it is gone."""
    shutil.rmtree(folder, ignore_errors=True)
    return not os.path.lexists(folder)
