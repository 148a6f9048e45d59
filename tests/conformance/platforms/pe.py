"""Reads the exported and needed names of a Windows DLL from its PE headers (64 bit).

The date in the header is one only if the linker was not asked for reproducible bytes: else it is a part
of their hash, and a debug entry of the type "repro" says so.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

X86_64 = 0x8664
_PE32_PLUS = 0x20B
_DLL = 0x2000
_EXPORT, _IMPORT, _DEBUG, _DELAY_IMPORT = 0, 1, 6, 13
REPRODUCIBLE = 16  # type of a debug entry


@dataclass(frozen=True)
class Library:
    """A DLL's headers.

    Attributes
    ----------
    name
        Its own name, as in the export table.
    exported
        Names; an export without a name is ``#ordinal``.
    imported
        Functions, or ``#ordinal``, by DLL; names of DLLs in lower case.
    debug
        Types of debug entries: 16 for a date that is a hash, 2 for a path to a symbol file.
    """

    processor: int
    is_dll: bool
    name: str
    exported: tuple[str, ...]
    imported: dict[str, tuple[str, ...]]
    debug: tuple[int, ...]


def read(data: bytes) -> Library:
    """Read a DLL; ValueError if it is no 64-bit PE file."""
    header = struct.unpack_from("<I", data, 0x3C)[0]
    optional = header + 24
    if data[header : header + 4] != b"PE\0\0" or struct.unpack_from("<H", data, optional)[0] != _PE32_PLUS:
        raise ValueError("This is no 64-bit PE file.")
    processor, sections, _, _, _, size, flags = struct.unpack_from("<2H3I2H", data, header + 4)
    image = _Image(data, optional + 112, optional + size, sections)
    if image.directory(_DELAY_IMPORT)[1]:
        raise ValueError("Delayed imports are not read here.")
    name, exported = _exports(image)
    start, size = image.directory(_DEBUG)
    return Library(
        processor=processor,
        is_dll=bool(flags & _DLL),
        name=name,
        exported=exported,
        imported=dict(_imports(image)),
        debug=tuple(image.numbers("<I", start + 28 * i + 12)[0] for i in range(size // 28)),
    )


@dataclass(frozen=True)
class _Image:
    """Reads at addresses relative to where the library will be loaded."""

    data: bytes
    directories: int
    section_table: int
    sections: int

    def directory(self, number: int) -> tuple[int, int]:
        """Address and size of a table."""
        start, size = struct.unpack_from("<2I", self.data, self.directories + 8 * number)
        return start, size

    def numbers(self, form: str, address: int) -> tuple[int, ...]:
        return struct.unpack_from(form, self.data, self._offset(address))

    def text(self, address: int) -> str:
        start = self._offset(address)
        return self.data[start : self.data.index(b"\0", start)].decode()

    def _offset(self, address: int) -> int:
        for i in range(self.sections):
            size, base, _, raw = struct.unpack_from("<4I", self.data, self.section_table + 40 * i + 8)
            if base <= address < base + size:
                return address - base + raw
        raise ValueError(f"No section holds address {address:#x}.")


def _exports(image: _Image) -> tuple[str, tuple[str, ...]]:
    start, _ = image.directory(_EXPORT)
    name, base, functions, names, _, table, ordinals = image.numbers("<7I", start + 12)
    named = {
        image.numbers("<H", ordinals + 2 * i)[0]: image.text(image.numbers("<I", table + 4 * i)[0])
        for i in range(names)
    }
    return image.text(name), tuple(named.get(i, f"#{base + i}") for i in range(functions))


def _imports(image: _Image) -> Iterator[tuple[str, tuple[str, ...]]]:
    entry, _ = image.directory(_IMPORT)
    while any(image.numbers("<5I", entry)):
        lookup, _, _, name, addresses = image.numbers("<5I", entry)
        yield image.text(name).lower(), tuple(_functions(image, lookup or addresses))
        entry += 20


def _functions(image: _Image, entry: int) -> Iterator[str]:
    while (value := image.numbers("<Q", entry)[0]) != 0:
        by_ordinal = value >> 63
        yield f"#{value & 0xFFFF}" if by_ordinal else image.text((value & 0x7FFFFFFF) + 2)
        entry += 8
