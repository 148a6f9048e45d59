"""CSV files without Arrow: the bytes and the numbers that Arrow gives, written and read by Python, in more time.

An installation without the part ``files`` uses this module. Numbers are the shortest texts that no other number has,
in decimal notation from 1e-6 to below 1e10, as Arrow writes them.
"""

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from decimal import Decimal
from typing import IO

import numpy as np

from orchestration.results.columns import TIME, Columns

ROWS = 1000
"""Rows that are written at once."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*([eE][+-]?\d+)?|\.\d+([eE][+-]?\d+)?|inf|infinity|nan)", re.IGNORECASE)


def write_plain(columns: Columns, file: IO[bytes]) -> None:
    """Write columns to an open file, with time as the first and texts as the last ones."""
    file.write((",".join(map(_quoted, (TIME, *columns.names, *columns.texts))) + "\n").encode())
    for first in range(0, len(columns.time), ROWS):
        part = slice(first, first + ROWS)
        numbers = np.column_stack([columns.time[part], columns.rows[part]]).tolist()
        texts = zip(*(values[part].tolist() for values in columns.texts.values()), strict=True)
        lines = zip(numbers, texts if columns.texts else [()] * len(numbers), strict=True)
        text = "".join(",".join([*map(shortest, row), *map(_quoted, words)]) + "\n" for row, words in lines)
        file.write(text.encode(errors="replace"))


def shortest(value: float) -> str:
    """Return the text of a number, with enough digits to differ from all other numbers.

    Examples
    --------
    >>> from orchestration.results.plain_csv import shortest
    >>> [shortest(value) for value in (1.0, -0.0, 0.00001, 1e-7, 12345678901.5)]
    ['1', '-0', '0.00001', '1e-7', '1.23456789015e+10']
    """
    text = repr(value)
    if 1e-4 <= abs(value) < 1e10 or value == 0 or value != value or value in (np.inf, -np.inf):
        return text.removesuffix(".0")
    number = Decimal(text)
    if 1e-6 <= abs(value) < 1e10:
        return f"{number:f}"
    exponent = number.adjusted()
    digits = "".join(map(str, number.as_tuple().digits)).rstrip("0")
    fraction = f".{digits[1:]}" if len(digits) > 1 else ""
    return f"{'-' if value < 0 else ''}{digits[0]}{fraction}e{exponent:+d}".replace("e-0", "e-")


def read_plain(lines: Iterable[str], texts: Sequence[str], *, missing: bool = False) -> dict[str, np.ndarray]:
    """Read columns by name: numbers as float64, and those of the names `texts` as objects of type str.

    Parameters
    ----------
    lines
        Lines of a file, the names first.
    missing
        Whether an empty cell is NaN.

    Raises
    ------
    ValueError
        If a line has another number of cells than there are names, or a cell of numbers holds something else.
    """
    reader = csv.reader(lines)
    names = next(reader, [])
    rows = list(_whole_rows(reader, len(names)))
    found: dict[str, np.ndarray] = {}
    for name, cells in zip(names, zip(*rows, strict=True) if rows else [()] * len(names), strict=True):
        if name in texts:
            found[name] = np.array([*cells, None], object)[:-1]
        else:
            found[name] = np.array([_number(cell, name, missing) for cell in cells], np.float64)
    return found


def plain_columns(lines: Iterable[str], texts: Sequence[str]) -> Columns:
    """Read a result, whose first column is ``time``; errors as of `read_plain`."""
    found = read_plain(lines, texts)
    if next(iter(found), None) != TIME:
        msg = f"its first column is {next(iter(found), None) or 'missing'}, not time"
        raise ValueError(msg)
    time = found.pop(TIME)
    words = {name: found.pop(name) for name in texts if name in found}
    rows = np.column_stack(list(found.values())) if found else np.empty((len(time), 0))
    return Columns(time, tuple(found), rows, texts=words)


def _whole_rows(reader: Iterator[list[str]], width: int) -> Iterator[list[str]]:
    """Rows with as many cells as there are names; empty lines are left out."""
    for number, row in enumerate(reader, 2):
        if row and len(row) != width:
            msg = f"row {number} has {len(row)} cells, and the first line names {width} columns"
            raise ValueError(msg)
        if row:
            yield row


def _number(cell: str, name: str, missing: bool) -> float:
    """The number in a cell; `float` alone would take ``1_000``, too."""
    if cell == "" and missing:
        return float("nan")
    if not _NUMBER.fullmatch(cell.strip(" \t")):
        msg = f"column {name} has a cell that is not a number: {cell!r}"
        raise ValueError(msg)
    return float(cell)


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'
