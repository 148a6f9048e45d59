"""From a system and its instances to the flat arrays of the hot loop."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration import loop
from orchestration.errors import SystemDescriptionError
from orchestration.fmu import BOOLEAN, INTEGER, REAL, Instance
from orchestration.loop import Plan
from orchestration.system import Component, System

Path = tuple[str, str]  # component, variable

_CALLS = {
    ("input", REAL): (loop.SET_REAL, "fmi2SetReal"),
    ("input", INTEGER): (loop.SET_INTEGER, "fmi2SetInteger"),
    ("input", BOOLEAN): (loop.SET_BOOLEAN, "fmi2SetBoolean"),
    ("output", REAL): (loop.GET_REAL, "fmi2GetReal"),
    ("output", INTEGER): (loop.GET_INTEGER, "fmi2GetInteger"),
    ("output", BOOLEAN): (loop.GET_BOOLEAN, "fmi2GetBoolean"),
}


@dataclass(frozen=True)
class Assembly:
    """A plan, and the arrays whose addresses it holds.

    Attributes
    ----------
    columns
        Recorded variables as ``component.variable``.
    real_outputs
        Place of each fetched Real output among the plan's reals, by ``component.variable``.
    alive
        Arrays of value references; the plan has only their addresses.
    """

    plan: Plan
    columns: tuple[str, ...]
    units: dict[str, str]
    real_outputs: dict[str, int]
    alive: tuple[np.ndarray, ...]

    def record(self, row: np.ndarray) -> None:
        """Copy the recorded outputs, as they are now, into a row of shape (n_columns,)."""
        loop.record(self.plan.recorded_reals, self.plan.reals, row)
        loop.record(self.plan.recorded_discretes, self.plan.discretes, row)


@dataclass
class _Buffers:
    """Places of variables in the buffers of reals and of discretes, in the order of asking."""

    reals: dict[tuple[str, str, str], int] = field(default_factory=dict)
    discretes: dict[tuple[str, str, str], int] = field(default_factory=dict)

    def place(self, kind: str, key: tuple[str, str, str]) -> int:
        """Index of a variable, given a new one when it is asked for first."""
        places = self.reals if kind == REAL else self.discretes
        return places.setdefault(key, len(places))


def assemble(system: System, instances: Sequence[Instance], record: Collection[str] | None) -> Assembly:
    """Lay out buffers and addresses for a run; instances are in the order of the components.

    Raises
    ------
    SystemDescriptionError
        If a variable to record is unknown or no output.
    """
    recorded = _recorded_paths(system, record)
    sources = {(c.target, c.input): (c.source, c.output) for c in system.connections}
    wanted = {"output": {*recorded, *sources.values()}, "input": set(sources)}
    buffers = _Buffers()
    calls = [
        (i, component, causality, kind, names)
        for causality, kind in _CALLS
        for i, component in enumerate(system.components)
        if (names := _names(component, causality, kind, wanted[causality]))
    ]
    first = {
        (i, causality, kind): [
            buffers.place(kind, (causality, component.name, name)) for name in names
        ][0]
        for i, component, causality, kind, names in calls
    }
    reals = np.zeros(len(buffers.reals))
    discretes = np.zeros(len(buffers.discretes), np.int32)
    table = np.zeros((len(instances), loop.N_COLUMNS), np.int64)
    for i, instance in enumerate(instances):
        table[i, loop.COMPONENT] = instance.component
        table[i, loop.DO_STEP] = instance.address("fmi2DoStep")
    alive = []
    for i, component, causality, kind, names in calls:
        column, function = _CALLS[causality, kind]
        references = np.array([component.variable(name).reference for name in names], np.uint32)
        buffer = reals if kind == REAL else discretes
        address = buffer.ctypes.data + first[i, causality, kind] * buffer.itemsize
        group = (instances[i].address(function), references.ctypes.data, len(names), address)
        table[i, column : column + 4] = group
        alive.append(references)
    real_links = _links(system, buffers.reals, sources, table, loop.FIRST_REAL)
    discrete_links = _links(system, buffers.discretes, sources, table, loop.FIRST_DISCRETE)
    columns = {path: column for column, path in enumerate(recorded)}
    plan = Plan(
        table,
        real_links,
        discrete_links,
        reals,
        discretes,
        _recorded(columns, buffers.reals),
        _recorded(columns, buffers.discretes),
    )
    units = {f"{c}.{v}": system.component(c).variable(v).unit for c, v in recorded}
    names = tuple(f"{c}.{v}" for c, v in recorded)
    real_outputs = {f"{c}.{v}": i for (causality, c, v), i in buffers.reals.items() if causality == "output"}
    return Assembly(plan, names, units, real_outputs, tuple(alive))


def _recorded_paths(system: System, record: Collection[str] | None) -> list[Path]:
    """All outputs if `record` is None, else the named ones in the given order."""
    if record is None:
        return [
            (component.name, variable.name)
            for component in system.components
            for variable in component.description.of_causality("output")
        ]
    paths = []
    for name in record:
        component, variable = system.resolve(name)
        if variable.causality != "output":
            msg = f"{name} is a {variable.causality}; only outputs can be recorded."
            raise SystemDescriptionError(msg)
        paths.append((component.name, variable.name))
    return paths


def _names(component: Component, causality: str, kind: str, wanted: Collection[Path]) -> list[str]:
    """A component's variables that are set or fetched by one call."""
    return [
        variable.name
        for variable in component.description.of_causality(causality)
        if variable.type == kind and (component.name, variable.name) in wanted
    ]


def _links(
    system: System,
    places: dict[tuple[str, str, str], int],
    sources: dict[Path, Path],
    table: np.ndarray,
    column: int,
) -> np.ndarray:
    """(source, target) indices by component; writes each component's range into the table."""
    links: list[tuple[int, int]] = []
    for i, component in enumerate(system.components):
        table[i, column] = len(links)
        for (causality, name, variable), place in places.items():
            if causality == "input" and name == component.name:
                links.append((places["output", *sources[name, variable]], place))
        table[i, column + 1] = len(links)
    return np.array(links, np.int64).reshape(-1, 2)


def _recorded(columns: dict[Path, int], places: dict[tuple[str, str, str], int]) -> np.ndarray:
    """(index, column) of the recorded outputs in one buffer."""
    pairs = [
        (place, columns[name, variable])
        for (causality, name, variable), place in places.items()
        if causality == "output" and (name, variable) in columns
    ]
    return np.array(pairs, np.int64).reshape(-1, 2)
