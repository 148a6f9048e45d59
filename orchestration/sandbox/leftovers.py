"""Counts and removes what a stranger's process has left in a folder, however deep, long-named or locked it is.

The functions of Python's library recurse, and give up on paths that are longer than the system takes.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from itertools import count, islice
from pathlib import Path

MOST_FILES = 10_000
"""How many files and folders are looked at."""


def files_in(folder: Path) -> Iterator[tuple[Path, int]]:
    """Yield at most `MOST_FILES` files below a folder with their sizes in bytes; links are not followed."""
    yield from islice(_walk(folder), MOST_FILES)


def empty(folder: Path) -> None:
    """Remove all that is in an existing folder.

    What is in a subfolder is moved up before the subfolder is removed, so that no path grows long.
    """
    numbers = count()
    _unlock(folder)
    while entries := _entries(folder):
        left = len(entries)
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                _unlock(entry.path)
                for inner in _entries(entry.path):
                    _move_or_remove(inner, folder / f"{next(numbers)}.moved")
            left -= _gone(entry)
        if left == len(entries) == len(_entries(folder)):
            return  # nothing can be removed: the system says why when the folder itself is


def _walk(folder: Path) -> Iterator[tuple[Path, int]]:
    """Yield files with their sizes, one folder after the other."""
    waiting = [str(folder)]
    while waiting:
        for entry in _entries(waiting.pop()):
            with suppress(OSError):
                if entry.is_dir(follow_symlinks=False):
                    waiting.append(entry.path)
                else:
                    yield Path(entry.path), entry.stat(follow_symlinks=False).st_size


def _entries(folder: Path | str) -> list["os.DirEntry[str]"]:
    """The first entries of a folder; none where it cannot be read."""
    try:
        with os.scandir(folder) as found:
            return list(islice(found, MOST_FILES))
    except OSError:
        return []


def _move_or_remove(entry: "os.DirEntry[str]", target: Path) -> None:
    """Remove a file; move a folder."""
    with suppress(OSError):
        if entry.is_dir(follow_symlinks=False):
            _unlock(entry.path)  # a folder that is locked cannot be moved
            Path(entry.path).rename(target)
        else:
            Path(entry.path).unlink()


def _gone(entry: "os.DirEntry[str]") -> bool:
    """Remove a file or an empty folder; returns whether that succeeded."""
    try:
        if entry.is_dir(follow_symlinks=False):
            Path(entry.path).rmdir()
        else:
            Path(entry.path).unlink()
    except OSError:
        return False
    return True


def _unlock(folder: Path | str) -> None:
    """Let the user read and change a folder."""
    with suppress(OSError):
        Path(folder).chmod(0o700)
