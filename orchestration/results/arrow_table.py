"""Conversion between plain columns and Arrow tables.

Both file formats of results are written from and read into Arrow tables.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from orchestration.results.columns import TIME, Columns

if TYPE_CHECKING:
    import pyarrow as pa

ROW_GROUP_BYTES = 2**24
"""Size of a group of rows that is written at once, in bytes; for 40 columns a group has 51,150 rows."""


def rows_per_group(n_columns: int) -> int:
    """Return the number of rows in a group, for a number of columns besides time."""
    return max(1, ROW_GROUP_BYTES // (8 * (n_columns + 1)))


def arrow_schema(names: Sequence[str], units: Mapping[str, str]) -> "pa.Schema":
    """Return the Arrow schema of a result: time first, all columns of type double.

    Parameters
    ----------
    names
        Columns as ``component.variable``, without time.
    units
        Units by column. The schema keeps the unit of a column as metadata ``unit``; the unit of time is s.
    """
    import pyarrow as pa

    units = {TIME: "s", **units}
    fields = [
        pa.field(name, pa.float64(), nullable=False, metadata={"unit": units.get(name, "")}) for name in (TIME, *names)
    ]
    return pa.schema(fields)


def arrow_table(schema: "pa.Schema", columns: Sequence[np.ndarray]) -> "pa.Table":
    """Return an Arrow table of columns of shape (n,), with time as the first column."""
    import pyarrow as pa

    return pa.table([_arrow_array(np.ascontiguousarray(c, np.float64)) for c in columns], schema=schema)


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
    names = tuple(table.column_names)
    if names[:1] != (TIME,):
        msg = f"its first column is {', '.join(names[:1]) or 'missing'}, not time"
        raise ValueError(msg)
    rows = np.empty((table.num_rows, len(names)))
    for i, (name, column) in enumerate(zip(names, table.columns, strict=True)):
        if column.null_count:
            msg = f"column {name} has {column.null_count} cells without a value"
            raise ValueError(msg)
        rows[:, i] = column.to_numpy()
    return Columns(rows[:, 0].copy(), names[1:], rows[:, 1:].copy())
