"""Tables of a model's variables for its page: who connects to it, its parameters by topic, every variable."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from adaptimp_fmu.description import number
from adaptimp_fmu.display_units import display_unit
from adaptimp_fmu.grids import Laid, grid_of, laid_out
from adaptimp_fmu.model import Model
from adaptimp_fmu.names import as_one, common_beginning
from adaptimp_fmu.variables import Role, Type, Variable

OTHERS = "Other parameters"


@dataclass(frozen=True)
class Row:
    """A row of an interface table: texts about a variable of a model."""

    name: str
    type: str
    unit: str
    start: str
    minimum: str
    maximum: str
    tunable: str
    description: str


@dataclass(frozen=True)
class Variables:
    """Variables as tables: a row for each, and those of arrays that a grid lays out."""

    rows: Sequence[Row]
    laid: Sequence[Laid]


@dataclass(frozen=True)
class Port:
    """A row of the table of connections: a variable or an array, and its partners in the system."""

    name: str
    size: int
    unit: str
    partners: str
    description: str


def tables(model: Model, variables: Iterable[Variable]) -> Variables:
    """One row for each variable, and the tables of those that a grid of the model lays out."""
    among = list(variables)
    return Variables([_row(variable) for variable in among if grid_of(model, variable) is None], laid_out(model, among))


def ports(model: Model, role: Role) -> list[Port]:
    """One row for each input or output, arrays once, with the partners that the model's guide names."""
    groups: dict[str, list[Variable]] = {}
    for variable in model.with_role(role):
        groups.setdefault(variable.name.partition("[")[0], []).append(variable)
    return [_port(model, name, elements) for name, elements in groups.items()]


def topics(model: Model) -> dict[str, Variables]:
    """Parameters by topic, in the order of the guide; those without a topic come last.

    Without topics all parameters are one list, whose title is empty.
    """
    parameters = model.with_role(Role.FIXED_PARAMETER, Role.TUNABLE_PARAMETER)
    topic_of = {name: topic for topic, names in model.guide.topics.items() for name in names}
    found: dict[str, list[Variable]] = {topic: [] for topic in model.guide.topics}
    rest = OTHERS if found else ""
    for variable in parameters:
        base = variable.name.partition("[")[0]
        found.setdefault(topic_of.get(variable.name) or topic_of.get(base) or rest, []).append(variable)
    return {topic: tables(model, variables) for topic, variables in found.items() if variables}


def display_units(model: Model) -> list[tuple[str, str, str]]:
    """Display unit, unit, and the number that leads from the one to the other, of the variables that have one."""
    found = {v.display_unit: v.unit for v in model.variables if v.display_unit}
    return [(name, unit, f"{display_unit(name).factor:.10g}") for name, unit in sorted(found.items())]


def _port(model: Model, name: str, elements: Sequence[Variable]) -> Port:
    """Row of an array, or of a scalar."""
    first, signal = elements[0], model.guide.signals.get(name)
    said: Sequence[str] = ()
    if signal is not None:
        said = [signal.source] if first.role is Role.INPUT else signal.targets
    units = dict.fromkeys(variable.unit or _kind(variable) for variable in elements)
    return Port(
        name if len(elements) == 1 else f"{name}[1] to {elements[-1].name}",
        len(elements),
        ", ".join(units),
        ", ".join(said),
        _meaning(model, elements),
    )


def _meaning(model: Model, elements: Sequence[Variable]) -> str:
    """What an array is: what the texts of its elements have in common, or all of them.

    Vectors of two quantities, such as force and moment, have two texts if each has three elements or more.
    """
    if len(elements) > 1 and grid_of(model, elements[0]) is not None:
        return laid_out(model, elements)[0].text
    runs = [list(run) for _, run in groupby(elements, lambda variable: variable.unit)]
    if len(runs) == 1 and (common := _shared(elements)):
        return common
    if len(runs) == 2 and min(map(len, runs)) > 2 and all(map(_shared, runs)):
        return "; ".join(as_one([variable.description for variable in run]) for run in runs)
    return "; ".join(variable.description for variable in elements)


def _shared(elements: Sequence[Variable]) -> str:
    """What the descriptions of elements begin with."""
    return common_beginning([variable.description for variable in elements])


def _kind(variable: Variable) -> str:
    """What stands in the place of a unit: the type, or that a Real has no unit."""
    return variable.type.value if variable.type is not Type.REAL else variable.range or "1"


def _row(variable: Variable) -> Row:
    bounded = variable.type is not Type.BOOLEAN
    shown = f" ({variable.display_unit})" if variable.display_unit else ""
    return Row(
        name=variable.name,
        type=variable.type.value if not variable.stands_for else f"Real, {variable.range}",
        unit=variable.unit + shown,
        start="" if variable.start is None else number(variable.start, variable.type),
        minimum=_bound(variable.minimum, variable.type) if bounded else "",
        maximum=_bound(variable.maximum, variable.type) if bounded else "",
        tunable="yes" if variable.role is Role.TUNABLE_PARAMETER else "",
        description=variable.description,
    )


def _bound(value: float, type: Type) -> str:
    return number(value, type) if math.isfinite(value) else ""
