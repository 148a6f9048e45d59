"""Unpacks the data of an archive's entry piece by piece, and never more bytes than the directory announces."""

import zlib
from collections.abc import Iterator
from typing import IO

from orchestration.sandbox.zip.directory import Entry
from orchestration.sandbox.zip.rules import RuleError, shown

STORED, DEFLATED = 0, 8
_CHUNK = 256 * 1024


def pieces(file: IO[bytes], entry: Entry, place: int) -> Iterator[bytes]:
    """Iterate over the unpacked data of an entry.

    Parameters
    ----------
    place
        Where the packed data begin in the file.

    Raises
    ------
    RuleError
        If the data are damaged, or their size or CRC is not the one of the directory.
    """
    size = crc = 0
    for piece in _inflated(file, entry, place) if entry.method == DEFLATED else _packed(file, entry, place):
        size += len(piece)
        crc = zlib.crc32(piece, crc)
        if size > entry.size:
            raise _damaged(entry, f"it has more than the {entry.size} bytes that the directory gives")
        yield piece
    if size != entry.size:
        raise _damaged(entry, f"it has {size} bytes, but the directory gives {entry.size}")
    if crc != entry.crc:
        raise _damaged(entry, f"its CRC is {crc:08x}, but the directory gives {entry.crc:08x}")


def _damaged(entry: Entry, reason: str) -> RuleError:
    name = shown(entry.name)
    return RuleError(f"cannot be unpacked, because entry {name} is damaged: {reason}; build or copy it again")


def _packed(file: IO[bytes], entry: Entry, place: int) -> Iterator[bytes]:
    """Iterate over the bytes of an entry as they stand in the file."""
    left = entry.packed
    while left:
        file.seek(place)  # others may read from the file between two pieces
        block = file.read(min(left, _CHUNK))
        if not block:
            raise _damaged(entry, "the file ends before it")
        left -= len(block)
        place += len(block)
        yield block


def _inflated(file: IO[bytes], entry: Entry, place: int) -> Iterator[bytes]:
    engine = zlib.decompressobj(-zlib.MAX_WBITS)
    blocks = _packed(file, entry, place)
    while not engine.eof:
        given = engine.unconsumed_tail or next(blocks, b"")
        try:
            piece = engine.decompress(given, _CHUNK)
        except zlib.error as failed:
            raise _damaged(entry, str(failed)) from failed
        if not given and not piece:
            raise _damaged(entry, "its packed data end too early")
        if piece:
            yield piece
    if engine.unused_data or next(blocks, b""):
        raise _damaged(entry, "its packed data go on after their end")
