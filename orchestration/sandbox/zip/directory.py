"""Reads the directory of a zip archive, which says what each entry is and where it lies.

The layout is that of APPNOTE 6.3.10 (PKWARE, 2022), sections 4.3.12 and 4.4. A directory that
contradicts itself is refused, because another program could take the archive for another one.
"""

import stat
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO

from orchestration.sandbox.zip.ends import read_ending
from orchestration.sandbox.zip.fields import FULL_16, decoded_name, extra_fields, shown_raw, sizes_64, unreadable
from orchestration.sandbox.zip.rules import MAX_DIRECTORY, MAX_ENTRIES, RuleError

RECORD = b"PK\x01\x02"
_RECORD = struct.Struct("<4s2B5H3L5H2L")
_WINDOWS, _REPARSE_POINT = (0, 10, 11, 14), 0x400  # systems that made an entry, and their mark of a link
_NEWEST = 63  # version of the format, in tenths


@dataclass(frozen=True)
class Entry:
    """What the directory of an archive says of an entry.

    Attributes
    ----------
    name
        Name with ``/`` between folders.
    raw
        Bytes of the name as they are stored.
    flags, method, crc
        General purpose flags, compression method, and CRC-32 of the contents.
    packed, size
        Bytes in the archive and after unpacking.
    mode
        File type and permissions of Unix; 0 if the archive has none.
    offset
        Place of the local header in the file.
    """

    name: str
    raw: bytes
    flags: int
    method: int
    crc: int
    packed: int
    size: int
    mode: int
    offset: int

    @property
    def is_folder(self) -> bool:
        """Whether the entry stands for a folder."""
        return self.name.endswith("/") or stat.S_ISDIR(self.mode)


@dataclass(frozen=True)
class Directory:
    """The entries of an archive, and the places at which the directory and the records after it begin and end."""

    entries: tuple[Entry, ...]
    regions: tuple[tuple[int, int], ...]

    @property
    def start(self) -> int:
        """Place at which the directory begins."""
        return self.regions[0][0]


def read_directory(file: IO[bytes]) -> Directory:
    """Read the directory of an open archive.

    Raises
    ------
    RuleError
        If there is none, if it contradicts itself, or if it has too many entries.
    """
    ending = read_ending(file)
    count, size, start = ending.count, ending.size, ending.start
    if count > MAX_ENTRIES:
        msg = f"has {count} entries, more than {MAX_ENTRIES}"
        raise RuleError(msg)
    if size > MAX_DIRECTORY:
        msg = f"has a directory of {size} bytes, more than {MAX_DIRECTORY}"
        raise RuleError(msg)
    if start + size > ending.place:
        msg = f"its directory of {size} bytes at {start} does not end before {ending.place}"
        raise unreadable(msg)
    file.seek(start)
    data = file.read(size)
    entries = tuple(_records(data, count))
    return Directory(entries, ((start, start + size), *ending.regions))


def _records(data: bytes, count: int) -> Iterator[Entry]:
    """Read all records of a directory, which must fill it."""
    place = 0
    for number in range(1, count + 1):
        if data[place : place + 4] != RECORD or len(data) - place < _RECORD.size:
            msg = f"its directory has no entry {number} of {count}"
            raise unreadable(msg)
        fields = _RECORD.unpack_from(data, place)
        lengths = fields[11:14]
        end = place + _RECORD.size + sum(lengths)
        if end > len(data):
            msg = f"entry {number} of its directory is cut off"
            raise unreadable(msg)
        place += _RECORD.size
        raw, extra = data[place : place + lengths[0]], data[place + lengths[0] : place + lengths[0] + lengths[1]]
        yield _entry(fields, raw, extra)
        place = end
    if place != len(data):
        msg = f"its directory has {len(data) - place} bytes after the {count} entries that it announces"
        raise unreadable(msg)


def _entry(fields: tuple[int, ...], raw: bytes, extra: bytes) -> Entry:
    """Put the fields of a record together."""
    _, _, system, needed, flags, method, _, _, crc, packed, size, *_, disk, _, attributes, offset = fields
    extras = extra_fields(raw, extra)
    if needed & 0xFF > _NEWEST:
        msg = f"entry {shown_raw(raw)} needs version {(needed & 0xFF) / 10} of the format"
        raise unreadable(msg)
    if disk not in (0, FULL_16):
        msg = f"entry {shown_raw(raw)} lies in another file"
        raise unreadable(msg)
    size, packed, offset = sizes_64(raw, extras, (size, packed, offset))
    mode = attributes >> 16
    if system in _WINDOWS and attributes & _REPARSE_POINT:
        mode = stat.S_IFLNK
    return Entry(decoded_name(raw, flags, extras), raw, flags, method, crc, packed, size, mode, offset)
