"""Builds an .fmu file from a model: generates and compiles C code, and zips it. Old binaries come from a cache.

Same definition, same bytes: entries of the archive have a fixed order and date, and the GUID is a
hash of the definition and the runtime. Reference runs and parameter sets lie beside the definition, in ``extra/``:
the GUID and the binaries do not depend on them.
"""

import hashlib
import io
import uuid
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from adaptimp_fmu.binary import binary, cached
from adaptimp_fmu.codegen import (
    EQUATIONS_SOURCE,
    GUID_PLACEHOLDER,
    MAIN_SOURCE,
    SIZES_SOURCE,
    generate,
)
from adaptimp_fmu.description import model_description
from adaptimp_fmu.documentation import documentation
from adaptimp_fmu.files.cache_folder import cache_folder
from adaptimp_fmu.files.cache_use import use
from adaptimp_fmu.files.whole_file import write_whole
from adaptimp_fmu.icon import png
from adaptimp_fmu.model import Model
from adaptimp_fmu.reals import as_reals
from adaptimp_fmu.related_files import archive_entries, related_files
from adaptimp_fmu.runtime_files import RUNTIME_LICENSE, runtime_license
from adaptimp_fmu.terminals import terminals_entry
from adaptimp_fmu.toolchain import Platform, host_platform

_EPOCH = (1980, 1, 1, 0, 0, 0)
_REGULAR_FILE = 0o100644 << 16


def default_cache() -> Path:
    """Return the folder that keeps binaries between builds: ``$ADAPTIMP_CACHE`` or the user's cache folder.

    Where nothing can be written to the folder, `build` uses a temporary one, and warns once.

    Examples
    --------
    >>> from adaptimp_fmu import default_cache
    >>> default_cache().is_absolute()
    True
    """
    return cache_folder()


def build(
    model: Model,
    folder: Path | None = None,
    platforms: Iterable[Platform] | None = None,
    cache: Path | None = None,
    *,
    reals: bool = False,
) -> Path:
    """Build the file ``NAME.fmu`` from a model.

    Parameters
    ----------
    folder
        Folder for the file; None takes a folder in the cache that is named by the content.
    platforms
        Platforms with a binary in the FMU; the host's if None.
    cache
        Folder of compiled binaries by content hash, see `default_cache`.
    reals
        Whether Booleans are Reals of 0 and 1, and Integers Reals of whole numbers, for tools that know Reals only.
        The file has the same name as without, so it belongs into another folder. Other values are refused: of a
        parameter when it is set, of an input when initialization ends and at each step.

    Returns
    -------
    Path
        The file. It is only written when its content changes.

    Raises
    ------
    DefinitionError, ToolchainError

    Examples
    --------
    >>> from pathlib import Path
    >>> from adaptimp_fmu import ContinuousModel, build
    >>> clock = ContinuousModel("Clock", "Time as an output")
    >>> clock.output("t", clock.time, unit="s", description="Time")
    >>> build(clock, Path("built")).as_posix()
    'built/Clock.fmu'

    A switch as a Boolean, and for tools without Booleans as a Real of 0 and 1:

    >>> from adaptimp_fmu import Type
    >>> on = clock.input("on", 1, type=Type.BOOLEAN, description="Switch")
    >>> build(clock, Path("built/reals"), reals=True).as_posix()
    'built/reals/Clock.fmu'
    """
    model = as_reals(model) if reals else model
    sources, description = definition(model)
    entries = {"modelDescription.xml": description, "model.png": png(model.icon)}
    for platform in sorted(platforms or [host_platform()], key=lambda p: p.name):
        library = binary(model.name, sources, platform, compiled=[MAIN_SOURCE], cache=cache)
        entries[f"binaries/{platform.name}/{model.name}{platform.extension}"] = library
    for name, text in sources.items():
        entries[f"sources/{name}"] = text.encode()
    entries[f"sources/{RUNTIME_LICENSE}"] = _license_notice().encode()
    related = related_files(model)
    entries |= {f"documentation/{name}": content for name, content in documentation(model, related).items()}
    entries |= terminals_entry(model)
    entries |= archive_entries(related)
    content = archive(entries)
    if folder is None:
        folder = cached(cache, ("fmus", hashlib.sha256(content).hexdigest()[:32]), f"{model.name}.fmu")
        use(cache or cache_folder(), *folder.parts[-2:])
    path = folder / f"{model.name}.fmu"
    if not path.exists() or path.read_bytes() != content:
        write_whole(path, content)
    return path


def definition(model: Model) -> tuple[dict[str, str], bytes]:
    """C sources by name and modelDescription.xml, both with the GUID filled in."""
    sources = generate(model)
    draft = model_description(model, GUID_PLACEHOLDER, [MAIN_SOURCE])
    digest = hashlib.sha256(draft)
    for name, text in sorted(sources.items()):
        digest.update(f"\0{name}\0{text}".encode())
    guid = "{" + str(uuid.UUID(bytes=digest.digest()[:16])) + "}"
    sources[MAIN_SOURCE] = sources[MAIN_SOURCE].replace(GUID_PLACEHOLDER, guid)
    return sources, draft.replace(GUID_PLACEHOLDER.encode(), guid.encode())


def _license_notice() -> str:
    """License of the runtime, and the files that it does not cover."""
    scope = (
        f"This license covers the runtime, which is every file in this folder but {MAIN_SOURCE}, {SIZES_SOURCE} and\n"
        f"{EQUATIONS_SOURCE}. Those files are generated from the model and belong to the model's owner.\n\n"
    )
    return scope + runtime_license()


def archive(entries: Mapping[str, bytes]) -> bytes:
    """Return a zip file whose bytes depend on its entries alone."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in entries.items():
            info = zipfile.ZipInfo(name, _EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = _REGULAR_FILE
            info.create_system = 3  # Unix, whatever the machine
            file.writestr(info, content)
    return buffer.getvalue()
