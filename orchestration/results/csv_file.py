"""Files of results in CSV format: names and values, without loss of any bit of a value.

The layout is the one of fmpy files. The first column is ``time``, names are quoted, and each communication point
has one line. A number has enough digits to differ from all other numbers. Texts are quoted, and their columns stand
last. A CSV file keeps neither units nor metadata. The same result gives the same bytes.
"""

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from adaptimp_fmu.files.parts import has
from adaptimp_fmu.files.whole_file import whole_file
from orchestration.results.arrow_table import arrow_schema, arrow_table, columns_of, rows_per_group
from orchestration.results.columns import Columns
from orchestration.results.places import write_errors
from orchestration.results.plain_csv import plain_columns, write_plain

CSV_BLOCK_BYTES = 2**23
"""Size of the blocks in which a file is read, in bytes; every line must be shorter than a block."""
_CELL = re.compile(r'(?:^|,)(?:"(?:[^"]|"")*"|[^,]*)')


def write_csv(columns: Columns, path: Path) -> None:
    """Write a CSV file that fmpy, numpy and spreadsheets can read.

    fmpy itself splits names at commas, even at quoted ones.

    Parameters
    ----------
    columns
        Names and values.
    path
        File to write. An existing file is replaced when the new file is complete.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    if not has("pyarrow"):
        with write_errors(path), whole_file(path) as file:
            write_plain(columns, file)
        return
    import pyarrow.csv

    schema = arrow_schema(columns.names, {}, tuple(columns.texts))
    length = rows_per_group(len(columns.names), len(columns.texts))
    with write_errors(path), whole_file(path) as file, pyarrow.csv.CSVWriter(file, schema) as writer:
        for first in range(0, len(columns.time), length):
            part = slice(first, first + length)
            numbers = [columns.time[part], *columns.rows[part].T]
            writer.write_table(arrow_table(schema, numbers, [texts[part] for texts in columns.texts.values()]))


def read_csv(path: Path) -> Columns:
    """Read a CSV file whose first column is ``time``, in UTF-8 with or without a byte order mark.

    A column holds texts if its first cell is quoted, as `write_csv` writes texts. If that of ``time`` is quoted,
    another tool has quoted all cells, and all columns hold numbers.

    Raises
    ------
    OSError, ValueError, pyarrow.ArrowException
        If the file cannot be read, or does not hold columns of numbers with ``time`` as the first.
    """
    with path.open(encoding="utf-8-sig", newline="") as text:
        names = next(csv.reader(text), [])
        texts = _quoted(text, names)
    if not has("pyarrow"):
        with path.open(encoding="utf-8-sig", newline="") as text:
            return plain_columns(text, texts)
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    with path.open("rb") as file:
        table = arrow_csv.read_csv(
            file,
            arrow_csv.ReadOptions(block_size=CSV_BLOCK_BYTES),
            arrow_csv.ParseOptions(newlines_in_values=bool(texts)),
            convert_options=arrow_csv.ConvertOptions(
                column_types=dict.fromkeys(names, pa.float64()) | dict.fromkeys(texts, pa.string()), null_values=[]
            ),  # type double even for whole numbers, because an integer has no -0
        )
    return columns_of(table)


def _quoted(lines: Iterable[str], names: Sequence[str]) -> list[str]:
    """Names of the columns whose cells are quoted in the first record of some lines."""
    taken: list[str] = []

    def listened() -> Iterator[str]:
        for line in lines:
            taken.append(line)
            yield line

    next(csv.reader(listened()), [])  # a cell may have line breaks
    cells = [match[0] for match in _CELL.finditer("".join(taken))]
    if not cells or cells[0].startswith('"'):
        return []
    return [name for name, cell in zip(names, cells, strict=False) if cell.lstrip(",").startswith('"')]
