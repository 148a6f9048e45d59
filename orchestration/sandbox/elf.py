"""Reads the header of an ELF file: its machine, its segments, and where its tables lie.

The file must be of 64 bits and little-endian. The layout is that of the System V ABI, chapters 4 and 5.
"""

import struct
from dataclasses import dataclass
from typing import BinaryIO

MACHINES = {62: "x86_64", 183: "aarch64"}
LOAD, DYNAMIC = 1, 2
MAGIC = b"\x7fELF\x02\x01"
_HEADER = struct.Struct("<16s2HL3QL6H")
_SEGMENT = struct.Struct("<2L6Q")


class ElfError(ValueError):
    """A file is not a 64-bit little-endian ELF library, or is damaged."""


@dataclass(frozen=True)
class Segment:
    """A part of an ELF file that a program uses: its kind, address, place in the file, and size there."""

    kind: int
    address: int
    offset: int
    size_in_file: int


@dataclass(frozen=True)
class Header:
    """The header of an ELF file.

    Attributes
    ----------
    machine
        Processor, such as ``x86_64``.
    tables
        Place and length of the tables of segments and sections.
    segments
        All segments, in their order.
    """

    machine: str
    tables: tuple[tuple[int, int], ...]
    segments: tuple[Segment, ...]

    @property
    def loaded(self) -> tuple[Segment, ...]:
        """Segments that are mapped into memory."""
        return tuple(segment for segment in self.segments if segment.kind == LOAD)


def read_header(file: BinaryIO) -> Header:
    """Read the header and the segments of an open ELF file.

    Raises
    ------
    ElfError
        If the file is of another kind, or ends within its table of segments.
    """
    file.seek(0)
    data = file.read(_HEADER.size)
    if not data.startswith(MAGIC):
        msg = "it is not a 64-bit little-endian ELF file"
        raise ElfError(msg)
    try:
        _, _, machine, _, _, segments, sections, _, _, size, count, length, number, _ = _HEADER.unpack(data)
        file.seek(segments)
        rows = [_SEGMENT.unpack(file.read(_SEGMENT.size)) for _ in range(count)]
    except (struct.error, OSError, ValueError, OverflowError) as failed:
        msg = f"its tables are damaged ({failed})"
        raise ElfError(msg) from failed
    if count and size != _SEGMENT.size:
        msg = f"its segments have {size} bytes each"
        raise ElfError(msg)
    tables = ((segments, size * count), (sections, length * number if sections else 0))
    found = tuple(Segment(kind, address, offset, stored) for kind, _, offset, address, _, stored, _, _ in rows)
    return Header(MACHINES.get(machine, f"machine {machine}"), tables, found)
