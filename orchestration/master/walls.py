"""Warns before a run whose components are told different places of one wall.

An arm meets the wall at ``plant.wall_offset``; the trajectory that presses it there leaves its ellipse at
``trajectory.wall_offset``. Both are parameters of FMUs of their own, so a run with two different walls makes no error
message: the arm pushes with a wrong force, or not at all.

Only walls are compared. The link lengths, the gravity and the masses of a controller may differ from those of the plant
on purpose, because they are its model of the plant. Components are compared if connections lead from one to the other,
however many: two arms in one system may have walls of their own.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from orchestration.errors import printable, warn_caller
from orchestration.fmi.codes import REAL
from orchestration.fmi.description import Variable
from orchestration.system.component import Component, unit_scale
from orchestration.system.system import System

WALLS = ("wall_normal", "wall_offset", "wall_normal2", "wall_offset2")
"""Names of the parameters that tell where a wall is."""
TOLERANCE = 1e-9  # by which two values may differ, relative to the larger one and to 1


class DifferentWallsWarning(UserWarning):
    """Warning that connected components are told different places of one wall.

    Examples
    --------
    >>> import warnings
    >>> from orchestration import DifferentWallsWarning, scenario, simulate
    >>> moved = scenario("fig2").set({"plant.wall_offset": 1.4})  # m
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always", DifferentWallsWarning)
    ...     result = simulate(moved, stop_time=0.1)
    >>> print(caught[0].message)
    trajectory.wall_offset = 1.4... m, but plant.wall_offset = 1.4 m: ... set both to the same value.
    """


@dataclass(frozen=True)
class DifferentWalls:
    """Two components that are told different places of one wall.

    Attributes
    ----------
    name
        Name of the parameter in both components.
    components
        Names of both components.
    values
        Value of each component in `unit`, one number for each element of the parameter.
    unit
        Unit of the parameter in the first component; empty if there is none.
    """

    name: str
    components: tuple[str, str]
    values: tuple[tuple[float, ...], tuple[float, ...]]
    unit: str

    def __str__(self) -> str:
        """One sentence with both values and what to do."""
        one, other = self.told
        return f"{one}, but {other}: both are told of one wall; set both to the same value."

    @property
    def told(self) -> tuple[str, str]:
        """What each component is told, such as ``plant.wall_offset = 1.45 m``."""
        one, other = (
            f"{component}.{self.name} = {_shown(values)}{f' {self.unit}' if self.unit else ''}"
            for component, values in zip(self.components, self.values, strict=True)
        )
        return one, other

    @property
    def agreed(self) -> dict[str, float]:
        """Start values by ``component.variable`` that move the wall of the first component to that of the second."""
        first, second = self.components[0], self.values[1]
        if len(second) == 1:
            return {f"{first}.{self.name}": second[0]}
        return {f"{first}.{self.name}[{i + 1}]": value for i, value in enumerate(second)}


def report_walls(system: System) -> None:
    """Warn of each pair of connected components that are told different places of one wall."""
    for found in different_walls(system):
        warn_caller(printable(str(found)), DifferentWallsWarning)


def different_walls(system: System) -> list[DifferentWalls]:
    """Find pairs of connected components that are told different places of one wall.

    Parameters
    ----------
    system
        System with start values.

    Returns
    -------
    list of DifferentWalls
        One for each parameter and each component that differs from the first component that has the parameter.
    """
    told = {component.name: _told(component) for component in system.components}
    if sum(map(bool, told.values())) <= 1:
        return []
    found = []
    for group in _connected(system):
        for name in WALLS:
            having = [member for member in group if name in told[member]]
            for other in having[1:]:
                first, second = told[having[0]][name], told[other][name]
                another = second.in_unit_of(first)
                if another is not None and not _same(first.values, another):
                    names, unit = (having[0], other), first.variable.unit
                    found.append(DifferentWalls(name, names, (first.values, another), unit))
    return found


@dataclass(frozen=True)
class _Told:
    """Values, in the unit of its first element, of a parameter that tells a component where a wall is."""

    component: Component
    variable: Variable
    values: tuple[float, ...]

    def in_unit_of(self, other: "_Told") -> tuple[float, ...] | None:
        """The values in the unit of another component; None if both units have different dimensions."""
        scale = unit_scale(self.component, self.variable, other.component, other.variable)
        return None if scale is None else tuple(scale(value) for value in self.values)


def _told(component: Component) -> dict[str, _Told]:
    """What tells a component where a wall is, by the name of the parameter."""
    found: dict[str, _Told] = {}
    for variable in component.description.of_causality("parameter"):
        name = variable.name.partition("[")[0]
        value = component.start.get(variable.name, variable.start)
        if name in WALLS and variable.type == REAL and value is not None:
            before = found.get(name, _Told(component, variable, ()))
            found[name] = replace(before, values=(*before.values, float(value)))
    return found


def _connected(system: System) -> Iterator[list[str]]:
    """Names of the components in groups between which there is no connection."""
    group_of = {component.name: {component.name} for component in system.components}
    for connection in system.connections:
        one, other = group_of[connection.source], group_of[connection.target]
        if one is not other:
            one |= other
            group_of.update(dict.fromkeys(other, one))
    names = [component.name for component in system.components]
    for group in {id(group): group for group in group_of.values()}.values():
        yield [name for name in names if name in group]


def _same(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return len(one) == len(other) and all(
        abs(a - b) <= TOLERANCE * max(1.0, abs(a), abs(b)) for a, b in zip(one, other, strict=True)
    )


def _shown(values: tuple[float, ...]) -> str:
    texts = [f"{value:.12g}" for value in values]
    return texts[0] if len(texts) == 1 else f"({', '.join(texts)})"
