"""Locks on open files, which the operating system frees when their process ends, however it ends.

A lock says that a draft or a temporary folder has a living owner. Process numbers would not say so: they are used
again, and containers that share a folder count them apart.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows, where a file that is open cannot be removed anyway
    fcntl = None

_NEW = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
_PRESENT = os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


def locked_new_file(path: Path, mode: int = 0o666) -> int | None:
    """Create a file and lock it for this process; the lock lasts until the descriptor is closed.

    Parameters
    ----------
    path
        A path at which there is neither a file nor a link.
    mode
        Permissions of the file, as far as the mask of the process (umask) allows.

    Returns
    -------
    int or None
        Descriptor of the file; None if another process took the file for abandoned and removed it meanwhile.

    Raises
    ------
    FileExistsError
        If there is something at the path.
    OSError
        If the file cannot be made.
    """
    file = os.open(path, _NEW, mode)
    if _lock(file) is not False and os.fstat(file).st_nlink:
        return file
    os.close(file)
    return None


def lock_of_dead_owner(path: Path) -> int | None:
    """Lock a file that `locked_new_file` made in a process that has ended.

    Returns
    -------
    int or None
        Descriptor of the file; None if its owner lives, or belongs to another user, or the system cannot say.
    """
    with suppress(OSError):
        file = os.open(path, _PRESENT)
        status = os.fstat(file)
        if fcntl is not None and status.st_uid == os.getuid() and _lock(file) and status.st_nlink:
            return file
        os.close(file)
    return None


@contextmanager
def waiting_lock(path: Path) -> Iterator[None]:
    """Keep other processes out of what they do under the same lock; waits until none of them has the lock.

    Where the system has no locks, nobody is kept out.

    Parameters
    ----------
    path
        File that stands for the lock; it is made if need be, and stays.

    Raises
    ------
    OSError
        If the file cannot be made.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.locks import waiting_lock
    >>> with waiting_lock(Path("counter.lock")):
    ...     written = Path("counter").write_text("1")
    """
    file = os.open(path, _PRESENT | os.O_CREAT, 0o666)
    try:
        if fcntl is not None:
            with suppress(OSError):  # some network file systems have no locks
                fcntl.flock(file, fcntl.LOCK_EX)
        yield
    finally:
        os.close(file)


def _lock(file: int) -> bool | None:
    """Lock a file; False if another process has the lock, None if the system has no locks for it."""
    if fcntl is None:
        return None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # some network file systems have no locks
        return None
    return True
