"""Conversion between plain columns and Arrow tables.

Both file formats of results are written from and read into Arrow tables.
"""

import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from orchestration.results.columns import TIME, Columns
from orchestration.results.texts import ROW_BYTES, is_text, text_array, text_fields

if TYPE_CHECKING:
    import pyarrow as pa

ROW_GROUP_BYTES = 2**24
"""Size of a group of rows that is written at once, in bytes; for 40 columns a group has 51,150 rows."""


def arrow_errors() -> tuple[type[Exception], ...]:
    """Return the class of Arrow's errors; none where Arrow is not imported, so that it raises none."""
    arrow = sys.modules.get("pyarrow")
    return () if arrow is None else (arrow.ArrowException,)


def rows_per_group(n_columns: int, n_texts: int = 0) -> int:
    """Return the number of rows in a group, for numbers of columns besides time, and of columns of texts."""
    return max(1, ROW_GROUP_BYTES // (8 * (n_columns + 1) + ROW_BYTES * n_texts))


def arrow_schema(names: Sequence[str], units: Mapping[str, str], texts: Sequence[str] = ()) -> "pa.Schema":
    """Return the Arrow schema of a result: time first, then columns of type double, then those of texts.

    Parameters
    ----------
    names
        Columns as ``component.variable``, without time.
    units
        Units by column. The schema keeps the unit of a column as metadata ``unit``; the unit of time is s.
    texts
        Columns of texts.
    """
    import pyarrow as pa

    units = {TIME: "s", **units}
    fields = [
        pa.field(name, pa.float64(), nullable=False, metadata={"unit": units.get(name, "")}) for name in (TIME, *names)
    ]
    return pa.schema([*fields, *text_fields(texts)])


def arrow_table(schema: "pa.Schema", columns: Sequence[np.ndarray], texts: Sequence[np.ndarray] = ()) -> "pa.Table":
    """Return an Arrow table of columns of shape (n,), with time as the first column and texts as the last ones."""
    import pyarrow as pa

    numbers = [_arrow_array(np.ascontiguousarray(c, np.float64)) for c in columns]
    return pa.table([*numbers, *map(text_array, texts)], schema=schema)


def _arrow_array(values: np.ndarray) -> "pa.Array":
    """Return an Arrow array on the memory of doubles; ``pyarrow.array`` would import pandas, which takes a second."""
    import pyarrow as pa

    return pa.Array.from_buffers(pa.float64(), len(values), [None, pa.py_buffer(values)])


def columns_of(table: "pa.Table") -> Columns:
    """Return the names and values of an Arrow table as plain columns.

    Raises
    ------
    ValueError
        If the first column is not ``time``, or a cell has no value.
    """
    if table.column_names[:1] != [TIME]:
        msg = f"its first column is {', '.join(table.column_names[:1]) or 'missing'}, not time"
        raise ValueError(msg)
    numbers, texts = {}, {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        if column.null_count:
            msg = f"column {name} has {column.null_count} cells without a value"
            raise ValueError(msg)
        (texts if name != TIME and is_text(column.type) else numbers)[name] = column
    rows = np.empty((table.num_rows, len(numbers)))
    for i, column in enumerate(numbers.values()):
        rows[:, i] = column.to_numpy()
    found = {name: np.array(column.to_pylist(), object) for name, column in texts.items()}
    return Columns(rows[:, 0].copy(), tuple(numbers)[1:], rows[:, 1:].copy(), texts=found)
