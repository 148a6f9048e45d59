"""Compares the places of an archive's entries with its directory: headers, overlaps, and what lies between them.

The directory stands at the end of an archive, but each entry has a header of its own. A program that reads an archive
from its beginning trusts the headers, so both must agree. The bytes between entries may hold anything but a second
archive.
"""

import struct
from collections.abc import Iterator
from itertools import pairwise
from typing import IO

from orchestration.sandbox.zip.directory import RECORD, Directory, Entry
from orchestration.sandbox.zip.ends import END
from orchestration.sandbox.zip.fields import extra_fields, shown_raw, sizes_64
from orchestration.sandbox.zip.rules import RuleError, shown

HEADER = b"PK\x03\x04"
_HEADER = struct.Struct("<4s5H3L2H")
_ENCRYPTED, _SIZES_FOLLOW, _MASKED = 0x1, 0x8, 0x2000
_CHUNK = 1024**2


def places_of_data(file: IO[bytes], directory: Directory) -> tuple[int, ...]:
    """Return where the packed data of each entry begin.

    Raises
    ------
    RuleError
        If a header contradicts the directory, if entries overlap, or if bytes outside of entries can hold an archive.
    """
    places, regions = [], list(directory.regions)
    for entry in directory.entries:
        place = _place(file, entry, directory.start)
        places.append(place)
        regions.append((entry.offset, place + entry.packed))
    _require_apart(directory, places)
    for start, end in _gaps(file, sorted(regions)):
        _require_harmless(file, start, end)
    return tuple(places)


def _place(file: IO[bytes], entry: Entry, end: int) -> int:
    """Where the data of an entry begin, after its header was compared with the directory."""
    name = shown(entry.name)
    if entry.offset + _HEADER.size > end:
        msg = f"has no place for entry {name}, whose header would lie at {entry.offset}"
        raise RuleError(msg)
    file.seek(entry.offset)
    fields = _HEADER.unpack(file.read(_HEADER.size))
    signature, _, flags, method, _, _, crc, packed, size, length, more = fields
    if signature != HEADER:
        msg = f"has no header of entry {name} at {entry.offset}; it is damaged, so build or copy it again"
        raise RuleError(msg)
    raw = file.read(length)
    extras = extra_fields(entry.raw, file.read(more))
    size, packed = sizes_64(entry.raw, extras, (size, packed))
    pairs = {
        "name": (raw, entry.raw),
        "compression method": (method, entry.method),
        "encryption": (flags & (_ENCRYPTED | _MASKED), entry.flags & (_ENCRYPTED | _MASKED)),
    }
    late = flags & _SIZES_FOLLOW and (crc, packed, size) == (0, 0, 0)
    if not late:
        pairs |= {"CRC": (crc, entry.crc), "packed size": (packed, entry.packed), "size": (size, entry.size)}
    for what, (here, there) in pairs.items():
        if here != there:
            said = [shown_raw(value) if isinstance(value, bytes) else value for value in (here, there)]
            msg = f"gives entry {name} two values for its {what}: {said[0]} and {said[1]}"
            raise RuleError(msg)
    place = entry.offset + _HEADER.size + length + more
    if place + entry.packed > end:
        msg = f"has {end - place} bytes for the {entry.packed} packed bytes of entry {name}"
        raise RuleError(msg)
    return place


def _require_apart(directory: Directory, places: list[int]) -> None:
    """Require that no two entries share bytes."""
    rows = sorted(
        (entry.offset, place + entry.packed, entry.name) for entry, place in zip(directory.entries, places, strict=True)
    )
    for (_, end, name), (start, _, other) in pairwise(rows):
        if start < end:
            msg = f"has entries that overlap, {shown(name)} and {shown(other)}"
            raise RuleError(msg)


def _gaps(file: IO[bytes], regions: list[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Iterate over the stretches of a file that belong to no entry and to no record of the directory."""
    place = 0
    for start, end in regions:
        if start > place:
            yield place, start
        place = max(place, end)
    file.seek(0, 2)
    length = file.tell()
    if length > place:
        yield place, length


def _require_harmless(file: IO[bytes], start: int, end: int) -> None:
    """Require that a stretch of a file holds no part of an archive."""
    file.seek(start)
    last = b""
    while start < end:
        block = file.read(min(_CHUNK, end - start))
        if not block:
            return
        start += len(block)
        for signature in (HEADER, RECORD, END):
            if signature in last + block:
                msg = f"hides parts of another archive between its entries, before byte {start}"
                raise RuleError(msg)
        last = block[-3:]
