"""What is kept in the folder of caches: how much of each kind, and its removal while other processes run.

Only what has a name as this project gives it, and belongs to this user, counts as a content of the cache. So nothing
else is touched, even if ``$ADAPTIMP_CACHE`` names a folder in which other files are.
"""

import os
import re
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from adaptimp_fmu.files.cache_folder import TAG, TAG_TEXT, cache_folder, temporary_cache
from adaptimp_fmu.files.cache_use import undisturbed
from adaptimp_fmu.files.temporary_folder import temporary_folder

_HASH = r"[0-9a-f]{32}"


@dataclass(frozen=True)
class Kind:
    """A kind of content, which has a folder of its own in the cache.

    Attributes
    ----------
    name
        Name of the folder.
    holds
        What is in there, for a user.
    entries
        Pattern of the names of its entries. Empty if the folder is one entry as a whole.
    mark
        Name and beginning of a file that says that the folder is this project's, if it is one entry.
    lasting
        Whether it took so long to make that only a user who names it removes it.
    """

    name: str
    holds: str
    entries: str = _HASH
    mark: tuple[str, bytes] = ("", b"")
    lasting: bool = False


_TAGGED = (TAG, TAG_TEXT)
KINDS = {
    kind.name: kind
    for kind in (
        Kind("kernel", "machine code of the master's loops"),
        Kind("binaries", "compiled libraries of FMUs and programs"),
        Kind("fmus", "FMUs of the scenarios and of models without a folder"),
        Kind("ssp", "unpacked SSP packages"),
        Kind("native", "native libraries of campaigns"),
        Kind("claims", "measured claims of the paper", rf"{_HASH}\.json"),
        Kind(
            "robustness",
            "measured settings of the robustness study",
            "",
            ("store.json", b'{"adaptimp": "store of runs"'),
            lasting=True,
        ),
        Kind("zig", "the compiler's own cache, if it cannot use its own place", "", _TAGGED),
        Kind("matplotlib", "matplotlib's files, if it cannot use its own place", "", _TAGGED),
    )
}
"""All kinds by name."""


@dataclass(frozen=True)
class Amount:
    """How much of a kind there is, or was removed.

    Attributes
    ----------
    files
        Number of files.
    size
        Their sizes together, bytes.
    used
        Number of entries with which other processes work. They are not removed.
    """

    files: int = 0
    size: int = 0
    used: int = 0


def places() -> list[Path]:
    """Return the folder of caches, and the temporary one that stands in for it, as far as they are there.

    Examples
    --------
    >>> from adaptimp_fmu.files.cache_contents import places
    >>> all(place.is_dir() for place in places())
    True
    """
    found = [cache_folder(), temporary_cache()]
    return [place for place in dict.fromkeys(found) if place is not None and place.is_dir()]


def amount(cache: Path, kind: Kind) -> Amount:
    """Return how much of a kind a cache holds.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.cache_contents import KINDS, amount
    >>> Path("cache/claims").mkdir(parents=True)
    >>> Path("cache/claims/0123456789abcdef0123456789abcdef.json").write_bytes(b"[]")
    2
    >>> amount(Path("cache"), KINDS["claims"])
    Amount(files=1, size=2, used=0)
    """
    return _measured(_entries(cache, kind))


def clear(cache: Path, kind: Kind) -> Amount:
    """Remove what a cache holds of a kind, but for that with which living processes work.

    Returns
    -------
    Amount
        What was removed.

    Raises
    ------
    OSError
        If nothing can be written to the cache.

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu.files.cache_contents import KINDS, clear
    >>> cache = Path("cleared").absolute()
    >>> (cache / "claims").mkdir(parents=True)
    >>> for name in ("0123456789abcdef0123456789abcdef.json", "letter.txt"):
    ...     written = (cache / "claims" / name).write_bytes(b"[]")
    >>> clear(cache, KINDS["claims"])
    Amount(files=1, size=2, used=0)
    >>> [path.name for path in (cache / "claims").iterdir()]
    ['letter.txt']
    """
    cache = cache.absolute()
    entries = list(_entries(cache, kind))
    if not entries:
        return Amount()
    used = 0
    with temporary_folder(entries[0].parent) as scratch:
        with undisturbed(cache) as busy:
            for entry in entries:
                try:
                    if entry.relative_to(cache).as_posix() in busy:
                        used += 1
                    else:
                        entry.rename(scratch / entry.name)
                except FileNotFoundError:  # another process was faster
                    continue
                except OSError:  # a library that is loaded cannot be moved on Windows
                    used += 1
        freed = _measured(scratch.iterdir())
    return Amount(freed.files, freed.size, used)


def _entries(cache: Path, kind: Kind) -> Iterator[Path]:
    """Contents of a kind."""
    folder = cache / kind.name
    if not kind.entries:
        if _is_own(folder, stat.S_ISDIR) and _is_marked(folder, *kind.mark):
            yield folder
        return
    form = stat.S_ISREG if kind.entries != _HASH else stat.S_ISDIR
    with suppress(OSError):
        for entry in sorted(folder.iterdir()):
            if re.fullmatch(kind.entries, entry.name) and _is_own(entry, form):
                yield entry


def _is_own(path: Path, form: Callable[[int], bool]) -> bool:
    """Whether something is a file or a folder, no link, and belongs to this user."""
    try:
        status = path.lstat()
    except OSError:
        return False
    return form(status.st_mode) and (not hasattr(os, "getuid") or status.st_uid == os.getuid())


def _is_marked(folder: Path, name: str, beginning: bytes) -> bool:
    try:
        return (folder / name).read_bytes().startswith(beginning)
    except OSError:
        return False


def _measured(entries: Iterable[Path]) -> Amount:
    """Number and sizes of the files in some entries."""
    files = size = 0
    for entry in entries:
        for path in (entry, *entry.rglob("*")):
            with suppress(OSError):  # another process may remove it at the same time
                status = path.lstat()
                if not stat.S_ISDIR(status.st_mode):
                    files, size = files + 1, size + status.st_size
    return Amount(files, size)
