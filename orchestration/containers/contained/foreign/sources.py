"""Reads the C sources that an FMU of another tool brings, and refuses an FMU that no program can contain.

The sources are those of FMI 2.0.5, section 2.3: files below ``sources/``, of which modelDescription.xml lists those to
compile (``CoSimulation/SourceFiles``).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath

from orchestration.errors import ContainerError
from orchestration.fmi.codes import NEEDS_TOOL, STRING
from orchestration.fmi.display import listed
from orchestration.fmi.document import parsed, read_bytes
from orchestration.sandbox.archive import entry_names, read_entries
from orchestration.system.component import Component

SOURCES = "sources/"
RESOURCES = "resources/"
MOST_BYTES = 50_000_000
"""Bytes of all sources of an FMU, at the most."""
MOST_NAMES = 4
INCLUDABLE = re.compile(r"[\w.+/ -]+")
"""Paths that may stand between the quotation marks of an ``#include`` line."""
_ADVICE = "replace the component, or run the system without making a program of it"


@dataclass(frozen=True)
class ForeignSources:
    """The C sources of an FMU.

    Attributes
    ----------
    compiled
        Files to compile, by their paths below ``sources``.
    files
        Texts of all files by these paths. Bytes that are not UTF-8 are surrogates, as Python's ``surrogateescape``
        makes them.
    """

    compiled: tuple[str, ...]
    files: Mapping[str, str] = field(repr=False)


def read_sources(component: Component) -> ForeignSources:
    """Read the sources of a component's FMU.

    Raises
    ------
    ContainerError
        If the FMU brings no C sources, needs something that a program lacks, or a String of it has a start value in
        the system.
    ArchiveError
        If the archive is unsafe.
    """
    names = [name for name in entry_names(component.path) if not name.endswith("/")]
    _require_nothing_else(component, names)
    inside = [name.removeprefix(SOURCES) for name in names if name.startswith(SOURCES)]
    if not inside:
        has = "binaries only" if any(name.startswith("binaries/") for name in names) else "neither sources nor binaries"
        raise _refused(component, f"has {has}, and a program is made of C sources")
    compiled = _listed_files(component)
    if not compiled:
        raise _refused(component, "has sources, but its modelDescription.xml lists no SourceFiles to compile")
    for name in compiled:
        _require_c(component, name, inside)
    entries = read_entries(component.path, [SOURCES + name for name in inside], MOST_BYTES + 1)
    files = {name.removeprefix(SOURCES): content for name, content in entries}
    if sum(map(len, files.values())) > MOST_BYTES:
        raise _refused(component, f"has sources of more than {MOST_BYTES} bytes")
    return ForeignSources(compiled, {name: text.decode("utf-8", "surrogateescape") for name, text in files.items()})


def _require_nothing_else(component: Component, names: list[str]) -> None:
    """Refuse what runs only beside something that a program has not: a tool, files, or texts."""
    if component.description.can(NEEDS_TOOL):
        raise _refused(component, f"declares {NEEDS_TOOL}, and a program has no tool beside it")
    if resources := [name for name in names if name.startswith(RESOURCES)]:
        found = listed(resources, MOST_NAMES)
        raise _refused(component, f"has files that it may read while it runs ({found}), and a program has no files")
    texts = [name for name in component.start if component.variable(name).type == STRING]
    if texts:
        msg = (
            f"{component.name}: the system gives the String {texts[0]} a start value, and a program has no Strings;"
            f" leave it at the start value of {component.path.name}, or run the system without making a program of it."
        )
        raise ContainerError(msg)


def _listed_files(component: Component) -> tuple[str, ...]:
    """Files that the description lists for co-simulation, each once."""
    rows = parsed(read_bytes(component.path)).findall("CoSimulation/SourceFiles/File")
    return tuple(dict.fromkeys(row.get("name", "") for row in rows))


def _require_c(component: Component, name: str, inside: list[str]) -> None:
    if name not in inside:
        raise _refused(component, f"lists the source file {name!r}, which is not in its archive")
    suffix = PurePosixPath(name).suffix.lower()
    if suffix in (".cpp", ".cc", ".cxx", ".c++"):
        raise _refused(component, f"has the source file {name}, which is C++, and a program is made of C")
    if suffix != ".c":
        raise _refused(component, f"has the source file {name!r}, which is not a file of C")
    if not INCLUDABLE.fullmatch(name):
        raise _refused(component, f"has the source file {name!r}, whose name a program cannot include")


def _refused(component: Component, why: str) -> ContainerError:
    return ContainerError(f"{component.name}: {component.path.name} {why}; {_ADVICE}.")
