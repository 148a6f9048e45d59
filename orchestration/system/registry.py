"""Registry of the file formats and analyses that methods of a system call.

An entry is the text ``module:function``. The module of an entry is imported on first use. So the description of a
system does not import any file format or analysis.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from adaptimp_fmu.files.parts import imported
from orchestration.errors import SystemDescriptionError

if TYPE_CHECKING:
    from orchestration.system.system import System


@dataclass(frozen=True)
class Format:
    """A file format of systems.

    Attributes
    ----------
    read
        Entry of a function that takes a path, and the name of a variant or None, and returns a `System`.
    write
        Entry of a function that takes a `System` and a path, and returns the path.
    """

    read: str
    write: str


SSP = Format("orchestration.ssp.read:read_ssp", "orchestration.ssp.write:write_ssp")
FORMATS: dict[str, Format] = {".ssp": SSP}
"""File formats by suffix. A folder, and a file with another suffix, is read as an SSP package, and is not written."""

ANALYSES: dict[str, str] = {
    "stability": "orchestration.analysis.stability.verdict:stability",
    "prediction": "orchestration.analysis.stability.prediction:predict",
}
"""Entries of analyses by name. The first argument of an analysis is a `System`."""


@dataclass(frozen=True)
class Program:
    """A form of a system as one program.

    Attributes
    ----------
    write
        Entry of a function that takes a `System`, a path and options by name, and returns the path.
    suffix
        Suffix of the file that is written; empty if it is a folder.
    platforms
        Whether the function takes names of platforms, as ``platforms``.
    """

    write: str
    suffix: str = ""
    platforms: bool = False


CONTAINERS: dict[str, Program] = {
    "c": Program("orchestration.containers.c.form:write_c"),
    "fmu": Program("orchestration.containers.fmu.write:write_fmu", suffix=".fmu", platforms=True),
    "wasm": Program("orchestration.containers.wasm.module:write_wasm", suffix=".wasm"),
}
"""Forms of a system as one program, by name."""


def reader(path: Path) -> "Callable[[Path, str | None], System]":
    """Return the function that reads a system from a file with the suffix of a path."""
    return _load(FORMATS.get(path.suffix.lower(), SSP).read)


def writer(path: Path) -> "Callable[[System, Path], Path]":
    """Return the function that writes a system to a file with the suffix of a path.

    Raises
    ------
    SystemDescriptionError
        If there is no format with that suffix.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        msg = f"{path}: a system is written as {' or '.join(FORMATS)}, not as {suffix or 'a file without a suffix'}."
        raise SystemDescriptionError(msg)
    return _load(FORMATS[suffix].write)


def analysis(name: str) -> Callable[..., Any]:  # the arguments and the result differ between analyses
    """Return the function of an analysis by its name."""
    return _load(ANALYSES[name])


def program_writer(form: str) -> "Callable[..., Path]":
    """Return the function that writes a system as one program in a form, which `CONTAINERS` names."""
    return _load(CONTAINERS[form].write)


def _load(entry: str) -> Callable[..., Any]:
    """Import the module of an entry, and return the function of the entry."""
    module, _, function = entry.partition(":")
    return getattr(imported(module), function)
