"""Choice of the file format of a result by the suffix of the file."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from orchestration.errors import OrchestrationError
from orchestration.results.columns import Columns
from orchestration.results.csv_file import read_csv, write_csv
from orchestration.results.parquet_file import parquet_parts, read_parquet, write_parquet

WRITERS: dict[str, Callable[[Columns, Path], None]] = {".csv": write_csv, ".parquet": write_parquet}
READERS: dict[str, Callable[[Path], Columns]] = {".csv": read_csv, ".parquet": read_parquet}


def write_columns(columns: Columns, path: Path) -> None:
    """Write columns to a CSV or Parquet file, as the suffix of the path says.

    Raises
    ------
    OrchestrationError
        If the suffix is unknown, or the file cannot be written.
    """
    WRITERS[_suffix(path, "written")](columns, path)


def read_columns(path: Path) -> Columns:
    """Read columns from a CSV or Parquet file, as the suffix of the path says.

    A CSV file gives names and values only: no units, no metadata and no steps per tick.

    Raises
    ------
    OrchestrationError
        If the suffix is unknown, or the file does not hold a result.
    """
    reader = READERS[_suffix(path, "read")]
    with _read_errors(path):
        return reader(path)


def parts_of(path: Path) -> Iterator[Columns]:
    """Read columns in parts: a Parquet file by its groups of rows, a CSV file as a whole; errors as `read_columns`."""
    with _read_errors(path):
        if _suffix(path, "read") == ".parquet":
            yield from parquet_parts(path)
        else:
            yield read_csv(path)


@contextmanager
def _read_errors(path: Path) -> Iterator[None]:
    """Convert the errors of a file that cannot be read into errors of this package.

    Raises
    ------
    OrchestrationError
        If the file cannot be read, or does not hold a result.
    """
    import pyarrow as pa

    try:
        yield
    except OSError as error:
        msg = f"{path}: the result cannot be read: {error.strerror or error}."
        raise OrchestrationError(msg) from error
    except (pa.ArrowException, ValueError, TypeError) as error:
        msg = f"{path} does not hold a result: {' '.join(str(error).split()).rstrip('.')}."
        raise OrchestrationError(msg) from error


def _suffix(path: Path, done: str) -> str:
    """Suffix of a path in lower case; an error names the known suffixes."""
    suffix = path.suffix.lower()
    if suffix not in WRITERS:
        msg = f"{path}: results are {done} as .csv or .parquet, not as {path.suffix or 'a file without a suffix'}."
        raise OrchestrationError(msg)
    return suffix
