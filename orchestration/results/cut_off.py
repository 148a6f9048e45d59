"""Reads the rows of a Parquet file that a killed process left unfinished.

The table of contents of a Parquet file comes last, so no reader of Parquet can open such a file. Therefore a file of
results tells at its beginning, between the mark of Parquet and the first group of rows, what its columns are:

    PAR1 | MARK, length (4 bytes, little-endian), JSON | group | group | ... | table of contents | PAR1

Readers of Parquet skip these bytes, because a table of contents names the places of the groups. Without the table,
a group is read page by page: a page begins with a header in Thrift's compact protocol, which has the length of the
page. The values of a page are doubles whose bytes are split into eight streams, or texts one after the other, each
with its length; both are compressed by zstd.
"""

import json
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

MAGIC, MARK = b"PAR1", b"adaptimp.rows\0"
_LENGTH = struct.Struct("<I")
LONGEST_DESCRIPTION = 2**26  # bytes of JSON
LONGEST_HEADER = 2**10  # bytes of the header of a page; with statistics of doubles there are less than 100
_PLAIN, _BYTE_STREAM_SPLIT = 0, 9  # numbers of encodings in Parquet
_UNCOMPRESSED, _COMPRESSED, _VALUES = 2, 3, 5  # fields of a page's header
_COUNT, _ENCODING = 1, 2  # fields of a struct in field `_VALUES`
_STOP, _TRUE, _FALSE, _BYTE, _DOUBLE, _TEXT, _STRUCT = 0, 1, 2, 3, 7, 8, 12  # types of Thrift's compact protocol


def description(names: tuple[str, ...], rows_per_group: int, **described: Any) -> bytes:
    """Return the bytes that follow the mark of Parquet.

    Parameters
    ----------
    names
        Columns without time.
    rows_per_group
        Number of rows of each group but the last.
    **described
        Whatever else JSON can hold.
    """
    text = json.dumps({"names": names, "rows_per_group": rows_per_group, **described}, sort_keys=True).encode()
    return MARK + _LENGTH.pack(len(text)) + text


@dataclass(frozen=True)
class CutOff:
    """What an unfinished file tells of its columns, and where its groups of rows begin.

    Attributes
    ----------
    described
        What was given to `description`.
    first
        Place of the first group, bytes.
    """

    path: Path
    described: Mapping[str, Any]
    first: int

    @classmethod
    def open(cls, path: Path) -> "CutOff":
        """Read the beginning of a file.

        Raises
        ------
        OSError, ValueError
            If the file cannot be read, or ends before its first group, or does not begin as files of results do.
        """
        with path.open("rb") as file:
            head = file.read(len(MAGIC) + len(MARK) + _LENGTH.size)
            if not head.startswith(MAGIC + MARK):
                msg = "it does not begin as an unfinished file of a result"
                raise ValueError(msg)
            (length,) = _LENGTH.unpack(head[-_LENGTH.size :].rjust(_LENGTH.size, b"\xff"))
            text = file.read(min(length, LONGEST_DESCRIPTION))
            if len(text) != length:
                msg = "it ends before its first row"
                raise ValueError(msg)
            described = json.loads(text)
            if not (isinstance(described, dict) and {"names", "rows_per_group"} <= described.keys()):
                msg = "it does not say what its columns are"
                raise ValueError(msg)
            return cls(path, described, file.tell())

    def groups(self) -> Iterator[tuple[np.ndarray, dict[str, np.ndarray]]]:
        """Read the complete groups of rows.

        Yields
        ------
        tuple
            Time, s, and the columns of numbers, shape (n, n_columns + 1); columns of texts by name, shape (n,).
        """
        n_columns, n_rows = len(self.described["names"]) + 1, int(self.described["rows_per_group"])
        with self.path.open("rb") as file:
            file.seek(self.first)
            while True:
                rows = np.empty((n_rows, n_columns))
                try:
                    for column in rows.T:
                        _read_chunk(file, column, _BYTE_STREAM_SPLIT)
                    texts = {name: np.empty(n_rows, object) for name in self.described.get("texts", ())}
                    for column in texts.values():
                        _read_chunk(file, column, _PLAIN)
                except (ValueError, IndexError, OSError, struct.error):  # here the file ends, or its table begins
                    return
                yield rows, texts


def _read_chunk(file: IO[bytes], column: np.ndarray, encoding: int) -> None:
    """Read the pages of a column's part of a group, of doubles or of texts, until the column is full.

    Raises
    ------
    ValueError, IndexError, OSError
        If the file ends before.
    """
    import pyarrow as pa

    codec, done = pa.Codec("zstd"), 0
    while done < len(column):
        place = file.tell()
        header, length = _struct(file.read(LONGEST_HEADER), 0)
        file.seek(place + length)
        count, size = header[_VALUES][_COUNT], header[_COMPRESSED]
        if header[_VALUES][_ENCODING] != encoding or not 0 < count <= len(column) - done:
            msg = f"there is no page at byte {place}"
            raise ValueError(msg)
        packed, whole = file.read(size), header[_UNCOMPRESSED]
        if len(packed) != size or (encoding == _BYTE_STREAM_SPLIT and whole != 8 * count):
            msg = f"the page at byte {place} is cut off"
            raise ValueError(msg)
        page = codec.decompress(packed, whole, asbytes=True)
        column[done : done + count] = _doubles(page, count) if encoding == _BYTE_STREAM_SPLIT else _texts(page, count)
        done += count


def _doubles(page: bytes, count: int) -> np.ndarray:
    """Doubles of a page, whose bytes are split into eight streams."""
    streams = np.frombuffer(page, np.uint8).reshape(8, count)
    return np.ascontiguousarray(streams.T).view("<f8")[:, 0]


def _texts(page: bytes, count: int) -> list[str]:
    """Texts of a page, each after its length in bytes."""
    found, at = [], 0
    for _ in range(count):
        (length,) = _LENGTH.unpack_from(page, at)
        at += _LENGTH.size + length
        if at > len(page):
            msg = "a text is longer than its page"
            raise ValueError(msg)
        found.append(page[at - length : at].decode())
    return found


class _Fields(dict[int, Any]):
    """Fields of a struct by number; a field that is missing is an error of the file."""

    def __missing__(self, number: int) -> Any:
        msg = f"a page has no field {number}"
        raise ValueError(msg)


def _struct(text: bytes, at: int) -> tuple[_Fields, int]:
    """Fields of a struct in Thrift's compact protocol, and where it ends."""
    found, number = _Fields(), 0
    while True:
        head, at = text[at], at + 1
        kind, step = head & 0x0F, head >> 4
        if kind == _STOP:
            return found, at
        if step:
            number += step
        else:
            number, at = _integer(text, at)
        found[number], at = _value(text, at, kind)


def _value(text: bytes, at: int, kind: int) -> tuple[Any, int]:
    """A field of a type, and where it ends."""
    if kind in (_TRUE, _FALSE):
        return kind == _TRUE, at
    if kind == _BYTE:
        return text[at], at + 1
    if kind < _DOUBLE:
        return _integer(text, at)
    if kind == _DOUBLE:
        return struct.unpack_from("<d", text, at)[0], at + 8
    if kind == _TEXT:
        length, at = _varint(text, at)
        return text[at : at + length], at + length
    if kind == _STRUCT:
        return _struct(text, at)
    msg = f"a page has a field of type {kind}"
    raise ValueError(msg)


def _integer(text: bytes, at: int) -> tuple[int, int]:
    """A signed number, zigzag, and where it ends."""
    value, at = _varint(text, at)
    return (value >> 1) ^ -(value & 1), at


def _varint(text: bytes, at: int) -> tuple[int, int]:
    """A number of seven bits per byte, and where it ends."""
    value = shift = 0
    while True:
        byte, at = text[at], at + 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, at
