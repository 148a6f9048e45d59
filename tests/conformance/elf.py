"""Reads the exported and needed names of a Linux library from its ELF headers (64 bit, little-endian).

Enough of the System V ABI to answer without binutils: the dynamic section gives the string and
symbol tables, the needed libraries, the search paths and the versions of the needed symbols.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

_LOAD, _DYNAMIC = 1, 2
_NEEDED, _HASH, _STRTAB, _SYMTAB, _RPATH, _RUNPATH = 1, 4, 5, 6, 15, 29
_VERNEED, _VERNEEDNUM = 0x6FFFFFFE, 0x6FFFFFFF
_LOCAL, _UNDEFINED, _HIDDEN, _INTERNAL = 0, 0, 2, 1


@dataclass(frozen=True)
class Library:
    """Names in a shared library's dynamic section.

    Attributes
    ----------
    exported, imported
        Dynamic symbols that are defined, and that others must define.
    needed, search_paths, versions
        Libraries it loads, its RPATH and RUNPATH, and versions such as ``GLIBC_2.2.5``.
    """

    exported: frozenset[str]
    imported: frozenset[str]
    needed: tuple[str, ...]
    search_paths: tuple[str, ...]
    versions: frozenset[str]


def read(path: Path) -> Library:
    """Read a shared library; ValueError if it is no 64-bit little-endian ELF file."""
    data = path.read_bytes()
    if data[:6] != b"\x7fELF\x02\x01":
        raise ValueError(f"{path} is no 64-bit little-endian ELF file.")
    segments = _segments(data)
    dynamic = _dynamic(data, segments)
    tags = dict(dynamic)
    strings = _offset(segments, tags[_STRTAB])

    def text(index: int) -> str:
        return data[strings + index : data.index(b"\0", strings + index)].decode()

    exported, imported = set(), set()
    for name, defined, visible in _symbols(data, segments, tags):
        if name and visible:
            (exported if defined else imported).add(text(name))
    return Library(
        exported=frozenset(exported),
        imported=frozenset(imported),
        needed=tuple(text(value) for tag, value in dynamic if tag == _NEEDED),
        search_paths=tuple(text(value) for tag, value in dynamic if tag in (_RPATH, _RUNPATH)),
        versions=frozenset(text(name) for name in _versions(data, segments, tags)),
    )


def _segments(data: bytes) -> list[tuple[int, int, int, int]]:
    """Type, file offset, address and file size of each program header."""
    start, size, count = (struct.unpack_from("<Q", data, 32)[0], *struct.unpack_from("<HH", data, 54))
    rows = (struct.unpack_from("<IIQQQQ", data, start + i * size) for i in range(count))
    return [(kind, offset, address, length) for kind, _, offset, address, _, length in rows]


def _offset(segments: list[tuple[int, int, int, int]], address: int) -> int:
    """File offset of an address."""
    for kind, offset, base, length in segments:
        if kind == _LOAD and base <= address < base + length:
            return address - base + offset
    raise ValueError(f"No segment holds address {address:#x}.")


def _dynamic(data: bytes, segments: list[tuple[int, int, int, int]]) -> list[tuple[int, int]]:
    _, offset, _, length = next(segment for segment in segments if segment[0] == _DYNAMIC)
    rows = [struct.unpack_from("<QQ", data, offset + i) for i in range(0, length, 16)]
    return rows[: [tag for tag, _ in rows].index(0)]


def _symbols(
    data: bytes, segments: list[tuple[int, int, int, int]], tags: dict[int, int]
) -> list[tuple[int, bool, bool]]:
    """Name's index, whether it is defined, whether others see it; the hash table holds their number."""
    count = struct.unpack_from("<I", data, _offset(segments, tags[_HASH]) + 4)[0]
    table = _offset(segments, tags[_SYMTAB])
    rows = (struct.unpack_from("<IBBH", data, table + 24 * i) for i in range(count))
    return [
        (name, section != _UNDEFINED, info >> 4 != _LOCAL and other & 3 not in (_HIDDEN, _INTERNAL))
        for name, info, other, section in rows
    ]


def _versions(data: bytes, segments: list[tuple[int, int, int, int]], tags: dict[int, int]) -> list[int]:
    """Indices of the names of needed symbol versions."""
    names = []
    entry = _offset(segments, tags[_VERNEED]) if _VERNEED in tags else 0
    for _ in range(tags.get(_VERNEEDNUM, 0)):
        _, count, _, first, following = struct.unpack_from("<HHIII", data, entry)
        auxiliary = entry + first
        for _ in range(count):
            _, _, _, name, step = struct.unpack_from("<IHHII", data, auxiliary)
            names.append(name)
            auxiliary += step
        entry += following
    return names
