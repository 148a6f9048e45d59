"""Choice of the file format of a result by the suffix of the file."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from adaptimp_fmu.files.whole_file import SUFFIX as UNFINISHED
from orchestration.errors import OrchestrationError
from orchestration.results.arrow_table import arrow_errors
from orchestration.results.columns import Columns
from orchestration.results.csv_file import read_csv, write_csv
from orchestration.results.parquet_file import cut_off_parts, parquet_parts, read_cut_off, read_parquet, write_parquet
from orchestration.sandbox.missing import no_file

WRITERS: dict[str, Callable[[Columns, Path], None]] = {".csv": write_csv, ".parquet": write_parquet}
READERS: dict[str, Callable[[Path], Columns]] = {
    ".csv": read_csv,
    ".parquet": read_parquet,
    UNFINISHED: read_cut_off,
}


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

    A CSV file gives names and values only: no units, no metadata and no steps per tick. Of a Parquet file that a
    killed process left unfinished, ``NAME.parquet.<random>.part``, the complete groups of rows are read.

    Raises
    ------
    OrchestrationError
        If the suffix is unknown, or the file does not hold a result.
    """
    reader = READERS[_suffix_to_read(path)]
    _require(path)
    with _read_errors(path):
        return reader(path)


def parts_of(path: Path) -> Iterator[Columns]:
    """Read columns in parts: a Parquet file by its groups of rows, a CSV file as a whole; errors as `read_columns`."""
    suffix = _suffix_to_read(path)
    _require(path)
    with _read_errors(path):
        if suffix == ".parquet":
            yield from parquet_parts(path)
        elif suffix == UNFINISHED:
            yield from cut_off_parts(path)
        else:
            yield read_csv(path)


def _require(path: Path) -> None:
    """Refuse a file that does not exist."""
    if not path.is_file():
        raise OrchestrationError(no_file(path, "file of a result"))


@contextmanager
def _read_errors(path: Path) -> Iterator[None]:
    """Convert the errors of a file that cannot be read into errors of this package.

    Raises
    ------
    OrchestrationError
        If the file cannot be read, or does not hold a result.
    """
    try:
        yield
    except OSError as error:
        msg = f"{path}: the result cannot be read: {error.strerror or error}."
        raise OrchestrationError(msg) from error
    except (*arrow_errors(), ValueError, TypeError) as error:
        reason = " ".join(str(error).split()).rstrip(".")
        kind = "Parquet" if path.suffix.lower() == ".parquet" else "CSV"
        msg = (
            f"{path} does not hold a result: {reason}; a {kind} file with time as its first column is needed, as"
            " Result.write writes it."
        )
        raise OrchestrationError(msg) from error


def require_parquet(path: Path) -> None:
    """Refuse a file for streamed rows that has another suffix than ``.parquet``.

    Raises
    ------
    OrchestrationError
    """
    if path.suffix.lower() != ".parquet":
        given = path.suffix or "a file without a suffix"
        msg = f"{path}: rows are streamed as .parquet, not as {given}; for other formats, simulate and write."
        raise OrchestrationError(msg)


def _suffix_to_read(path: Path) -> str:
    """Suffix of a path, or `UNFINISHED` for the draft of a Parquet file."""
    if path.suffix == UNFINISHED and ".parquet." in path.name.lower():
        return UNFINISHED
    return _suffix(path, "read")


def _suffix(path: Path, done: str) -> str:
    """Suffix of a path in lower case; an error names the known suffixes."""
    suffix = path.suffix.lower()
    if suffix not in WRITERS:
        msg = f"{path}: results are {done} as .csv or .parquet, not as {path.suffix or 'a file without a suffix'}."
        raise OrchestrationError(msg)
    return suffix
