"""The FMUs of a system as parts of one program: their sources, and where their variables are in memory."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from orchestration.containers.c_text import environment, identifier
from orchestration.fmi.description import Description
from orchestration.fmi.document import Declared, Document, parsed, read_bytes
from orchestration.sandbox.archive import entry_names, file_hash, read_entries
from orchestration.system.component import Component

SOURCES = "sources/"
MOST_BYTES = 50_000_000
"""Bytes of all sources of an FMU, at the most."""
MARKS = ("contained.c", "contained.h", "state.h", "sizes.h", "model.c")
"""Files of the sources that tell an FMU of this project, which a program can contain without FMI's functions."""


@dataclass(frozen=True)
class ContainedFmu:
    """An FMU as a part of a program. Several components may be instances of the same one.

    Attributes
    ----------
    name
        C identifier: prefix of the functions and of the type of the state, and name of the files.
    path, sha256
        The FMU file and its hash.
    description
        Content of modelDescription.xml.
    declared
        Variables with all that modelDescription.xml says of them, by their names in the FMU.
    places
        Index in the state's ``values``, by the name of a variable in the FMU.
    header, source
        Text of the files ``NAME.h`` and ``NAME.c``.
    sources
        Files in the folder ``NAME``, by their paths below it: those of the FMU's own ``sources``.
    plain
        Whether the state is plain data, so that a copy of it is a snapshot.
    tests_outputs
        Whether a step fails if an output is not finite, so that what takes its value from an output needs no test.
    wrappers
        More files beside ``NAME.c`` that are compiled; each includes a source file of an FMU of another tool.
    needed
        Functions of the C library that the sources call; none if the FMU is of this project.
    fmi_headers
        Whether the compiler must find FMI's header files, which the sources do not bring.
    saves
        Whether a state that is not plain data can be saved and restored.
    """

    name: str
    path: Path
    sha256: str
    description: Description
    declared: Mapping[str, Declared]
    places: Mapping[str, int]
    header: str
    source: str
    sources: Mapping[str, str] = field(repr=False)
    plain: bool = True
    tests_outputs: bool = True
    wrappers: Mapping[str, str] = field(default_factory=dict, repr=False)
    needed: tuple[str, ...] = ()
    fmi_headers: bool = False
    saves: bool = False


def contained_fmu(component: Component, taken: Iterable[str]) -> ContainedFmu:
    """Return the FMU of a component as a part of a program.

    Parameters
    ----------
    component
        Component whose FMU is contained; messages name it.
    taken
        Identifiers that others have.

    Raises
    ------
    ContainerError
        If the FMU does not bring the sources that a program needs.
    ArchiveError
        If the archive is unsafe.
    """
    path = component.path
    names = [name for name in entry_names(path) if name.startswith(SOURCES) and not name.endswith("/")]
    if {name.removeprefix(SOURCES) for name in names}.issuperset(MARKS):
        return _own(component, names, taken)
    from orchestration.containers.foreign_fmu import foreign_fmu

    return foreign_fmu(component, taken)


def _own(component: Component, names: list[str], taken: Iterable[str]) -> ContainedFmu:
    """An FMU of this project, whose runtime has a form without FMI."""
    path, description = component.path, component.description
    name = identifier(description.identifier, taken, "Fmu")
    declared = declared_variables(path)
    templates = environment()
    return ContainedFmu(
        name,
        path,
        file_hash(path),
        description,
        declared,
        places={variable.name: variable.reference for variable in declared.values()},
        header=templates.get_template("fmu.h.j2").render(name=name, model=description.model_name),
        source=templates.get_template("fmu.c.j2").render(name=name, model=description.model_name),
        sources={
            entry.removeprefix(SOURCES): content.decode("utf-8", "surrogateescape")
            for entry, content in read_entries(path, names, MOST_BYTES)
        },
    )


def declared_variables(path: Path) -> dict[str, Declared]:
    """Variables of an FMU by their names, with all that its description says of them."""
    return {variable.name: variable for variable in document_of(path).variables}


def document_of(path: Path) -> Document:
    """The description of an FMU, which was screened and validated when its component was made."""
    return Document(parsed(read_bytes(path)))
