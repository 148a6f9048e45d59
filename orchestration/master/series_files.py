"""Reads tables of measured data from CSV and Parquet files."""

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from adaptimp_fmu.files.parts import has
from orchestration.errors import SystemDescriptionError
from orchestration.results.arrow_table import arrow_errors
from orchestration.results.columns import TIME
from orchestration.results.parquet_file import PREFIX, UNITS
from orchestration.results.plain_csv import read_plain
from orchestration.sandbox.archive import file_hash

SUFFIXES = (".csv", ".parquet")
_INDEX = "__index_level_0__"  # what pandas calls an index without a name


@dataclass(frozen=True)
class Table:
    """Columns of a file by header, in the order of the file; units that the file declares; the hash of the file."""

    columns: tuple[tuple[str, np.ndarray], ...]
    units: Mapping[str, str]
    sha256: str


def read_table(path: Path) -> Table:
    """Read a CSV file with headers, or a Parquet file; empty cells become NaN.

    Raises
    ------
    SystemDescriptionError
        If the suffix is another one, or the file does not hold columns of numbers.
    """
    if path.suffix.lower() not in SUFFIXES:
        msg = (
            f"{path}: time series are read from .csv or .parquet, not from {path.suffix or 'a file without a suffix'}."
        )
        raise SystemDescriptionError(msg)
    try:
        columns, units = (_read_csv if path.suffix.lower() == ".csv" else _read_parquet)(path)
        return Table(columns, units, file_hash(path))
    except OSError as error:
        msg = f"{path}: the time series cannot be read: {error.strerror or error}."
        raise SystemDescriptionError(msg) from error
    except (*arrow_errors(), ValueError, TypeError) as error:
        msg = f"{path} does not hold time series: {' '.join(str(error).split()).rstrip('.')}."
        raise SystemDescriptionError(msg) from error


_Read = tuple[tuple[tuple[str, np.ndarray], ...], Mapping[str, str]]


def _read_csv(path: Path) -> _Read:
    """Read the columns of a CSV file, in UTF-8 with or without a byte order mark."""
    with path.open(encoding="utf-8-sig", newline="") as text:
        names = next(csv.reader(text), [])
    if not names:
        msg = "it is empty; the first line must name the columns"
        raise ValueError(msg)
    if len(names) == 1 and ";" in names[0]:
        msg = "its columns are separated by semicolons; separate them by commas"
        raise ValueError(msg)
    if not has("pyarrow"):
        with path.open(encoding="utf-8-sig", newline="") as text:
            return tuple(read_plain(text, (), missing=True).items()), {}
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    with path.open("rb") as file:
        table = arrow_csv.read_csv(
            file,
            arrow_csv.ReadOptions(column_names=names, skip_rows=1),
            convert_options=arrow_csv.ConvertOptions(column_types=dict.fromkeys(names, pa.float64())),
        )
    return tuple(zip(names, map(_numbers, table.columns), strict=True)), {}


def _read_parquet(path: Path) -> _Read:
    """Read the columns of a Parquet file of this tool, of pandas, or of another tool."""
    from pyarrow.parquet import ParquetFile

    with path.open("rb") as file, ParquetFile(file) as source:
        table = source.read()
        raw = source.metadata.metadata or {}
    units = {f.name: (f.metadata or {}).get(b"unit", b"").decode() for f in table.schema}
    units |= json.loads(raw.get(f"{PREFIX}{UNITS}".encode(), b"{}"))
    names = [TIME if name == _INDEX else name for name in table.column_names]
    return tuple(zip(names, map(_numbers, table.columns), strict=True)), units


def _numbers(column) -> np.ndarray:
    """A column of Arrow as an array; missing values of numbers become NaN."""
    return np.asarray(column.to_numpy())
