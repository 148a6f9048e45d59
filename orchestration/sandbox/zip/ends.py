"""Finds the directory of a zip archive from the records at the end of the file.

The layout is that of APPNOTE 6.3.10 (PKWARE, 2022), sections 4.3.14 to 4.3.16.
"""

import struct
from dataclasses import dataclass
from typing import IO

from orchestration.sandbox.zip.fields import FULL_16, FULL_32, unreadable

END, END_64, LOCATOR_64 = b"PK\x05\x06", b"PK\x06\x06", b"PK\x06\x07"
_END = struct.Struct("<4s4H2LH")
_END_64 = struct.Struct("<4sQ2H2L4Q")
_LOCATOR_64 = struct.Struct("<4sLQL")
_LONGEST_COMMENT = 0xFFFF


@dataclass(frozen=True)
class Ending:
    """What the end of an archive says of its directory.

    Attributes
    ----------
    count, size, start
        Number of entries, bytes, and place of the directory.
    place
        Where the directory must have ended.
    regions
        Where the records of the end begin and end.
    """

    count: int
    size: int
    start: int
    place: int
    regions: tuple[tuple[int, int], ...]


def read_ending(file: IO[bytes]) -> Ending:
    """Find and read the records at the end of an archive.

    Raises
    ------
    RuleError
        If there are none, or if they contradict each other.
    """
    file.seek(0, 2)
    length = file.tell()
    first = max(0, length - _END.size - _LONGEST_COMMENT)
    file.seek(first)
    tail = file.read()
    found = tail.rfind(END)
    if found < 0 or len(tail) - found < _END.size:
        msg = "there is no directory at its end"
        raise unreadable(msg)
    place = first + found
    _, disk, disk_of_directory, here, count, size, start, comment = _END.unpack_from(tail, found)
    if place + _END.size + comment > length:
        msg = "its last record is cut off"
        raise unreadable(msg)
    regions = [(place, place + _END.size)]
    numbers = (count, size, start)
    wide = _wide_end(file, place)
    if wide is not None:
        place, numbers = wide
        regions[:0] = [(place, place + _END_64.size)]
        for narrow, number, full in zip((count, size, start), numbers, (FULL_16, FULL_32, FULL_32), strict=True):
            if narrow not in (full, number):
                msg = f"its two ends give the numbers {narrow} and {number} for one thing"
                raise unreadable(msg)
    elif disk or disk_of_directory or here != count:
        msg = "it is a part of an archive that is split into several files"
        raise unreadable(msg)
    return Ending(*numbers, place, tuple(regions))


def _wide_end(file: IO[bytes], place: int) -> tuple[int, tuple[int, int, int]] | None:
    """Place and numbers of the end of 64 bits; None if the archive has none."""
    if place < _LOCATOR_64.size:
        return None
    file.seek(place - _LOCATOR_64.size)
    signature, disk, wide, disks = _LOCATOR_64.unpack(file.read(_LOCATOR_64.size))
    if signature != LOCATOR_64:
        return None
    if wide > place - _LOCATOR_64.size - _END_64.size:
        msg = f"its end of 64 bits cannot lie at {wide}"
        raise unreadable(msg)
    file.seek(wide)
    signature, _, _, _, here, other, count, in_all, size, start = _END_64.unpack(file.read(_END_64.size))
    if signature != END_64:
        msg = f"its end of 64 bits does not lie at {wide}"
        raise unreadable(msg)
    if disk or here or other or disks > 1 or count != in_all:
        msg = "it is a part of an archive that is split into several files"
        raise unreadable(msg)
    return wide, (in_all, size, start)
