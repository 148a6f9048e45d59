"""A component of a system, and a connection between two of them."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, STRING
from orchestration.fmi.instance import SAMPLE_TIME, Description, Variable, parse_value, read_description
from orchestration.fmi.units import Linear, conversion
from orchestration.system.display import component_html, component_line

SETTABLE = ("parameter", "input")


@dataclass(frozen=True, repr=False)
class Component:
    """An FMU under a name, with the start values that differ from its own.

    Attributes
    ----------
    start
        Values by variable name; Booleans are 0 or 1.
    """

    name: str
    description: Description
    start: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def read(cls, path: str | Path, name: str = "") -> "Component":
        """A component from an FMU file; its name is that of the file if none is given.

        Raises
        ------
        ArchiveError
            If the file is no FMI 2.0 co-simulation FMU.
        """
        return cls(name or Path(path).stem, read_description(Path(path)))

    def variable(self, name: str) -> Variable:
        """A variable by name.

        Raises
        ------
        SystemDescriptionError
            Listing the known names.
        """
        try:
            return self.description.variables[name]
        except KeyError:
            known = ", ".join(self.description.variables)
            msg = f"{self.name} has no variable {name}; it has {known}."
            raise SystemDescriptionError(msg) from None

    def __repr__(self) -> str:
        """Name, model, numbers of inputs and outputs, start values that differ from the FMU's."""
        return component_line(self)

    def _repr_html_(self) -> str:
        return component_html(self)

    @property
    def sample_time(self) -> float | None:
        """Sampling period, s, of a component that declares the parameter ``sample_time``."""
        variable = self.description.variables.get(SAMPLE_TIME)
        if variable is None or variable.causality != "parameter":
            return None
        return self.start.get(SAMPLE_TIME, variable.start)

    @property
    def continuous(self) -> bool:
        """Whether outputs follow inputs between ticks: there is no ``sample_time``, nor are all discrete."""
        outputs = self.description.of_causality("output")
        held = bool(outputs) and all(variable.variability == "discrete" for variable in outputs)
        return self.sample_time is None and not held


@dataclass(frozen=True, order=True)
class Connection:
    """From an output to an input, both scalar: input = factor * output + offset.

    Attributes
    ----------
    factor, offset
        The whole way from a number of the source to one of the target, Reals only. A factor of None asks
        for the conversion between the two units; a `System` puts its numbers there.
    """

    source: str
    output: str
    target: str
    input: str
    factor: float | None = None
    offset: float = 0.0

    def __str__(self) -> str:
        """``plant.x[1] -> controller.x[1]``, and factor and offset if they change anything."""
        ends = f"{self.source}.{self.output} -> {self.target}.{self.input}"
        if self.scale.trivial:
            return ends
        return f"{ends} (factor {self.scale.factor!r}, offset {self.scale.offset!r})"

    @property
    def scale(self) -> Linear:
        """What the source's values go through on the way to the target."""
        return Linear(1.0 if self.factor is None else float(self.factor), float(self.offset))


def unit_scale(source: Component, output: Variable, target: Component, input_: Variable) -> Linear | None:
    """The conversion from the unit of one variable to that of another; None if there is none."""
    units = source.description.unit(output), target.description.unit(input_)
    found = conversion(*units, relative=output.relative or input_.relative)
    return None if found is None else Linear(*found)


def checked_connection(connection: Connection, source: Component, target: Component) -> Connection:
    """The same connection with its factor and offset in numbers.

    Raises
    ------
    SystemDescriptionError
        If the two ends do not fit together.
    """
    output, input_ = source.variable(connection.output), target.variable(connection.input)
    if output.causality != "output":
        msg = f"Connection {connection}: {output.name} has causality {output.causality}, not output."
        raise SystemDescriptionError(msg)
    if input_.causality != "input":
        msg = f"Connection {connection}: {input_.name} has causality {input_.causality}, not input."
        raise SystemDescriptionError(msg)
    if output.type != input_.type:
        msg = f"Connection {connection}: types {output.type} and {input_.type} differ."
        raise SystemDescriptionError(msg)
    if output.type == STRING:
        msg = f"Connection {connection}: Strings cannot be connected."
        raise SystemDescriptionError(msg)
    scale = connection.scale
    if connection.factor is None:
        by_units = unit_scale(source, output, target, input_)
        if by_units is None:
            msg = f"Connection {connection}: units {output.unit} and {input_.unit} differ."
            raise SystemDescriptionError(msg)
        scale = by_units.then(scale)
    if output.type != REAL and not scale.trivial:
        msg = f"Connection {connection}: {output.name} is of type {output.type}; only Reals can be scaled."
        raise SystemDescriptionError(msg)
    if not (math.isfinite(scale.factor) and math.isfinite(scale.offset)):
        msg = f"Connection {connection}: factor and offset must be finite."
        raise SystemDescriptionError(msg)
    return replace(connection, factor=scale.factor, offset=scale.offset)


def require_settable(component: Component, variable: Variable) -> None:
    """Refuse what has no start value that a user may choose."""
    if variable.causality not in SETTABLE:
        path = f"{component.name}.{variable.name}"
        msg = f"{path} has causality {variable.causality}; only parameters and inputs can be set."
        raise SystemDescriptionError(msg)
    if variable.type == STRING:
        msg = f"{component.name}.{variable.name} is a String; only Reals, Integers and Booleans can be set."
        raise SystemDescriptionError(msg)


def spread(path: str, value: Any, elements: Sequence[str]) -> list[Any]:
    """Values for the elements of an array: one for each, or one for all of them.

    Raises
    ------
    SystemDescriptionError
        If the number of values is another one.
    """
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return [value] * len(elements)
    flat = np.asarray(value).ravel().tolist()
    if len(flat) != len(elements):
        msg = (
            f"{path} has {len(elements)} elements, but {len(flat)} values are given; give one for each, or one for all."
        )
        raise SystemDescriptionError(msg)
    return flat


def number(path: str, variable: Variable, value: float | bool | str) -> float:
    """A value for a variable as a number."""
    found = math.nan
    with suppress(ValueError, KeyError, TypeError):
        found = parse_value(value, variable.type)
    if math.isnan(found):
        examples = {BOOLEAN: "true or false", INTEGER: "an integer of 32 bits"}
        msg = f"{path} = {value!r}: {examples.get(variable.type, 'a number')} is needed."
        raise SystemDescriptionError(msg)
    return found


def sources_of(components: Sequence[Component], target: Component, name: str) -> list[Component]:
    """Components other than the target with an output of that name."""
    return [c for c in components if _has_output(c, name) and c is not target]


def _has_output(component: Component, name: str) -> bool:
    variable = component.description.variables.get(name)
    return variable is not None and variable.causality == "output"
