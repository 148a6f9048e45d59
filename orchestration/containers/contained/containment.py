"""Takes the FMU of a component into a program: as it is if this project built it, else behind an adapter."""

from collections.abc import Iterable

from orchestration.containers.c_text import environment, identifier
from orchestration.containers.contained.contained_fmu import ContainedFmu, declared_variables
from orchestration.containers.contained.foreign.adapter import foreign_fmu
from orchestration.sandbox.archive import entry_names, file_hash, read_entries
from orchestration.system.component import Component

SOURCES = "sources/"
MOST_BYTES = 50_000_000
"""Bytes of all sources of an FMU, at the most."""
MARKS = ("contained.c", "contained.h", "state.h", "sizes.h", "model.c")
"""Files of the sources that tell an FMU of this project, which a program can contain without FMI's functions."""


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
    names = _sources(component)
    return _own(component, names, taken) if _has_marks(names) else foreign_fmu(component, taken)


def is_own(component: Component) -> bool:
    """Whether the FMU of a component brings the sources of this project's runtime."""
    return _has_marks(_sources(component))


def _sources(component: Component) -> list[str]:
    """Names of the archive's entries that are sources."""
    return [name for name in entry_names(component.path) if name.startswith(SOURCES) and not name.endswith("/")]


def _has_marks(sources: Iterable[str]) -> bool:
    return {name.removeprefix(SOURCES) for name in sources}.issuperset(MARKS)


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
