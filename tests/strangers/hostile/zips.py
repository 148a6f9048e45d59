"""Writes zip archives that may lie: every field of a header and of the directory can be given by itself."""

import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

STORED, DEFLATED = 0, 8
UTF_8 = 0x800
LINK, DEVICE, FIFO, FOLDER = (kind << 16 for kind in (0o120777, 0o020644, 0o010644, 0o040755))


@dataclass(frozen=True)
class Row:
    """An entry; `local` and `central` replace fields in its header and in its record of the directory.

    The fields are name, needed, flags, method, crc, packed, size, extra; the record has system, disk, attributes and
    offset besides.
    """

    name: str | bytes
    content: bytes = b"content"
    method: int = STORED
    local: Mapping[str, object] = field(default_factory=dict)
    central: Mapping[str, object] = field(default_factory=dict)
    data: bytes | None = None

    def fields(self, offset: int) -> tuple[dict[str, Any], bytes]:
        """The fields without lies, and the packed data."""
        raw = self.name if isinstance(self.name, bytes) else self.name.encode()
        data = deflated(self.content) if self.method == DEFLATED else self.content
        data = data if self.data is None else self.data
        found = {
            "name": raw,
            "needed": 20,
            "flags": 0 if raw.isascii() else UTF_8,
            "method": self.method,
            "crc": zlib.crc32(self.content),
            "packed": len(data),
            "size": len(self.content),
            "extra": b"",
            "system": 3,
            "disk": 0,
            "attributes": 0o100644 << 16,
            "offset": offset,
        }
        return found, data


def deflated(content: bytes) -> bytes:
    """Raw deflate data."""
    engine = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    return engine.compress(content) + engine.flush()


def both(**fields: object) -> dict[str, Any]:
    """The same lie in the header and in the directory."""
    return {"local": fields, "central": fields}


def zipped(
    rows: Sequence[Row],
    *,
    around: Mapping[str, bytes] | None = None,
    end: Mapping[str, int] | None = None,
    wide: Mapping[str, int] | None = None,
) -> bytes:
    """The bytes of an archive.

    Parameters
    ----------
    around
        Bytes ``before`` the first entry, ``between`` the entries and the directory, as ``comment`` and ``after`` all.
    end
        Fields of the last record that lie: count, size, start.
    wide
        Fields of an end of 64 bits that lie: count, size, start, place. None leaves this end out.
    """
    around = around or {}
    out, records = bytearray(around.get("before", b"")), bytearray()
    for row in rows:
        plain, data = row.fields(len(out))
        out += _header({**plain, **row.local}) + data
        records += _record({**plain, **row.central})
    out += around.get("between", b"")
    true = {"count": len(rows), "size": len(records), "start": len(out)}
    out += records
    if wide is not None:
        f = {**true, "place": len(out), **wide}
        out += struct.pack("<4sQ2H2L4Q", b"PK\x06\x06", 44, 45, 45, 0, 0, f["count"], f["count"], f["size"], f["start"])
        out += struct.pack("<4sLQL", b"PK\x06\x07", 0, f["place"], 1)
    f, comment = {**true, **(end or {})}, around.get("comment", b"")
    out += struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, f["count"], f["count"], f["size"], f["start"], len(comment))
    return bytes(out + comment + around.get("after", b""))


def _header(f: dict[str, Any]) -> bytes:
    numbers = (f["needed"], f["flags"], f["method"], 0, 33, f["crc"], f["packed"], f["size"])
    return struct.pack("<4s5H3L2H", b"PK\x03\x04", *numbers, len(f["name"]), len(f["extra"])) + f["name"] + f["extra"]


def _record(f: dict[str, Any]) -> bytes:
    numbers = (f["flags"], f["method"], 0, 33, f["crc"], f["packed"], f["size"], len(f["name"]), len(f["extra"]), 0)
    places = (f["disk"], 0, f["attributes"], f["offset"])
    head = struct.pack("<4s2B5H3L5H2L", b"PK\x01\x02", 63, f["system"], f["needed"], *numbers, *places)
    return head + f["name"] + f["extra"]
