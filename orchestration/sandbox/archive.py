"""The gate that every archive passes: FMUs, SSP packages, and archives in them are screened, then read or unpacked.

FMU and SSP files come from strangers. An unsafe archive can overwrite files outside of the target folder
through ``../`` entries or links. An unsafe archive can also fill the disk: 2 MB can unpack to 2 GB. So every
archive is screened here before any of its files is unpacked, read or loaded.
"""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.errors import ArchiveError
from orchestration.sandbox.missing import require_file
from orchestration.sandbox.zip.content import Content
from orchestration.sandbox.zip.nesting import look_inside
from orchestration.sandbox.zip.rules import Budget, RuleError, shown


def screen(path: Path) -> tuple[str, ...]:
    """Refuse an archive that is unsafe to unpack, or that holds such an archive; again only when the file has changed.

    Parameters
    ----------
    path
        Zip archive.

    Returns
    -------
    tuple of str
        A sentence for each rule of form that the archive breaks, and that makes it no less safe.

    Raises
    ------
    ArchiveError
        If the archive is missing, invalid or unsafe. The message names the file, the entry and the rule.
    """
    require_file(path, "file")
    status = path.stat()
    return _screened(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=256)
def _screened(path: Path, modified: int, size: int) -> tuple[str, ...]:  # noqa: ARG001 - the cache's key
    with _passed(path) as content:
        budget = Budget(size)
        budget.spend(len(content.entries), content.size)
        look_inside(content, budget)
        return content.formalities


@contextmanager
def unpacked(path: Path, needed: Callable[[str], bool] | None = None) -> Iterator[Path]:
    """Screen an archive and unpack it into a temporary folder that is removed at the end of the context.

    Parameters
    ----------
    path
        Zip archive.
    needed
        Returns, for the name of an entry, whether the entry is unpacked. Default: all entries.

    Yields
    ------
    Path
        Temporary folder.

    Raises
    ------
    ArchiveError
        If the archive is missing, invalid or unsafe.
    """
    with temporary_folder() as folder:
        unpack(path, folder, needed)
        yield folder


def unpack(path: Path, folder: Path, needed: Callable[[str], bool] | None = None) -> None:
    """Screen an archive and unpack it into an existing folder.

    Parameters
    ----------
    path
        Zip archive.
    folder
        Existing folder that nobody else writes to.
    needed
        Returns, for the name of an entry, whether the entry is unpacked. Default: all entries.

    Raises
    ------
    ArchiveError
        If the archive is missing, invalid or unsafe, or cannot be written to the folder.
    """
    screen(path)
    with _passed(path) as content:
        for entry in content.entries:
            if needed is not None and not needed(entry.name):
                continue
            target = folder.joinpath(PurePosixPath(entry.name))
            try:
                if entry.is_folder:
                    target.mkdir(parents=True, exist_ok=True)
                    continue
                target.parent.mkdir(parents=True, exist_ok=True)
                with target.open("wb") as file:
                    file.writelines(content.pieces(entry))
            except OSError as error:
                reason = error.strerror or type(error).__name__
                msg = f"{path} cannot be unpacked: entry {shown(entry.name)} cannot be written: {reason}."
                raise ArchiveError(msg) from error


def entry_names(path: Path) -> tuple[str, ...]:
    """Names of an archive's entries, in their order; the archive itself must be safe.

    Raises
    ------
    ArchiveError
        If the archive is missing, invalid or unsafe.
    """
    with _passed(path) as content:
        return tuple(entry.name for entry in content.entries)


def read_entries(path: Path, names: Sequence[str], most: int) -> Iterator[tuple[str, bytes]]:
    """Iterate over entries of an archive with their contents, until `most` bytes are read.

    Parameters
    ----------
    path
        Zip archive.
    names
        Names of entries. A name that the archive has not is left out.
    most
        Bytes of all contents. The contents that pass this limit are cut there, and are the last.

    Raises
    ------
    ArchiveError
        If the archive is missing, invalid or unsafe, or the contents are damaged.
    """
    with _passed(path) as content:
        entries = {entry.name: entry for entry in content.entries if not entry.is_folder}
        for name in names:
            if name in entries and most > 0:
                found = content.read(entries[name], most)
                most -= len(found)
                yield name, found


def file_hash(path: Path) -> str:
    """SHA-256 hash of a file as hexadecimal text."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def _passed(path: Path) -> Iterator[Content]:
    """Open an archive that keeps the rules, and close it at the end of the context.

    Within the context, a `RuleError` becomes the error of this archive.
    """
    require_file(path, "file")
    try:
        with _opened(path) as file:
            yield _content(path, file)
    except RuleError as error:
        joined = " " if str(error).startswith(("is ", "has ", "would ", "cannot ")) else ": "
        msg = f"{path}{joined}{error}."
        raise ArchiveError(msg) from error


def _opened(path: Path) -> BinaryIO:
    try:
        return path.open("rb")
    except OSError as error:
        msg = f"cannot be read: {error.strerror}"
        raise RuleError(msg) from error


def _content(path: Path, file: BinaryIO) -> Content:
    """The content of an open file that keeps the rules."""
    if not path.stat().st_size:
        msg = "is not a readable zip archive: it is empty; build or copy it again"
        raise RuleError(msg)
    return Content(file)
