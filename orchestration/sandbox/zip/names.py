"""Rules for the names of an archive's entries, so that they mean one file each, inside of the folder.

What leads outside of the folder on any platform is refused on each of them. A name that Windows only cannot have is
refused there; elsewhere it breaks a rule of form, since many archives are made and used on other systems only.
"""

import re
import stat
import sys
import unicodedata
from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath

from orchestration.sandbox.zip.data import DEFLATED, STORED
from orchestration.sandbox.zip.directory import Entry
from orchestration.sandbox.zip.rules import (
    MAX_DEPTH,
    MAX_NAME,
    MAX_PATH,
    MAX_RATIO,
    RATIO_FREE_BYTES,
    RuleError,
    shown,
)

READ_BY_PEOPLE = ("documentation/", "sources/")
_FORBIDDEN = set("\\:")  # they separate folders and drives on Windows
_NOT_ON_WINDOWS = set('*?"<>|')
_ON_WINDOWS = sys.platform == "win32"
_UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")  # categories of controls, marks of direction, halves of characters, line ends
_RESERVED = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|com[0-9¹²³]|lpt[0-9¹²³])", re.IGNORECASE)
_ENCRYPTED, _PATCH, _STRONG, _MASKED = 0x1, 0x20, 0x40, 0x2000  # flags


def require_safe(entries: Sequence[Entry]) -> list[str]:
    """Refuse entries that cannot be unpacked safely.

    Returns
    -------
    list of str
        A sentence for each rule of form that is broken, and that makes the archive no less safe.

    Raises
    ------
    RuleError
        Naming the entry and the rule.
    """
    formalities = []
    for entry in entries:
        fault, on_windows = _fault_of_name(entry.name) or _fault(entry), _fault_on_windows(entry.name)
        if fault or (on_windows and _ON_WINDOWS):
            msg = f"entry {shown(entry.name)} {fault or on_windows}"
            raise RuleError(msg)
        if on_windows:
            formalities.append(f"The archive cannot be unpacked on Windows: entry {shown(entry.name)} {on_windows}.")
    return [*formalities, *_collisions(entries)]


def names_a_device(name: str) -> bool:
    """Whether the name of a file stands for a device on Windows, as ``con`` and ``NUL.txt`` do."""
    return _RESERVED.fullmatch(name.partition(".")[0].rstrip(" ")) is not None


def _fault_of_name(name: str) -> str | None:
    """Predicate of a sentence on the fault of a name; None if the name is safe."""
    wrong = next((c for c in name if c in _FORBIDDEN or unicodedata.category(c) in _UNSEEN), None)
    if not name or wrong is not None:
        what = f", {wrong!a}" if wrong is not None else ", because it has no name"
        return f"has a character that a path in an archive must not have{what}"
    parts = PurePosixPath(name).parts
    if name.startswith("/") or ".." in parts or (not parts and not name.endswith("/")):
        return "leads outside the archive"
    if len(name.encode()) > MAX_PATH:
        return f"has a path of {len(name.encode())} bytes, more than {MAX_PATH}"
    if len(parts) > MAX_DEPTH:
        return f"lies {len(parts)} folders deep, more than {MAX_DEPTH}"
    for part in parts:
        if len(part.encode()) > MAX_NAME:
            return f"has a name of {len(part.encode())} bytes, more than {MAX_NAME}"
    return None


def _fault_on_windows(name: str) -> str | None:
    """Predicate of a sentence on what Windows does not take in a name; None if it takes the name."""
    wrong = next((c for c in name if c in _NOT_ON_WINDOWS), None)
    if wrong is not None:
        return f"has the character {wrong!a}"
    for part in PurePosixPath(name).parts:
        if part.endswith((".", " ")):
            return "ends in a dot or a space, which Windows takes away"
        if names_a_device(part):
            return f"has the name {shown(part)}, which is a device there"
    return None


def _fault(entry: Entry) -> str | None:
    """Predicate of a sentence on the fault of an entry other than its name; None if there is none."""
    if stat.S_IFMT(entry.mode) not in (0, stat.S_IFREG, stat.S_IFDIR):
        return "is a link or device"
    if entry.is_folder and entry.size:
        return f"is a folder, but has {entry.size} bytes"
    if entry.flags & (_ENCRYPTED | _STRONG | _MASKED):
        return "is encrypted"
    if entry.flags & _PATCH:
        return "is a patch of another file"
    if entry.method not in (STORED, DEFLATED):
        return f"uses compression method {entry.method}; only store and deflate are allowed"
    if entry.method == STORED and entry.packed != entry.size:
        return f"is stored without compression, but has {entry.packed} bytes for {entry.size}"
    if entry.size > RATIO_FREE_BYTES and entry.size > MAX_RATIO * entry.packed:
        return f"unpacks from {entry.packed} to {entry.size} bytes, a zip bomb"
    return None


def _collisions(entries: Sequence[Entry]) -> Iterator[str]:
    """Iterate over sentences on harmless pairs of one name, and refuse all others."""
    seen: dict[str, Entry] = {}
    for entry in entries:
        other = seen.setdefault(_key(entry.name), entry)
        if other is entry:
            continue
        if not _harmless(entry, other):
            raise _twice(entry, other)
        yield f"The archive has the entries {shown(other.name)} and {shown(entry.name)}."
    for key, entry in seen.items():
        for parent in _parents(key):
            other = seen.get(parent)
            if other is not None and not other.is_folder:
                msg = f"entry {shown(entry.name)} lies in {shown(other.name)}, which is a file"
                raise RuleError(msg)


def _twice(entry: Entry, other: Entry) -> RuleError:
    also = "" if other.name == entry.name else f", also as {shown(other.name)}"
    return RuleError(f"entry {shown(entry.name)} occurs more than once{also}")


def _parents(key: str) -> Iterator[str]:
    """Iterate over the folders above a path."""
    place = key.rfind("/")
    while place > 0:
        yield key[:place]
        place = key.rfind("/", 0, place)


def _key(name: str) -> str:
    """What all names of one file have in common: ./a, a// and A are one file, on some systems."""
    path = str(PurePosixPath(name))
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", path).casefold())


def _harmless(entry: Entry, other: Entry) -> bool:
    """Whether two entries with one name cannot stand for two contents: folders, or pages whose names differ in case."""
    if entry.is_folder and other.is_folder:
        return True
    if entry.is_folder or other.is_folder:
        return False
    names = [str(PurePosixPath(e.name)) for e in (entry, other)]
    return names[0] != names[1] and all(name.startswith(READ_BY_PEOPLE) for name in names)
