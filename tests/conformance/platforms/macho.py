"""Reads the exported and needed names of a macOS library from its load commands (64 bit, little-endian).

Enough of Apple's ``mach-o/loader.h`` and ``cs_blobs.h`` to answer without a Mac: exported names come from
the export trie, which is what the dynamic loader searches, and each page is held against its signature.
"""

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import dataclass

X86_64, ARM64 = 0x01000007, 0x0100000C
DYLIB, MACOS = 6, 1
_MAGIC = 0xFEEDFACF
_REQUIRED = 0x80000000  # a flag on commands that the loader must understand
_SYMTAB, _CODE_SIGNATURE, _BUILD_VERSION = 0x2, 0x1D, 0x32
_ID, _LOAD, _LOAD_WEAK, _REEXPORT, _UPWARD = 0xD, 0xC, 0x18, 0x1F, 0x23
_RPATH, _DYLD_INFO, _EXPORTS_TRIE = 0x1C, 0x22, 0x33
_STABS, _TYPE, _EXTERNAL = 0xE0, 0x0E, 0x01
_SIGNATURE, _DIRECTORY, _AD_HOC, _SHA256 = 0xFADE0CC0, 0xFADE0C02, 0x2, 2


@dataclass(frozen=True)
class Signature:
    """A code signature.

    Attributes
    ----------
    identifier
        The name it was signed under.
    ad_hoc
        Whether it was made without a certificate; Apple's processors run no code without that at least.
    pages_match
        Whether every page has the hash that was signed, up to the signature itself.
    """

    identifier: str
    ad_hoc: bool
    pages_match: bool


@dataclass(frozen=True)
class Library:
    """A shared library's header and load commands.

    Attributes
    ----------
    platform, minimum
        What it was built for, and the oldest version, (major, minor).
    exported, imported
        Names with their leading underscore.
    install_name, needed, search_paths
        Its own name, libraries it loads, its rpaths.
    """

    processor: int
    kind: int
    platform: int
    minimum: tuple[int, int]
    exported: frozenset[str]
    imported: frozenset[str]
    install_name: str
    needed: tuple[str, ...]
    search_paths: tuple[str, ...]
    signature: Signature | None


def read(data: bytes) -> Library:
    """Read a shared library; ValueError if it is no 64-bit little-endian Mach-O file."""
    magic, processor, _, kind, count = struct.unpack_from("<5I", data)
    if magic != _MAGIC:
        raise ValueError("This is no 64-bit little-endian Mach-O file.")
    commands = list(_commands(data, count))
    platform, version = struct.unpack_from("<2I", data, _only(commands, _BUILD_VERSION) + 8)
    signatures = [offset for code, offset in commands if code == _CODE_SIGNATURE]
    return Library(
        processor=processor,
        kind=kind,
        platform=platform,
        minimum=(version >> 16, version >> 8 & 0xFF),
        exported=frozenset(_exported(data, commands)),
        imported=frozenset(_imported(data, _only(commands, _SYMTAB))),
        install_name=_string(data, _only(commands, _ID)),
        needed=tuple(_string(data, o) for c, o in commands if c in (_LOAD, _LOAD_WEAK, _REEXPORT, _UPWARD)),
        search_paths=tuple(_string(data, offset) for code, offset in commands if code == _RPATH),
        signature=_signature(data, signatures[0]) if signatures else None,
    )


def _commands(data: bytes, count: int) -> Iterator[tuple[int, int]]:
    """Code and offset of each load command."""
    offset = 32
    for _ in range(count):
        code, size = struct.unpack_from("<2I", data, offset)
        yield code & ~_REQUIRED, offset
        offset += size


def _only(commands: list[tuple[int, int]], wanted: int) -> int:
    """Offset of the one command of a code."""
    (offset,) = (offset for code, offset in commands if code == wanted)
    return offset


def _text(data: bytes, offset: int) -> str:
    return data[offset : data.index(b"\0", offset)].decode()


def _string(data: bytes, command: int) -> str:
    """The string of a command that has one: its offset is the command's third word."""
    return _text(data, command + struct.unpack_from("<I", data, command + 8)[0])


def _exported(data: bytes, commands: list[tuple[int, int]]) -> Iterator[str]:
    """Names in the export trie."""
    tries = [struct.unpack_from("<2I", data, offset + 8) for code, offset in commands if code == _EXPORTS_TRIE]
    tries += [struct.unpack_from("<2I", data, offset + 40) for code, offset in commands if code == _DYLD_INFO]
    for start, size in tries:
        yield from _below(data[start : start + size], 0, "")


def _below(trie: bytes, node: int, prefix: str) -> Iterator[str]:
    """Names at and below a node of a trie: its symbol, if it has one, then its edges."""
    size, offset = _uleb(trie, node)
    if size:
        yield prefix
    offset += size
    edges, offset = trie[offset], offset + 1
    for _ in range(edges):
        label = _text(trie, offset)
        child, offset = _uleb(trie, offset + len(label) + 1)
        yield from _below(trie, child, prefix + label)


def _uleb(data: bytes, offset: int) -> tuple[int, int]:
    """A number of 7 bits per byte, lowest first, and the offset after it."""
    value = shift = 0
    while True:
        byte, offset = data[offset], offset + 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if not byte & 0x80:
            return value, offset


def _imported(data: bytes, command: int) -> Iterator[str]:
    """External symbols without a section."""
    symbols, count, strings = struct.unpack_from("<3I", data, command + 8)
    for i in range(count):
        name, kind = struct.unpack_from("<IB", data, symbols + 16 * i)
        if kind & _EXTERNAL and not kind & (_STABS | _TYPE):
            yield _text(data, strings + name)


def _signature(data: bytes, command: int) -> Signature:
    """The code directory in the signature; its numbers are big-endian."""
    end = start = struct.unpack_from("<I", data, command + 8)[0]
    magic, _, count = struct.unpack_from(">3I", data, start)
    if magic != _SIGNATURE:
        raise ValueError("The code signature has no super blob.")
    blobs = (start + struct.unpack_from(">2I", data, start + 12 + 8 * i)[1] for i in range(count))
    directory = next(blob for blob in blobs if struct.unpack_from(">I", data, blob)[0] == _DIRECTORY)
    flags, hashes, name, _, pages, limit = struct.unpack_from(">6I", data, directory + 12)
    size, kind, _, shift = struct.unpack_from("4B", data, directory + 36)
    if kind != _SHA256:
        raise ValueError(f"The pages are hashed by algorithm {kind}, not SHA-256.")
    page = 1 << shift
    signed = [data[directory + hashes + size * i :][:size] for i in range(pages)]
    found = [hashlib.sha256(data[i : min(i + page, limit)]).digest() for i in range(0, limit, page)]
    return Signature(_text(data, directory + name), bool(flags & _AD_HOC), signed == found and limit == end)
