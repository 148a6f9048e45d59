"""Columns as Arrow tables, which both file formats are written from and read into."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from orchestration.results.columns import TIME, Columns

if TYPE_CHECKING:
    import pyarrow as pa

ROW_GROUP_BYTES = 2**24
"""Size of the rows that are written at a time; 51,150 rows of 40 columns."""


def rows_per_group(n_columns: int) -> int:
    """Number of rows that are written at a time."""
    return max(1, ROW_GROUP_BYTES // (8 * (n_columns + 1)))


def arrow_schema(names: Sequence[str], units: Mapping[str, str]) -> "pa.Schema":
    """The schema: time in seconds first, every column of type double, its unit as metadata."""
    import pyarrow as pa

    units = {TIME: "s", **units}
    fields = [
        pa.field(name, pa.float64(), nullable=False, metadata={"unit": units.get(name, "")}) for name in (TIME, *names)
    ]
    return pa.schema(fields)


def arrow_table(schema: "pa.Schema", columns: Sequence[np.ndarray]) -> "pa.Table":
    """A table of columns of shape (n,), time first."""
    import pyarrow as pa

    return pa.table([pa.array(np.ascontiguousarray(c, np.float64)) for c in columns], schema=schema)


def columns_of(table: "pa.Table") -> Columns:
    """Names and values of a table.

    Raises
    ------
    ValueError
        If the first column is not time, or a cell has no value.
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
