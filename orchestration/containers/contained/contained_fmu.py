"""An FMU as a part of one program: its sources, and where its variables are in memory."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from orchestration.fmi.description import Description
from orchestration.fmi.document import Declared, Document, parsed, read_bytes


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


def declared_variables(path: Path) -> dict[str, Declared]:
    """Variables of an FMU by their names, with all that its description says of them."""
    return {variable.name: variable for variable in document_of(path).variables}


def document_of(path: Path) -> Document:
    """The description of an FMU, which was screened and validated when its component was made."""
    return Document(parsed(read_bytes(path)))
