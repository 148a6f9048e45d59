"""Compiles C sources to a binary, or takes the binary from the cache, where binaries are named by their content."""

import hashlib
import logging
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter

from adaptimp_fmu.files.cache_folder import cache_folder, is_trusted, writable_cache
from adaptimp_fmu.files.sealed_file import read_sealed, write_sealed
from adaptimp_fmu.files.temporary_folder import temporary_folder
from adaptimp_fmu.toolchain import Platform, compile_library, identity

_LOG = logging.getLogger(__name__)
"""Says at level DEBUG what begins, at level INFO what was done."""


def binary(
    name: str,
    sources: Mapping[str, str],
    platform: Platform,
    *,
    compiled: Sequence[str],
    libraries: Sequence[str] = (),
    cache: Path | None = None,
) -> bytes:
    """Return the binary of some C sources for a platform.

    Parameters
    ----------
    name
        File name of the binary, without its suffix.
    sources
        Texts by file name; a name may have folders, as in ``fmus/Plant.c``. Bytes that are not UTF-8 are surrogates in
        the texts, as ``surrogateescape`` makes them.
    compiled
        Names of the sources that are compiled. These include the other sources.
    libraries
        Names of libraries that the sources need besides the C library, such as ``m``.
    cache
        Folder of compiled binaries; None takes that of `adaptimp_fmu.default_cache`.

    Raises
    ------
    ToolchainError
        If the compiler refuses the sources.
    """
    key = hashlib.sha256(f"{identity()} {platform} {' '.join([*compiled, *libraries])}".encode())
    for source, text in sorted(sources.items()):
        key.update(f"\0{source}\0".encode() + _bytes(text))
    file = f"{name}{platform.extension}"
    kept_at = cached(cache, ("binaries", key.hexdigest()[:32], platform.name), file) / file
    if (kept := read_sealed(kept_at)) is not None:
        _LOG.info("%s for %s: the binary is in the cache, %s", name, platform.name, kept_at)
        return kept
    _LOG.debug("compiling %s for %s, once", name, platform.name)
    started = perf_counter()
    with temporary_folder() as folder:
        for source, text in sources.items():
            (folder / source).parent.mkdir(parents=True, exist_ok=True)
            (folder / source).write_bytes(_bytes(text))
        output = folder / file
        compile_library([folder / source for source in compiled], output, platform, libraries)
        content = output.read_bytes()
    write_sealed(kept_at, content)
    _LOG.info("compiled %s for %s in %.3g s", name, platform.name, perf_counter() - started)
    return content


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogateescape")


def cached(cache: Path | None, parts: tuple[str, ...], file: str) -> Path:
    """Folder of a file in the cache, which is there already or can be written to."""
    if cache is not None:
        return cache.joinpath(*parts)
    present = cache_folder().joinpath(*parts)
    return present if is_trusted(present / file) else writable_cache(*parts)
