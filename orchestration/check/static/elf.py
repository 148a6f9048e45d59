"""Reads which symbols and libraries a shared library of Linux exports and needs, from its ELF file.

The file must be of 64 bits and little-endian. The reader follows the System V ABI, chapters 4 and 5, and knows the
GNU hash table. It needs no binutils and does not load the library.
"""

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from orchestration.sandbox.elf import DYNAMIC, ElfError, Header, read_header

_NEEDED, _HASH, _STRTAB, _SYMTAB, _RPATH, _RUNPATH, _GNU_HASH = 1, 4, 5, 6, 15, 29, 0x6FFFFEF5
_SYMBOL = struct.Struct("<IBBHQQ")
_LONGEST = 4096  # bytes of a name; those of C++ templates have a few hundred
_MOST = 200_000  # symbols, entries, headers: more are a damaged table


@dataclass(frozen=True)
class Library:
    """Names in the dynamic section of a shared library.

    Attributes
    ----------
    machine
        Processor, such as ``x86_64``.
    exported, undefined
        Dynamic symbols that the library defines for others, and symbols that other libraries must define.
    needed, search_paths
        Libraries that the library loads, and its RPATH and RUNPATH.
    """

    machine: str
    exported: frozenset[str]
    undefined: frozenset[str]
    needed: tuple[str, ...]
    search_paths: tuple[str, ...]


def read(data: bytes) -> Library:
    """Read the dynamic section of a shared library.

    Raises
    ------
    ElfError
    """
    try:
        return _read(data)
    except (struct.error, IndexError, KeyError, OverflowError, MemoryError) as failed:
        msg = f"its tables are damaged ({failed})"
        raise ElfError(msg) from failed


def _read(data: bytes) -> Library:
    header = read_header(io.BytesIO(data))
    loads, dynamic = _segments(header)
    entries = list(_dynamic(data, dynamic))
    tags = dict(entries)
    strings = _offset(loads, tags[_STRTAB])

    def text(index: int) -> str:
        end = data.find(b"\0", strings + index, strings + index + _LONGEST)
        if end < 0:
            msg = "a name has no end, or is too long"
            raise ElfError(msg)
        return data[strings + index : end].decode(errors="replace")

    exported, undefined = set(), set()
    table = _offset(loads, tags[_SYMTAB])
    for i in range(_count(data, loads, tags)):
        name, info, other, section, *_ = _SYMBOL.unpack_from(data, table + _SYMBOL.size * i)
        if name and section and info >> 4 and other & 3 in (0, 3):  # defined, not local, default or protected
            exported.add(text(name))
        elif name and not section:
            undefined.add(text(name))
    return Library(
        machine=header.machine,
        exported=frozenset(exported),
        undefined=frozenset(undefined),
        needed=tuple(text(value) for tag, value in entries if tag == _NEEDED),
        search_paths=tuple(text(value) for tag, value in entries if tag in (_RPATH, _RUNPATH)),
    )


def _segments(header: Header) -> tuple[list[tuple[int, int, int]], tuple[int, int]]:
    """Return address, size and file offset of each loaded segment, and offset and size of the dynamic section."""
    dynamic = [(segment.offset, segment.size_in_file) for segment in header.segments if segment.kind == DYNAMIC]
    if not dynamic:
        msg = "it has no dynamic section"
        raise ElfError(msg)
    return [(s.address, s.size_in_file, s.offset) for s in header.loaded], dynamic[-1]


def _dynamic(data: bytes, place: tuple[int, int]) -> Iterator[tuple[int, int]]:
    for i in range(min(place[1] // 16, _MOST)):
        tag, value = struct.unpack_from("<QQ", data, place[0] + 16 * i)
        if tag == 0:
            return
        yield tag, value


def _offset(loads: list[tuple[int, int, int]], address: int) -> int:
    for base, length, offset in loads:
        if base <= address < base + length:
            return address - base + offset
    msg = f"no segment holds the address {address:#x}"
    raise ElfError(msg)


def _count(data: bytes, loads: list[tuple[int, int, int]], tags: dict[int, int]) -> int:
    """Return the number of dynamic symbols, from either hash table."""
    if _HASH in tags:
        count = struct.unpack_from("<I", data, _offset(loads, tags[_HASH]) + 4)[0]
    else:
        count = _gnu_count(data, _offset(loads, tags[_GNU_HASH]))
    if count > _MOST:
        msg = f"it has {count} symbols"
        raise ElfError(msg)
    return count


def _gnu_count(data: bytes, table: int) -> int:
    """Return the end of the last chain of the GNU hash table."""
    buckets, first, words, _ = struct.unpack_from("<IIII", data, table)
    if buckets > _MOST:
        msg = f"its hash table has {buckets} buckets"
        raise ElfError(msg)
    start = table + 16 + 8 * words
    last = max(struct.unpack_from(f"<{buckets}I", data, start), default=0)
    if last < first:
        return first
    chain = start + 4 * buckets
    while not struct.unpack_from("<I", data, chain + 4 * (last - first))[0] & 1:
        last += 1
        if last > _MOST:
            msg = "its hash table has no end"
            raise ElfError(msg)
    return last + 1
