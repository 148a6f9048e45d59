"""Reads the names that an object file of a C compiler defines for others, and the names that it needs from others.

The file is a relocatable ELF file of 64 bits, little-endian, as compilers for Linux write it. The layout is that of
the System V ABI, chapter 4.
"""

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from orchestration.sandbox.elf import ElfError, read_header

_SECTION = struct.Struct("<2L4Q2L2Q")
_SYMBOL = struct.Struct("<IBBHQQ")
_SYMBOL_TABLE = 2
_LONGEST = 4096  # bytes of a name
_MOST = 200_000  # symbols


@dataclass(frozen=True)
class Names:
    """Names of functions and variables in an object file that the linker sees.

    Attributes
    ----------
    defined
        Names that the file defines for other files.
    undefined
        Names that other files must define.
    """

    defined: frozenset[str]
    undefined: frozenset[str]


def read_names(data: bytes) -> Names:
    """Read the global names of an object file.

    Raises
    ------
    ElfError
        If the file is of another kind, or is damaged.
    """
    try:
        symbols = list(_global_symbols(data))
    except (struct.error, IndexError, OverflowError) as failed:
        msg = f"its tables are damaged ({failed})"
        raise ElfError(msg) from failed
    return Names(
        defined=frozenset(name for name, is_defined in symbols if is_defined),
        undefined=frozenset(name for name, is_defined in symbols if not is_defined),
    )


def _global_symbols(data: bytes) -> Iterator[tuple[str, bool]]:
    """Each global symbol, and whether the file defines it."""
    start, length = read_header(io.BytesIO(data)).tables[1]
    sections = [_SECTION.unpack_from(data, start + i) for i in range(0, length, _SECTION.size)]
    for _, kind, _, _, offset, size, link, *_ in sections:
        if kind != _SYMBOL_TABLE:
            continue
        if size > _MOST * _SYMBOL.size:
            msg = f"it has more than {_MOST} symbols"
            raise ElfError(msg)
        strings = sections[link][4]
        for place in range(offset, offset + size, _SYMBOL.size):
            name, info, _, section, *_ = _SYMBOL.unpack_from(data, place)
            if name and info >> 4:  # not local
                yield _text(data, strings + name), section != 0


def _text(data: bytes, start: int) -> str:
    end = data.find(b"\0", start, start + _LONGEST)
    if end < 0:
        msg = "a name has no end, or is too long"
        raise ElfError(msg)
    return data[start:end].decode(errors="replace")
