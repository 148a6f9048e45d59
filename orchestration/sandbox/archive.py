"""Safety checks of zip archives (FMU and SSP files), and safe unpacking.

FMU and SSP files come from strangers. An unsafe archive can overwrite files outside of the target folder
through ``../`` entries or links. An unsafe archive can also fill the disk: 2 MB can unpack to 2 GB. So every
archive is screened here before any of its files is unpacked, read or loaded.
"""

import hashlib
import stat
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.errors import ArchiveError
from orchestration.sandbox.missing import require_file

MAX_ENTRIES = 20_000
MAX_BYTES = 2 * 1024**3  # size of all entries after unpacking
MAX_RATIO = 1000  # unpacked over packed size of an entry; source code and tables reach 30, a zip bomb 1000
RATIO_FREE_BYTES = 1024**2  # the ratio of smaller entries is not limited
_READ_BY_PEOPLE = ("documentation/", "sources/")
# Exceptions of zipfile and zlib for a damaged archive.
UNREADABLE = (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, KeyError, RuntimeError)


def screen(path: Path) -> tuple[str, ...]:
    """Refuse an archive that is unsafe to unpack.

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
    with _opened(path) as archive:
        return tuple(_screen(path, archive))


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
        Existing folder.
    needed
        Returns, for the name of an entry, whether the entry is unpacked. Default: all entries.

    Raises
    ------
    ArchiveError
        If the archive is missing, invalid or unsafe.
    """
    with _opened(path) as archive:
        _screen(path, archive)
        try:
            archive.extractall(folder, [name for name in archive.namelist() if needed is None or needed(name)])
        except UNREADABLE as error:
            msg = f"{path} cannot be unpacked: {error}; it is damaged, so build or copy it again."
            raise ArchiveError(msg) from error


def file_hash(path: Path) -> str:
    """SHA-256 hash of a file as hexadecimal text."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def _opened(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open a zip archive, and close it at the end of the context."""
    require_file(path, "file")
    if not path.stat().st_size:
        msg = f"{path} is not a readable zip archive: it is empty; build or copy it again."
        raise ArchiveError(msg)
    try:
        archive = zipfile.ZipFile(path)
    except (zipfile.BadZipFile, NotImplementedError, OSError, ValueError) as error:
        msg = f"{path} is not a readable zip archive: {error}; it is damaged or of another kind, so copy it again."
        raise ArchiveError(msg) from error
    with archive:
        yield archive


def _screen(path: Path, archive: zipfile.ZipFile) -> list[str]:
    """Refuse an open archive that is unsafe to unpack; returns what breaks rules of form only."""
    entries = archive.infolist()
    if len(entries) > MAX_ENTRIES:
        msg = f"{path} has {len(entries)} entries, more than {MAX_ENTRIES}."
        raise ArchiveError(msg)
    total = sum(entry.file_size for entry in entries)
    if total > MAX_BYTES:
        msg = f"{path} would unpack to {total} bytes, more than {MAX_BYTES}."
        raise ArchiveError(msg)
    seen: dict[str, zipfile.ZipInfo] = {}
    formalities = []
    for entry in entries:
        fault = _fault(entry)
        if fault:
            msg = f"{path}: entry {entry.filename!r} {fault}."
            raise ArchiveError(msg)
        other = seen.setdefault(str(PurePosixPath(entry.filename)).casefold(), entry)  # ./a, a// and a are one file
        if other is entry:
            continue
        if not _harmless(entry, other):
            msg = f"{path}: entry {entry.filename!r} occurs more than once."
            raise ArchiveError(msg)
        formalities.append(f"The archive has the entries {other.filename!r} and {entry.filename!r}.")
    return formalities


def _harmless(entry: zipfile.ZipInfo, other: zipfile.ZipInfo) -> bool:
    """Whether two entries with one name cannot stand for two contents: folders, or pages whose names differ in case."""
    if entry.is_dir() and other.is_dir():
        return True
    names = [str(PurePosixPath(e.filename)) for e in (entry, other)]
    return names[0] != names[1] and all(name.startswith(_READ_BY_PEOPLE) for name in names)


def _fault(entry: zipfile.ZipInfo) -> str | None:
    """Predicate of a sentence on the fault of an entry; None if the entry is safe."""
    name = entry.orig_filename
    parts = PurePosixPath(name).parts
    if not name or "\\" in name or ":" in name or "\0" in name:
        return "has a character that a path in an archive must not have"
    if name.startswith("/") or ".." in parts:
        return "leads outside the archive"
    mode = entry.external_attr >> 16
    if stat.S_IFMT(mode) not in (0, stat.S_IFREG, stat.S_IFDIR):
        return "is a link or device"
    if entry.flag_bits & 0x1:
        return "is encrypted"
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return f"uses compression method {entry.compress_type}; only store and deflate are allowed"
    if entry.file_size > RATIO_FREE_BYTES and entry.file_size > MAX_RATIO * entry.compress_size:
        return f"unpacks from {entry.compress_size} to {entry.file_size} bytes, a zip bomb"
    return None
