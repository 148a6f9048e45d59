"""Says with which folders of the cache living processes work, so that nobody removes these folders meanwhile.

    users/lock               held while a list is written, and while folders are chosen that will be removed
    users/<random>.list      folders that one process works with, such as fmus/1f, a line each; locked while it lives

A process that has ended leaves its list, and the next process that begins one removes it.
"""

import os
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from adaptimp_fmu.files.locks import lock_of_dead_owner, locked_new_file, waiting_lock

FOLDER = "users"
_LOCK, _SUFFIX = "lock", ".list"
_RANDOM = 6  # bytes in the name of a list
_lists: dict[Path, int] = {}  # descriptor of this process's list in each cache
_noted: set[tuple[Path, str]] = set()  # what is in these lists
_threads = threading.Lock()


def use(cache: Path, *parts: str) -> None:
    """Note that this process works with a folder in a cache until the process ends.

    A folder is noted before anything in it is looked at: what is there then stays. Where nothing can be written to the
    cache, nothing is noted, since nothing can be removed there either.

    Parameters
    ----------
    cache
        Folder of caches.
    parts
        Names on the way from there to the folder, which may be missing.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.cache_use import undisturbed, use
    >>> use(Path("cache"), "fmus", "1f")
    >>> with undisturbed(Path("cache")) as used:
    ...     used
    {'fmus/1f'}
    """
    cache, folder = cache.absolute(), "/".join(parts)
    with _threads:
        if (cache, folder) in _noted:
            return
        with suppress(OSError), _locked(cache):
            if cache not in _lists:
                _lists[cache] = _new_list(cache)
            os.write(_lists[cache], f"{folder}\n".encode())
            _noted.add((cache, folder))


@contextmanager
def undisturbed(cache: Path) -> Iterator[set[str]]:
    """Keep other processes from beginning to work with more folders of a cache, for a moment.

    Yields
    ------
    set
        Folders with which living processes work, as paths from the cache on.

    Raises
    ------
    OSError
        If nothing can be written to the cache.
    """
    with _locked(cache):
        yield _in_use(cache)


@contextmanager
def _locked(cache: Path) -> Iterator[None]:
    folder = cache / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    with waiting_lock(folder / _LOCK):
        yield


def _new_list(cache: Path) -> int:
    """Descriptor of a new list; lists of processes that have ended are removed."""
    _in_use(cache)
    while True:
        descriptor = locked_new_file(cache / FOLDER / f"{secrets.token_hex(_RANDOM)}{_SUFFIX}", 0o600)
        if descriptor is not None:
            return descriptor


def _in_use(cache: Path) -> set[str]:
    """Folders in the lists of living processes; other lists are removed."""
    found: set[str] = set()
    for path in (cache / FOLDER).glob(f"*{_SUFFIX}"):
        if not _removed(path):
            with suppress(OSError):
                found |= set(path.read_text(encoding="utf-8").splitlines())
    return found


def _removed(path: Path) -> bool:
    """Remove a list if its process has ended; returns whether it had."""
    if os.name == "nt":  # there the list of a living process cannot be removed
        with suppress(OSError):
            path.unlink()
        return not path.exists()
    descriptor = lock_of_dead_owner(path)
    if descriptor is None:
        return False
    path.unlink(missing_ok=True)
    os.close(descriptor)
    return True
