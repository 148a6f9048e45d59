"""Reads a few columns of a Parquet file, so that the others take no time and no memory."""

from collections.abc import Collection
from dataclasses import fields
from pathlib import Path

from orchestration.fmi.names import base_name
from orchestration.results.arrow_table import columns_of
from orchestration.results.columns import TIME, Columns
from orchestration.results.parquet_file import described
from orchestration.results.result import Result


def read_some_columns(path: Path, names: Collection[str]) -> Result:
    """Read some columns of a Parquet file of this tool.

    Parameters
    ----------
    names
        Columns and arrays to read. Those that the file lacks are left out.

    Raises
    ------
    OSError, ValueError, pyarrow.ArrowException
        If the file cannot be read, or does not hold a result.
    """
    from pyarrow.parquet import ParquetFile

    with path.open("rb") as file, ParquetFile(file) as source:
        present = source.schema_arrow.names
        chosen = [name for name in present if name == TIME or name in names or base_name(name) in names]
        columns = described(columns_of(source.read(chosen)), source)
    return Result(**{field.name: getattr(columns, field.name) for field in fields(Columns)})
