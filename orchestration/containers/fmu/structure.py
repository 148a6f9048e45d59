"""Finds what the outputs of a system depend on, through its connections.

An output depends on inputs of its component, as the FMU declares. An input that is connected depends on the
output that drives it; one that is not is an input of the whole system. So each output depends on a set of unconnected
inputs, and in initialization mode on a set of parameters as well.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from orchestration.fmi.document import INITIAL_UNKNOWNS, OUTPUTS, Document
from orchestration.system.system import System

Name = tuple[str, str]
"""Component and variable, the latter as the FMU calls it."""


@dataclass(frozen=True)
class Structure:
    """What each output of a system depends on: unconnected inputs, and parameters during initialization.

    Attributes
    ----------
    in_step
        After initialization: inputs that reach the output at the same communication point.
    initial
        During initialization: parameters, inputs and local variables, some of which a container shows as parameters.
    """

    in_step: Mapping[Name, frozenset[Name]]
    initial: Mapping[Name, frozenset[Name]]


def structure(system: System, documents: Mapping[str, Document]) -> Structure:
    """Return what the outputs of a system depend on.

    Parameters
    ----------
    system
        The components and their connections.
    documents
        Description of each component's FMU, by the name of the component.
    """
    driving: dict[Name, Name] = {}
    for c in system.connections:
        output = system.component(c.source).variable(c.output).fmu_name
        input_ = system.component(c.target).variable(c.input).fmu_name
        driving[c.target, input_] = (c.source, output)
    outputs = [(name, v.name) for name, document in documents.items() for v in document.of_causality("output")]

    def through(rows: Mapping[Name, frozenset[Name]]) -> dict[Name, frozenset[Name]]:
        return {output: _reached(output, rows, driving) for output in outputs}

    return Structure(
        through(_rows(documents, OUTPUTS, ("input",))),
        through(_rows(documents, INITIAL_UNKNOWNS, ("input", "parameter", "local"))),
    )


def _rows(
    documents: Mapping[str, Document], listing: str, causalities: Iterable[str]
) -> Mapping[Name, frozenset[Name]]:
    """What outputs depend on within their components; an FMU that does not say so declares all (FMI 2.0.5, 2.2.8)."""
    found: dict[Name, frozenset[Name]] = {}
    for component, document in documents.items():
        known = {v.index: v.name for v in document.variables if v.causality in causalities}
        declared = {row.index: row.dependencies for row in document.unknowns(listing)}
        for output in document.of_causality("output"):
            indices = declared.get(output.index)
            names = known.values() if indices is None else (known[i] for i in indices if i in known)
            found[component, output.name] = frozenset((component, name) for name in names)
    return found


def _reached(output: Name, rows: Mapping[Name, frozenset[Name]], driving: Mapping[Name, Name]) -> frozenset[Name]:
    """Unconnected inputs, and parameters, that an output depends on in any number of components."""
    seen, waiting, reached = {output}, [output], set()
    while waiting:
        for name in rows[waiting.pop()]:
            source = driving.get(name)
            if source is None:
                reached.add(name)
            elif source not in seen:
                seen.add(source)
                waiting.append(source)
    return frozenset(reached)
