"""Unpacks SSP packages into the cache, once, and looks whether what is there is still what was unpacked.

    ssp/<hash of the package>/files/       the unpacked files
    ssp/<hash of the package>/manifest     their sizes and checksums, sealed

Both appear in one step of the file system, so a run never sees a part of them.
"""

import json
import logging
import zlib
from contextlib import suppress
from pathlib import Path

from adaptimp_fmu.files.cache_folder import cache_folder, is_trusted, writable_cache
from adaptimp_fmu.files.cache_use import use
from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed
from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.sandbox.archive import file_hash, unpack

_LOG = logging.getLogger(__name__)
FOLDER, FILES, MANIFEST = "ssp", "files", "manifest"
_BLOCK = 2**20  # bytes that are read at a time


def unpacked_package(path: Path) -> tuple[Path, bool]:
    """Return the folder in the cache with the unpacked files of a package, and whether they were unpacked just now.

    The package is unpacked if the cache does not hold it, or does not hold it as it was unpacked: a file was emptied,
    altered, removed or added, or belongs to another user.

    Raises
    ------
    ArchiveError
        If the package is invalid or unsafe.
    OSError
        If the folder cannot be written.
    """
    name = file_hash(path)[:32]
    kept = cache_folder() / FOLDER / name
    use(cache_folder(), FOLDER, name)
    if _is_intact(kept):
        return kept / FILES, False
    writable = writable_cache(FOLDER) / name
    use(cache_folder(), FOLDER, name)
    if writable != kept and _is_intact(writable):
        return writable / FILES, False
    return writable / FILES, _unpack(path, writable)


def _unpack(path: Path, kept: Path) -> bool:
    """Unpack a package to its folder in the cache; returns False if another run was faster."""
    with temporary_folder(kept.parent) as scratch:
        fresh = scratch / "fresh"
        (fresh / FILES).mkdir(parents=True)
        unpack(path, fresh / FILES)
        write_sealed(fresh / MANIFEST, json.dumps(_manifest(fresh / FILES)).encode())
        if _is_intact(kept):  # another run was faster
            return False
        if kept.exists():
            _LOG.info("%s is damaged in the cache, and is unpacked again", path)
            with suppress(OSError):  # another run repairs it, too
                kept.rename(scratch / "damaged")
        try:
            fresh.rename(kept)
        except OSError:  # another run was faster by a moment
            return False
    return True


def forget_package(files: Path) -> None:
    """Remove the unpacked files of a package, in a folder that `unpacked_package` returned, from the cache."""
    kept = files.parent
    with suppress(OSError), temporary_folder(kept.parent) as scratch:
        kept.rename(scratch / "refused")


def _is_intact(kept: Path) -> bool:
    """Whether a folder holds the files of its manifest, and no others."""
    if not is_trusted(kept):
        return False
    content = read_sealed(kept / MANIFEST)
    try:
        return content is not None and json.loads(content) == _manifest(kept / FILES)
    except OSError:  # a file that cannot be read
        return False


def _manifest(folder: Path) -> dict[str, list[int]]:
    """Size in bytes and checksum of each file below a folder, by its path in there."""
    files = sorted(path for path in folder.rglob("*") if not path.is_dir())
    return {path.relative_to(folder).as_posix(): _fingerprint(path) for path in files}


def _fingerprint(path: Path) -> list[int]:
    """Size in bytes and CRC-32 of a file. The checksum finds damage; other users are kept out by their ownership."""
    size = checksum = 0
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            size, checksum = size + len(block), zlib.crc32(block, checksum)
    return [size, checksum]
