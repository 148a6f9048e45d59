"""In which order the components of a program compute their outputs during initialization.

An output may depend on some inputs of its component only. So a component may have to compute its outputs more than
once: first those that depend on no other component, later the others. The order is found when the program is made:

    until every output is settled:
        for each component, in the order of the system:
            if all inputs of a further output are settled: the component computes, and its settled outputs are copied
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from orchestration.errors import ContainerError
from orchestration.fmi.display import listed
from orchestration.fmi.document import INITIAL_UNKNOWNS, Document
from orchestration.system.system import Connection, System

Path = tuple[str, str]  # component, variable
MOST_SHOWN = 10
"""Connections of a cycle that a message shows."""


@dataclass(frozen=True)
class Pass:
    """A component computes its outputs, then connections copy those that are settled.

    Attributes
    ----------
    component
        Name of the component.
    connections
        Connections whose outputs are settled by this pass.
    """

    component: str
    connections: tuple[Connection, ...]


def initial_order(system: System, dependencies: Mapping[str, Mapping[str, Collection[str]]]) -> tuple[Pass, ...]:
    """Return the passes of the initialization.

    Parameters
    ----------
    system
        System that is initialized.
    dependencies
        Inputs that each output depends on during initialization, by component and output.

    Raises
    ------
    ContainerError
        If outputs depend on each other in a cycle; the message names its connections.
    """
    sources = {(c.target, c.input): c for c in system.connections}
    leaving: dict[str, list[Connection]] = {}
    for connection in system.connections:
        leaving.setdefault(connection.source, []).append(connection)
    waiting = {
        name: {output: {i for i in inputs if (name, i) in sources} for output, inputs in of_component.items()}
        for name, of_component in dependencies.items()
    }
    passes: list[Pass] = []
    settled: set[Path] = set()  # inputs
    while any(waiting.values()):
        before = len(passes)
        for name in system:
            done = {o for o, inputs in waiting[name].items() if all((name, i) in settled for i in inputs)}
            if not done:
                continue
            for output in done:
                del waiting[name][output]
            copied = tuple(c for c in leaving.get(name, ()) if c.output in done)
            settled |= {(c.target, c.input) for c in copied}
            passes.append(Pass(name, copied))
        if len(passes) == before:
            raise _cycle(system, waiting, sources, settled)
    return tuple(one for i, one in enumerate(passes) if one.connections or _last(passes, i))


def _last(passes: Sequence[Pass], i: int) -> bool:
    """Whether no later pass is one of the same component."""
    return all(other.component != passes[i].component for other in passes[i + 1 :])


def _cycle(
    system: System,
    waiting: Mapping[str, Mapping[str, Collection[str]]],
    sources: Mapping[Path, Connection],
    settled: Collection[Path],
) -> ContainerError:
    """The error of outputs that wait for each other."""
    name = next(name for name, outputs in waiting.items() if outputs)
    at = (name, next(iter(waiting[name])))
    way: list[Connection] = []
    seen: dict[Path, int] = {}
    while at not in seen:
        seen[at] = len(way)
        component, output = at
        wanted = next(i for i in sorted(waiting[component][output]) if (component, i) not in settled)
        connection = sources[component, wanted]
        way.append(connection)
        at = (connection.source, connection.output)
    cycle: Sequence[str] = [str(c) for c in reversed(way[seen[at] :])]
    return ContainerError(
        f"System {system.name}: outputs depend on each other during initialization in the cycle"
        f" {listed(cycle, MOST_SHOWN)}; a program solves no algebraic loop: break the cycle, or run the system"
        " as it is."
    )


def initial_dependencies(document: Document) -> dict[str, frozenset[str]]:
    """Return the inputs that each output of an FMU depends on during initialization, by their names in the FMU.

    An output without declared dependencies depends on all inputs (FMI 2.0.4, section 2.2.8).
    """
    inputs = {v.index: v.name for v in document.of_causality("input")}
    declared = {row.index: row.dependencies for row in document.unknowns(INITIAL_UNKNOWNS)}
    found = {}
    for output in document.of_causality("output"):
        indices = declared.get(output.index)
        found[output.name] = frozenset(
            inputs.values() if indices is None else (inputs[i] for i in indices if i in inputs)
        )
    return found
