"""Replacement of the FMU behind a component by another FMU.

The names and units of the new FMU may differ from the old ones.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.description import Description, read_description
from orchestration.fmi.names import suggestion
from orchestration.fmi.units import Linear
from orchestration.system.component import Component, Connection, sources_of, unit_scale
from orchestration.system.unfit import require_outputs

if TYPE_CHECKING:
    from orchestration.system.system import System


def replaced(system: "System", name: str, fmu: Path, mapping: Mapping[str, str]) -> "System":
    """Return a system in which another FMU stands in the place of a component.

    This function implements `System.replace`.

    Raises
    ------
    SystemDescriptionError
        If the new FMU lacks a connected output, a mapped name is unknown, or a unit cannot be converted.
    """
    old = system.component(name)
    description = read_description(fmu)
    description = description.renamed(_names(system, old, description, mapping))
    known = description.variables
    start, notices = _start(old, Component(name, description), mapping)
    new = Component(name, description, start)
    require_outputs(system, new)  # before all other checks
    components = tuple(new if c.name == name else c for c in system.components)
    connections, further = _connections(system, old, new, components)
    assumptions = {
        path: text
        for path, text in system.assumptions.items()
        if path.partition(".")[0] != name or path.partition(".")[2] in known
    }
    return replace(
        system,
        components=components,
        connections=connections,
        notices=(*system.notices, *notices, *further),
        assumptions=assumptions,
    )


def _connections(
    system: "System", old: Component, new: Component, components: Sequence[Component]
) -> tuple[tuple[Connection, ...], list[str]]:
    """Connections of the system with the new component, and notices of dropped and of added connections."""
    connections, notices, lost, model = [], [], [], new.description.model_name
    for connection in system.connections:
        if connection.target == new.name and connection.input not in new.description.variables:
            lost.append(connection.input)
            continue
        connections.append(_rescaled(connection, system, old, new))
    if lost:
        notices.append(f"{new.name}: connections dropped, {model} has no input {', '.join(lost)}.")
    had = {variable.name for variable in old.description.of_causality("input")}
    for variable in new.description.of_causality("input"):
        sources = sources_of(components, new, variable.name) if variable.name not in had else []
        if len(sources) == 1:
            connections.append(Connection(sources[0].name, variable.name, new.name, variable.name))
            notices.append(f"Connection {connections[-1]} added: {model} has this input too.")
    return tuple(connections), notices


def _names(system: "System", old: Component, new: Description, mapping: Mapping[str, str]) -> dict[str, str]:
    """Names of scalar variables in the system, by their names in the new FMU."""
    ours = [*old.description.variables]
    ours += [v.name for c in system.components if c is not old for v in c.description.of_causality("output")]
    names: dict[str, str] = {}
    for our, their in mapping.items():
        scalars = _scalars(our, ours)
        if not scalars:
            msg = f"Mapping {our}={their}: {old.name} has no variable {our}; {suggestion(our, ours)}"
            raise SystemDescriptionError(msg)
        for scalar in scalars:
            theirs = their + scalar[len(our) :]
            if theirs not in new.variables:
                help_ = suggestion(theirs, new.variables)
                msg = f"Mapping {our}={their}: {new.model_name} has no variable {theirs}; {help_}"
                raise SystemDescriptionError(msg)
            if names.get(theirs, scalar) != scalar:
                msg = f"Mapping {our}={their}: {theirs} is already mapped to {names[theirs]}."
                raise SystemDescriptionError(msg)
            names[theirs] = scalar
    return names


def _scalars(name: str, known: Sequence[str]) -> list[str]:
    """Names of a scalar variable, or of all elements of an array, in their order."""
    if name in known:
        return [name]
    return list(dict.fromkeys(n for n in known if n.startswith(f"{name}[")))


def _start(old: Component, new: Component, mapping: Mapping[str, str]) -> tuple[dict[str, float | str], list[str]]:
    """Start values in the units of the new FMU, and notices of dropped and of unconverted values."""
    start, notices, lost, moved, model = {}, [], [], [], new.description.model_name
    known = new.description.variables
    for name, value in old.start.items():
        place = name if name in known else _other_form(name)
        variable = known.get(place)
        if variable is None or not variable.can_start:
            lost.append(name)
            continue
        if place != name:
            moved.append(f"{name} to {place}")
        before = old.variable(name)
        if isinstance(value, str):
            start[place] = value
            continue
        scale = unit_scale(old, before, new, variable)
        if scale is None:
            units = f"units {before.unit} and {variable.unit} differ"
            if name in mapping or name.partition("[")[0] in mapping:
                msg = f"{new.name}.{name} = {value:g}: {units}; map it to a variable of {model} of the same dimension."
                raise SystemDescriptionError(msg)
            # The gains of two adaptation laws have different dimensions; a replacement must not switch a law off.
            notices.append(f"{new.name}: start value of {name} = {value:g} kept, but {units}; set a new value.")
        start[place] = value if scale is None else scale(value)
    if moved:
        notices.insert(0, f"{new.name}: start values moved to diagonals of {model}: {', '.join(moved)}.")
    if lost:
        notices.insert(0, f"{new.name}: start values dropped, {model} has no {', '.join(lost)}.")
    return start, notices


def _other_form(name: str) -> str:
    """Name in the other form of a gain: ``M[2,2]`` of a matrix for ``M[2]`` of its diagonal, and the other way."""
    base, bracket, index = name.removesuffix("]").rpartition("[")
    row, comma, column = index.partition(",")
    if not bracket or not row.isdecimal():
        return name
    if not comma:
        return f"{base}[{row},{row}]"
    return f"{base}[{row}]" if row == column else name


def _rescaled(connection: Connection, system: "System", old: Component, new: Component) -> Connection:
    """Adapt the factor and offset of a connection to the units of the new component.

    A conversion that came from the old units is replaced by the conversion of the new units. A user's own factor
    is kept between the old units.
    """
    if new.name not in (connection.source, connection.target):
        return connection
    ends = system.component(connection.source), system.component(connection.target)
    output, input_ = ends[0].variable(connection.output), ends[1].variable(connection.input)
    if connection.scale == unit_scale(ends[0], output, ends[1], input_):
        return replace(connection, factor=None, offset=0.0)
    scale: Linear | None = connection.scale
    if connection.source == new.name:
        before = unit_scale(new, new.variable(connection.output), old, output)
        scale = before.then(scale) if before else None
    if connection.target == new.name and scale is not None:
        after = unit_scale(old, input_, new, new.variable(connection.input))
        scale = scale.then(after) if after else None
    if scale is None:
        msg = f"Connection {connection} has a factor between units that {new.description.model_name} does not have."
        raise SystemDescriptionError(msg)
    return replace(connection, factor=scale.factor, offset=scale.offset)
