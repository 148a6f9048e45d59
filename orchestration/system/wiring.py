"""Connections as text: ``plant.x -> controller.x`` for scalars and for whole arrays."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.system.component import Component, Connection, checked_connection, sources_of
from orchestration.system.refused import driven_twice

ARROW = "->"


def parsed(line: str | Connection, components: Mapping[str, Component]) -> list[Connection]:
    """Connections that a text means, one for each pair of scalars.

    Parameters
    ----------
    line
        ``source.output -> target.input``. Both ends are scalars, or arrays of the same shape. A `Connection` is
        kept as it is.
    components
        Components of the system by name.

    Raises
    ------
    SystemDescriptionError
        If the text has another form, a name is unknown, or the shapes differ.
    """
    if isinstance(line, Connection):
        return [line]
    if not isinstance(line, str) or line.count(ARROW) != 1:
        msg = f"{line!r} is not a connection; write one with ->, such as 'plant.x -> controller.x'."
        raise SystemDescriptionError(msg)
    paths = [text.strip() for text in line.split(ARROW)]
    (source, outputs), (target, inputs) = (_end(path, line, components) for path in paths)
    if len(outputs) != len(inputs):
        counts = f"{paths[0]} has {len(outputs)} and {paths[1]} has {len(inputs)} elements"
        msg = f"Connection {line.strip()}: {counts}; both ends need the same number."
        raise SystemDescriptionError(msg)
    return [Connection(source, output, target, input_) for output, input_ in zip(outputs, inputs, strict=True)]


def _end(path: str, line: str, components: Mapping[str, Component]) -> tuple[str, list[str]]:
    """Component and variables, in the order of their elements, of one end."""
    name, dot, variable = path.partition(".")
    if not dot or not variable:
        msg = f"Connection {line.strip()}: {path!r} is not component.variable, such as plant.x."
        raise SystemDescriptionError(msg)
    if name not in components:
        msg = f"Connection {line.strip()}: there is no component {name}; {suggestion(name, components)}"
        raise SystemDescriptionError(msg)
    description = components[name].description
    if variable in description.variables:
        return name, [variable]
    elements = description.elements(variable)
    if elements is None:
        meant = suggestion(variable, description.variables, f"{name}.")
        msg = f"Connection {line.strip()}: {name} has no variable {variable}; {meant}"
        raise SystemDescriptionError(msg)
    return name, elements


def by_equal_names(components: Sequence[Component], taken: Iterable[Connection] = ()) -> list[Connection]:
    """Connections from outputs to all inputs of the same name that have no source yet.

    Raises
    ------
    SystemDescriptionError
        If two components have an output of a name that an input could take.
    """
    driven = {(connection.target, connection.input) for connection in taken}
    bearers: dict[str, list[Component]] = {}
    for component in components:
        for variable in (*component.description.of_causality("output"), *component.description.texts("output")):
            bearers.setdefault(variable.name, []).append(component)
    found = []
    for target in components:
        for variable in (*target.description.of_causality("input"), *target.description.texts("input")):
            if (target.name, variable.name) in driven:
                continue
            sources = sources_of(bearers.get(variable.name, ()), target, variable.name)
            if len(sources) > 1:
                names = " or ".join(source.name for source in sources)
                msg = f"{target.name}.{variable.name} could come from {names}; connect it by hand."
                raise SystemDescriptionError(msg)
            if sources:
                found.append(Connection(sources[0].name, variable.name, target.name, variable.name))
    return found


def checked_connections(
    connections: Iterable[Connection], component: Callable[[str], Component]
) -> tuple[Connection, ...]:
    """Return connections with the conversions of their units.

    Parameters
    ----------
    component
        Returns the component of a name.

    Raises
    ------
    SystemDescriptionError
        If variables do not fit together, or an input has two sources.
    """
    driven: dict[tuple[str, str], Connection] = {}
    for given in connections:
        connection = checked_connection(given, component(given.source), component(given.target))
        other = driven.setdefault((connection.target, connection.input), connection)
        if other is not connection:
            raise driven_twice(connection, other)
    return tuple(driven.values())
