"""Turns a system into its flat form for the compiled loops: buffers, addresses of functions, and lists of copies."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, STRING
from orchestration.fmi.instance import Instance
from orchestration.fmi.names import chosen, suggestion
from orchestration.master.kernel import flat_system
from orchestration.master.kernel.codes import GROUP_SIZE, N_COLUMNS, Column, Group
from orchestration.master.kernel.flat_system import Plan
from orchestration.master.texts import TextCall, Texts
from orchestration.system.system import Component, Connection, System

Path = tuple[str, str]  # component, variable

_CALLS = {
    ("input", REAL): (Column.SET_REAL, "fmi2SetReal"),
    ("input", INTEGER): (Column.SET_INTEGER, "fmi2SetInteger"),
    ("input", BOOLEAN): (Column.SET_BOOLEAN, "fmi2SetBoolean"),
    ("output", REAL): (Column.GET_REAL, "fmi2GetReal"),
    ("output", INTEGER): (Column.GET_INTEGER, "fmi2GetInteger"),
    ("output", BOOLEAN): (Column.GET_BOOLEAN, "fmi2GetBoolean"),
}


@dataclass(frozen=True)
class Assembly:
    """A system in its flat form, and the arrays whose addresses it holds.

    Attributes
    ----------
    columns
        Recorded variables, except Strings, as ``component.variable``.
    real_outputs
        Index of each fetched Real output in the plan's buffer of reals, by ``component.variable``.
    driven
        Address of the place of each input that is driven from outside, by ``component.variable``.
    real_connections, discrete_connections
        Connection of each Real link, and of each discrete link.
    texts
        Recorded Strings, and the texts of all Strings.
    alive
        Arrays of value references, which must outlive the plan because it has only their addresses.
    """

    plan: Plan
    columns: tuple[str, ...]
    units: dict[str, str]
    real_outputs: dict[str, int]
    driven: dict[str, int]
    real_connections: tuple[Connection, ...]
    discrete_connections: tuple[Connection, ...]
    texts: Texts
    alive: tuple[np.ndarray, ...]

    def record(self, row: np.ndarray) -> None:
        """Copy the present values of the recorded outputs into a row of shape (n_columns,)."""
        flat_system.record(self.plan, row[None, :], np.uint64(0))


Key = tuple[str, str, str]  # causality, component, variable


@dataclass
class _Buffers:
    """Places of variables in the buffers of reals and of discretes, in the order of asking."""

    reals: dict[Key, int] = field(default_factory=dict)
    discretes: dict[Key, int] = field(default_factory=dict)

    def of(self, kind: str) -> dict[Key, int]:
        """Return the places in the buffer of a type; Integers, Booleans and numbers of texts share a buffer."""
        return self.reals if kind == REAL else self.discretes


@dataclass(frozen=True)
class _Call:
    """One set or get call of a component: variables of a type, side by side from `first` on.

    A call for Integers is one for Strings, too, which stand after the Integers.
    """

    row: int
    component: Component
    causality: str
    kind: str
    names: list[str]
    first: int


def assemble(
    system: System,
    instances: Sequence[Instance],
    record: Collection[str] | None,
    fetched: Collection[str] = (),
    driven: Collection[str] = (),
    *,
    beside: int = 0,
) -> Assembly:
    """Flatten a system for a run, with its instances in the order of the components.

    Outputs in `fetched` are fetched even if they are neither recorded nor connected. Inputs in `driven` have places
    although they have no connection. In a row, `beside` free columns stand between the numbers and the texts.

    Raises
    ------
    SystemDescriptionError
        If a variable to record is unknown.
    """
    chosen_paths = recorded_paths(system, record)
    texts = [path for path in chosen_paths if _is_text(system, path)]
    recorded = [path for path in chosen_paths if path not in set(texts)]
    sources = {(c.target, c.input): c for c in system.connections}
    buffers = _Buffers()
    shown = {(c.source, c.output) for c in system.connections}
    wanted = {*chosen_paths, *shown, *(_path(system, name) for name in fetched)}
    driven_paths = {_path(system, name): name for name in driven}
    calls = _calls(system, {"output": wanted, "input": {*sources, *driven_paths}}, buffers)
    reals, discretes = np.zeros(len(buffers.reals)), np.zeros(len(buffers.discretes), np.int32)
    found = _texts(system, [f"{c}.{v}" for c, v in texts], len(recorded) + beside, buffers)
    table, references = _table(instances, calls, (reals, discretes), found)
    columns = {path: column for column, path in enumerate(recorded)}
    columns |= {path: column for column, path in enumerate(texts, found.first)}
    real_links, real_connections = _links(system, buffers.reals, sources, table, Column.FIRST_REAL)
    discrete_links, discrete_connections = _links(system, buffers.discretes, sources, table, Column.FIRST_DISCRETE)
    plan = Plan(
        table,
        real_links,
        discrete_links,
        reals,
        discretes,
        _runs(_recorded(columns, buffers.reals)),
        _recorded(columns, buffers.discretes),
    )
    return Assembly(
        plan,
        columns=tuple(f"{c}.{v}" for c, v in recorded),
        units={f"{c}.{v}": system.component(c).variable(v).unit for c, v in recorded},
        real_outputs={
            f"{c}.{v}": i
            for (kind, c, v), i in buffers.reals.items()
            if kind == "output" and system.component(c).variable(v).causality == "output"
        },
        driven={name: _address(path, buffers, reals, discretes) for path, name in driven_paths.items()},
        real_connections=real_connections,
        discrete_connections=discrete_connections,
        texts=found,
        alive=tuple(references),
    )


def _texts(system: System, columns: Sequence[str], first: int, buffers: _Buffers) -> Texts:
    """Return the texts of a run, whose numbers have places in the buffer of discretes."""
    places = [place for (_, *path), place in buffers.discretes.items() if _is_text(system, (path[0], path[1]))]
    return Texts(tuple(columns), first, np.array(places, np.int64))


def _is_text(system: System, path: Path) -> bool:
    return system.component(path[0]).variable(path[1]).type == STRING


def _address(path: Path, buffers: _Buffers, reals: np.ndarray, discretes: np.ndarray) -> int:
    """Return the address of an input's place in its buffer."""
    key = ("input", *path)
    buffer, places = (reals, buffers.reals) if key in buffers.reals else (discretes, buffers.discretes)
    return buffer.ctypes.data + places[key] * buffer.itemsize


def _calls(system: System, wanted: dict[str, set[Path]], buffers: _Buffers) -> list[_Call]:
    """Return the set and get calls of all components, and give each variable its place in a buffer."""
    calls = []
    for causality, kind in _CALLS:
        places = buffers.of(kind)
        for row, component in enumerate(system.components):
            names = _names(component, causality, kind, wanted[causality])
            if names:
                calls.append(_Call(row, component, causality, kind, names, len(places)))
            for name in names:
                places[causality, component.name, name] = len(places)
    return calls


def _table(
    instances: Sequence[Instance], calls: Sequence[_Call], buffers: tuple[np.ndarray, np.ndarray], texts: Texts
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the table of components, without ranges of links, and the arrays of value references behind it.

    `buffers` are those of reals and of discretes.
    """
    table = np.zeros((len(instances), N_COLUMNS), np.int64)
    for row, instance in zip(table, instances, strict=True):
        row[Column.INSTANCE] = instance.component
        row[Column.DO_STEP] = instance.address("fmi2DoStep")
    kept = []
    for call in calls:
        column, function = _CALLS[call.causality, call.kind]
        references = np.array([call.component.variable(n).reference for n in call.names], np.uint32)
        buffer = buffers[0] if call.kind == REAL else buffers[1]
        group = table[call.row, column : column + GROUP_SIZE]
        group[Group.FUNCTION] = instances[call.row].address(function)
        n_numbers = sum(call.component.variable(name).type != STRING for name in call.names)
        if n_numbers < len(call.names):
            own = TextCall(instances[call.row], function[4:7], n_numbers, references, texts.table)
            texts.alive.append(own)
            group[Group.FUNCTION] = own.address
        group[Group.REFERENCES] = references.ctypes.data
        group[Group.COUNT] = len(call.names)
        group[Group.VALUES] = buffer.ctypes.data + call.first * buffer.itemsize
        if column == Column.GET_REAL:
            variables = [call.component.variable(name) for name in call.names]
            table[call.row, Column.REAL_OUTPUTS] = sum(v.causality == "output" for v in variables)
        kept.append(references)
    return table, kept


def recorded_paths(system: System, record: Collection[str] | None) -> list[Path]:
    """Return the recorded variables: all outputs if `record` is None, else what its names and patterns choose.

    A pattern chooses outputs only. A name, or the name of an array, chooses a variable of any causality.

    Raises
    ------
    SystemDescriptionError
        If a pattern chooses nothing, or a variable is unknown.
    """
    outputs = {
        f"{component.name}.{variable.name}": (component.name, variable.name)
        for component in system.components
        for variable in component.description.variables.values()
        if variable.causality == "output"
    }
    if record is None:
        return list(outputs.values())
    found: dict[Path, None] = {}
    for pattern in record:
        component, _, variable = pattern.partition(".")
        if component in system and variable in system.component(component).description.variables:
            found[component, variable] = None  # a name may have the characters of a pattern
            continue
        names, others = chosen([pattern], outputs)
        found |= dict.fromkeys(outputs[name] for name in names)
        if others:
            found |= dict.fromkeys(_of_any_causality(system, pattern, outputs))
    return list(found)


def _of_any_causality(system: System, name: str, outputs: Collection[str]) -> list[Path]:
    """Return the variable, or the elements of the array, that a name which is not an output's chooses."""
    if "*" in name or "?" in name:
        msg = f"record: no output fits {name!r}; {suggestion(name.strip('*?'), outputs)}"
        raise SystemDescriptionError(msg)
    return [_path(system, path) for path in system.elements(name)]


def _path(system: System, name: str) -> Path:
    component, variable = system.resolve(name)
    return component.name, variable.name


def _names(component: Component, causality: str, kind: str, wanted: Collection[Path]) -> list[str]:
    """Return the variables of a component that a single call sets or gets; a get call has the outputs first."""
    first = component.description.of_causality(causality)
    others = [v for v in component.description.variables.values() if causality == "output" != v.causality]
    numbers = [v.name for v in (*first, *others) if v.type == kind and (component.name, v.name) in wanted]
    if kind != INTEGER:
        return numbers
    texts = component.description.texts
    strings = [*texts(causality), *(v for v in others if v.type == STRING)]
    return numbers + [v.name for v in strings if (component.name, v.name) in wanted]


def _links(
    system: System,
    places: dict[Key, int],
    sources: dict[Path, Connection],
    table: np.ndarray,
    column: int,
) -> tuple[np.ndarray, tuple[Connection, ...]]:
    """Return the (source, target) indices in the order of the components, and their connections.

    The range of each component is written into the table.
    """
    links: list[tuple[int, int]] = []
    connections = []
    driven: dict[str, list[tuple[Connection, int]]] = {}
    for (causality, name, variable), place in places.items():
        if causality == "input" and (name, variable) in sources:
            driven.setdefault(name, []).append((sources[name, variable], place))
    for i, component in enumerate(system.components):
        table[i, column] = len(links)
        for connection, place in driven.get(component.name, ()):
            links.append((places["output", connection.source, connection.output], place))
            connections.append(connection)
        table[i, column + 1] = len(links)
    return np.array(links, np.uint64).reshape(-1, 2), tuple(connections)


def _recorded(columns: dict[Path, int], places: dict[Key, int]) -> np.ndarray:
    """Return (index, column) of the recorded outputs in one buffer."""
    pairs = [
        (place, columns[name, variable])
        for (causality, name, variable), place in places.items()
        if causality == "output" and (name, variable) in columns
    ]
    return np.array(pairs, np.uint64).reshape(-1, 2)


def _runs(pairs: np.ndarray) -> np.ndarray:
    """Return (index, column, number) of the runs in which index and column both go up by one."""
    runs: list[list[int]] = []
    for place, column in pairs.tolist():
        if runs and place == runs[-1][0] + runs[-1][2] and column == runs[-1][1] + runs[-1][2]:
            runs[-1][2] += 1
        else:
            runs.append([place, column, 1])
    return np.array(runs, np.uint64).reshape(-1, 3)
