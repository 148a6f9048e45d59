"""Parquet files of finished runs in a folder, which any number of processes add to; a file is whole and never changes.

A file is named by the hash of its content. It is written as a draft elsewhere and appears in one step, so a killed
process leaves no unfinished file. Many small files become one by `merge`: the file with all of their rows appears
first, and then the small ones go. So each row is in some file at every moment, whoever else adds, merges or dies.
A reader that misses a file which has just gone looks again, because the rows are in a newer file by then.
"""

import hashlib
import os
import secrets
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from adaptimp_fmu.files.locks import lock_of_dead_owner, locked_new_file
from orchestration.campaigns.store.row_table import FORMAT, MARK, without_duplicates
from orchestration.errors import StoreError, warn_caller

if TYPE_CHECKING:
    import pyarrow as pa

SUFFIX, DRAFT = ".parquet", ".part"
GROUP_ROWS = 2**16
"""Largest number of runs in a group of rows."""
FEW_ROWS = 4096
"""Number of runs below which a file is packed by snappy, which takes a third of zstd's time and more space."""
_NAME = 24  # hexadecimal digits of a file's name


class StoreWarning(UserWarning):
    """Warning of a file in a store that cannot be read, or of small files that could not be merged."""


class Place(NamedTuple):
    """Where the files of one study are.

    Attributes
    ----------
    rows
        Folder of the whole files.
    drafts
        Folder of the drafts, on the same file system.
    """

    rows: Path
    drafts: Path


@contextmanager
def store_errors(path: Path) -> Iterator[None]:
    """Convert an error of the operating system during writing into an error of the store.

    Raises
    ------
    StoreError
        If something cannot be written.
    """
    try:
        yield
    except OSError as error:
        msg = (
            f"{path}: the store cannot be written: {error.strerror or error}; make room or choose another place,"
            " and resume: all runs that were written are kept."
        )
        raise StoreError(msg) from error


def write_rows(place: Place, table: "pa.Table", *, on_disk: bool = False) -> Path:
    """Write a table as a new file, which is there for good when this function returns, whatever ends the process.

    Parameters
    ----------
    place
        Where the file goes.
    table
        Rows of the file.
    on_disk
        Whether to wait until the disk has the file, so that not even a loss of power costs the file.

    Returns
    -------
    Path
        Path of the file.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    content = _parquet(table)
    path = place.rows / _name(content)
    draft, descriptor = _draft(place.drafts)
    try:
        with os.fdopen(descriptor, "wb") as file:  # its lock says that the draft has a living owner
            file.write(content)
            file.flush()
            if on_disk:
                os.fsync(descriptor)
            if os.name != "nt":
                draft.replace(path)
        if os.name == "nt":  # there an open file cannot be moved
            draft.replace(path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    return path


def remove_drafts_of_dead_processes(drafts: Path) -> None:
    """Remove the drafts that killed processes left; none of them has a run that was said to be written."""
    for path in sorted(drafts.glob(f"*{DRAFT}")):
        descriptor = lock_of_dead_owner(path)
        if descriptor is not None:
            with suppress(OSError):  # what cannot be removed does no harm
                path.unlink(missing_ok=True)
            os.close(descriptor)


def read_rows(folder: Path, columns: Sequence[str] | None = None) -> Iterator["tuple[Path, pa.Table]"]:
    """Read the tables in a folder, also while other processes add files and merge them.

    A file that is damaged or no file of a store causes a `StoreWarning`, and stays where it is.

    Parameters
    ----------
    folder
        Folder of the files.
    columns
        Columns to read. Files that lack one of them are left out. Default: all columns.

    Yields
    ------
    tuple
        Path and table of each file. A run may be in several tables.
    """
    seen: set[Path] = set()
    while True:
        new = [path for path in sorted(folder.glob(f"*{SUFFIX}")) if path not in seen]
        if not new:
            return
        for path in new:
            try:
                table = _read(path, columns)
            except FileNotFoundError:  # another process has merged it; the next look finds the new file
                if path.is_symlink():  # it stays listed for good, while what others write are plain files
                    seen.add(path)
                    _warn_of(path, "is a link to a file that is not there")
                continue
            seen.add(path)
            if table is not None:
                yield path, table


def read_study(folder: Path) -> "dict[Path, pa.Table]":
    """Read all tables of one study, by file; a file with other columns than most rows have causes a `StoreWarning`."""
    found, rows = dict(read_rows(folder)), Counter[str]()
    for table in found.values():
        rows[str(table.schema)] += table.num_rows
    common = max(rows, key=rows.__getitem__, default="")
    for path in [path for path, table in found.items() if str(table.schema) != common]:
        warn_caller(f"{path} has other columns than the files beside it; move it elsewhere.", StoreWarning)
        del found[path]
    return found


def merge(place: Place) -> None:
    """Make one file of all files in a folder; rows in the order of their numbers, each once.

    Files that are damaged, or of something else, stay as they are.

    Raises
    ------
    OSError
        If the file cannot be written. Then all files stay as they are.
    """
    found = read_study(place.rows)
    if len(found) < 2:
        return
    replace_rows(place, list(found), without_duplicates(list(found.values())))


def replace_rows(place: Place, old: Sequence[Path], table: "pa.Table") -> Path:
    """Write a table that has all rows of some files, and remove these files afterwards.

    Raises
    ------
    OSError
        If the file cannot be written. Then all files stay as they are.
    """
    new = write_rows(place, table, on_disk=True)
    for path in old:
        if path != new:
            with suppress(OSError):  # another process reads it (Windows); its rows are in the new one
                path.unlink(missing_ok=True)
    return new


def _parquet(table: "pa.Table") -> bytes:
    """Bytes of a Parquet file; the same table gives the same bytes."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    sink, texts = pa.BufferOutputStream(), [field.name for field in table.schema if pa.types.is_string(field.type)]
    packing: dict[str, Any] = {
        "compression": "snappy" if table.num_rows < FEW_ROWS else "zstd",
        "use_dictionary": texts,
    }
    with ParquetWriter(sink, table.schema, **packing) as writer:
        writer.write_table(table, GROUP_ROWS)
    return sink.getvalue().to_pybytes()


def _name(content: bytes) -> str:
    """Name of a file with a content."""
    return f"{hashlib.sha256(content).hexdigest()[:_NAME]}{SUFFIX}"


def _draft(folder: Path) -> tuple[Path, int]:
    """Path and descriptor of a new draft, locked by this process."""
    while True:
        path = folder / f"{secrets.token_hex(8)}{DRAFT}"
        with suppress(FileExistsError):
            descriptor = locked_new_file(path)
            if descriptor is not None:
                return path, descriptor


def _read(path: Path, columns: Sequence[str] | None) -> "pa.Table | None":
    """The table of a file; None if it lacks columns, or with a warning if it cannot be used."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetFile

    try:
        content = path.read_bytes()
        if _name(content) == path.name:
            with ParquetFile(pa.BufferReader(content)) as source:
                version = (source.metadata.metadata or {}).get(MARK, b"none")
                if version == FORMAT:
                    lacking = columns is not None and not set(columns) <= set(source.schema_arrow.names)
                    return None if lacking else source.read(None if columns is None else list(columns))
                refusal = f"has format {version.decode(errors='replace')}, not {FORMAT.decode()}"
        else:
            refusal = "is damaged, or is no file of a store"
    except FileNotFoundError:
        raise
    except (pa.ArrowException, OSError, ValueError) as error:
        refusal = f"cannot be read ({error})"
    _warn_of(path, refusal)
    return None


def _warn_of(path: Path, refusal: str) -> None:
    """Warn of a file that cannot be used."""
    msg = f"{path} {refusal}; its runs are made anew where they are asked for. Move the file elsewhere."
    warn_caller(msg, StoreWarning)
