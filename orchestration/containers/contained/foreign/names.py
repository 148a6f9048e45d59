"""Gives the C sources of a stranger names of their own, so that several strangers share one program without a clash.

Each source file is compiled by a small file that includes it after ``#define`` lines for every name that the linker
would see: FMI's functions become ``NAME_fmi2DoStep``, and ``helper`` becomes ``NAME_helper``. One such file for each
source file keeps static functions and macros of two files apart, as the stranger's own compiler does. The names come
from a first compilation; a second one shows that no other name is left.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.containers.c_text import environment
from orchestration.containers.contained.foreign.compiler import (
    HEADER,
    Compiled,
    UnfitSourcesError,
    compiled,
    write_below,
)
from orchestration.containers.contained.foreign.sources import ForeignSources
from orchestration.errors import ContainerError
from orchestration.fmi.display import listed
from orchestration.sandbox.archive import file_hash
from orchestration.system.component import Component

MOST_NAMES = 4
_STEP = "fmi2DoStep"
_IDENTIFIER = re.compile(r"[^\W\d]\w*")
_OF_COMPILER = frozenset({"memcpy", "memset", "memmove", "memcmp", "_GLOBAL_OFFSET_TABLE_"})


@dataclass(frozen=True)
class RenamedSources:
    """Files that compile a stranger's sources under names of their own.

    Attributes
    ----------
    wrappers
        Texts of these files by name; they lie beside the folder of the sources.
    functions
        FMI's functions that the sources define, without the prefix.
    needed
        Functions of the C library that the sources call.
    own_headers
        Whether the sources bring FMI's headers themselves, or use none.
    """

    wrappers: Mapping[str, str]
    functions: frozenset[str]
    needed: frozenset[str]
    own_headers: bool


def rename(component: Component, name: str, sources: ForeignSources) -> RenamedSources:
    """Find the names that a stranger's sources define, and write the files that change them.

    Parameters
    ----------
    component
        Component that messages name.
    name
        C identifier that begins all names, and is the folder of the sources.

    Raises
    ------
    ContainerError
        If the sources do not compile by themselves, or keep names of other files.
    """
    description = component.description
    work = _Work(file_hash(component.path), name, description.identifier, description.model_name, sources)
    try:
        return _renamed(work)
    except UnfitSourcesError as error:
        msg = f"{component.name}: the sources of {component.path.name} {error}."
        raise ContainerError(msg) from error


@dataclass(frozen=True)
class _Work:
    """Sources to rename; the hash of their FMU stands for them in comparisons."""

    sha256: str
    name: str
    identifier: str
    model: str
    sources: ForeignSources = field(compare=False)

    def wrapper(self, file: str, header: str | None = None, renames: Iterable[tuple[str, str]] = ()) -> str:
        """Text of the file that compiles a source file."""
        template = environment().get_template("foreign_source.c.j2")
        return template.render(name=self.name, file=file, model=self.model, header=header, renames=list(renames))


@lru_cache(maxsize=64)
def _renamed(work: _Work) -> RenamedSources:
    files = work.sources.compiled
    with temporary_folder() as home:
        folder = home / "program"
        write_below(folder / work.name, work.sources.files)
        first = {file: compiled(work.wrapper(file), folder, home) for file in files}
        defined = frozenset().union(*(found.names.defined for found in first.values()))
        prefix = _prefix(defined, work.identifier)
        functions = {old.removeprefix(prefix) for old in defined if old.startswith(f"{prefix}fmi2")}
        renames = _renames(defined, prefix, work.name)
        wrappers = {file: work.wrapper(file, first[file].header, renames.items()) for file in files}
        second = {file: compiled(text, folder, home) for file, text in wrappers.items()}
    _require_renamed(second, renames, work.name)
    called = frozenset().union(*(found.names.undefined for found in second.values()))
    return RenamedSources(
        {f"{work.name}.source{i}.c": text for i, text in enumerate(wrappers.values(), start=1)},
        frozenset(functions),
        called - frozenset(renames.values()) - _OF_COMPILER,
        HEADER not in (found.header for found in first.values()),
    )


def _prefix(defined: frozenset[str], identifier: str) -> str:
    """Return the prefix under which sources define FMI's functions: empty, or as FMI 2.0.5, section 2.1.1, has it."""
    found = sorted(name.removesuffix(_STEP) for name in defined if name.endswith(_STEP))
    return next((prefix for prefix in ("", f"{identifier}_") if prefix in found), (found or [""])[0])


def _renames(defined: Iterable[str], prefix: str, name: str) -> dict[str, str]:
    """New names by old ones. Names without prefix are among them, since FMI's headers may add the prefix.

    An assembler's name can be any text. Only identifiers may stand in the C text of a program.
    """
    found = {}
    for old in filter(_IDENTIFIER.fullmatch, sorted(defined)):
        function = old.removeprefix(prefix) if old.startswith(f"{prefix}fmi2") else old
        found[old] = found[function] = f"{name}_{function}"
    return found


def _require_renamed(objects: Mapping[str, Compiled], renames: Mapping[str, str], name: str) -> None:
    """Refuse sources that define a name which the ``#define`` lines did not reach."""
    own = frozenset(renames.values())
    for file, found in objects.items():
        if left := sorted(found.names.defined - own):
            msg = (
                f"define {listed(left, MOST_NAMES)} in {file} by means that a macro does not reach, so other components"
                f" could clash with that; such names need the prefix {name}_"
            )
            raise UnfitSourcesError(msg)
