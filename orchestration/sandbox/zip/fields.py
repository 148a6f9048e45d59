"""Decodes the fields of an archive's entry: its name, its extra fields, and its numbers of 64 bits.

The layout is that of APPNOTE 6.3.10 (PKWARE, 2022), sections 4.4 to 4.6.
"""

import struct
import zlib

from orchestration.sandbox.zip.rules import RuleError, shown

FULL_16, FULL_32 = 0xFFFF, 0xFFFFFFFF  # the number stands in a field of 64 bits
_SIZES_64, _UNICODE_PATH = 0x0001, 0x7075  # kinds of extra fields
_UTF_8 = 0x800


def unreadable(reason: str) -> RuleError:
    """Return the error of a file that is not an archive, or is a damaged one."""
    return RuleError(f"is not a readable zip archive: {reason}; it is damaged or of another kind, so copy it again")


def extra_fields(raw: bytes, extra: bytes) -> dict[int, bytes]:
    """Extra fields of an entry by their kinds; a rest of less than four bytes is padding.

    Raises
    ------
    RuleError
        If a field is longer than the rest.
    """
    found: dict[int, bytes] = {}
    while len(extra) >= 4:
        kind, length = struct.unpack_from("<2H", extra)
        if length > len(extra) - 4:
            msg = f"entry {shown_raw(raw)} has an extra field {kind:#06x} that is cut off"
            raise unreadable(msg)
        found.setdefault(kind, extra[4 : 4 + length])
        extra = extra[4 + length :]
    return found


def sizes_64(raw: bytes, extras: dict[int, bytes], narrow: tuple[int, ...]) -> tuple[int, ...]:
    """Numbers of an entry, of 64 bits where the field of 32 bits is full.

    Raises
    ------
    RuleError
        If a number is missing, or both fields have one, and the numbers differ.
    """
    wide = extras.get(_SIZES_64, b"")
    values = list(struct.unpack(f"<{len(wide) // 8}Q", wide[: len(wide) // 8 * 8]))
    if FULL_32 not in narrow:
        if values and values[0] != narrow[0]:
            msg = f"entry {shown_raw(raw)} has the sizes {narrow[0]} and {values[0]} at once"
            raise unreadable(msg)
        return narrow
    if len(values) < narrow.count(FULL_32):
        msg = f"entry {shown_raw(raw)} lacks its sizes of 64 bits"
        raise unreadable(msg)
    return tuple(values.pop(0) if number == FULL_32 else number for number in narrow)


def shown_raw(raw: bytes) -> str:
    """Quote the stored bytes of a name for a message."""
    return shown(raw.decode("utf-8", errors="backslashreplace"))


def decoded_name(raw: bytes, flags: int, extras: dict[int, bytes]) -> str:
    """Decode a name: as UTF-8 if the entry says so, else as its Unicode path, else in code page 437.

    Raises
    ------
    RuleError
        If the name is not UTF-8, or if it is ASCII and the Unicode path differs from it.
    """
    if flags & _UTF_8:
        try:
            return raw.decode("utf-8")
        except UnicodeDecodeError as failed:
            msg = f"has an entry whose name is not UTF-8, {shown_raw(raw)}"
            raise RuleError(msg) from failed
    path = extras.get(_UNICODE_PATH, b"")
    if len(path) > 5 and path[0] == 1 and struct.unpack_from("<L", path, 1)[0] == zlib.crc32(raw):
        name = path[5:].decode("utf-8", errors="replace")
        if name != raw.decode("cp437") and raw.isascii():
            msg = f"has the entry {shown_raw(raw)} with a second name, {shown(name)}"
            raise RuleError(msg)
        return name
    return raw.decode("cp437")
