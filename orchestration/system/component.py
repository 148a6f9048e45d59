"""Components of a coupled system, and connections between their variables."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.errors import SystemDescriptionError, UnknownNameError
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, STRING
from orchestration.fmi.description import SAMPLE_TIME, Description, Variable, parse_value, read_description
from orchestration.fmi.given import a_path, require_type, shown
from orchestration.fmi.names import arrays, base_name, near, suggestion
from orchestration.fmi.units import Linear, conversion
from orchestration.system.display import component_html, component_line

MOST_ITEMS = 4
"""How many items of an Enumeration a message shows."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


@dataclass(frozen=True, repr=False)
class Component:
    """A member of a system: an FMU with a name and with start values.

    Attributes
    ----------
    name
        Name of the component in the system.
    description
        Content of the FMU's modelDescription.xml.
    start
        Start values by variable name, in the units of the FMU. Booleans are 0 or 1, items of an Enumeration their
        numbers, Strings texts. A variable that is not listed keeps the start value of the FMU.

    Examples
    --------
    >>> from orchestration import Component, System, scenario
    >>> file = scenario("fig2")["plant"].path  # any FMU of yours
    >>> arm = Component.read(file, "arm")
    >>> arm
    <Component arm: Plant, 2 inputs, 14 outputs>
    >>> arm["m"].tolist(), arm.variable("m[1]").unit, [v.name for v in arm.description.of_causality("input")]
    ([2.0, 1.0], 'kg', ['tau[1]', 'tau[2]'])
    >>> heavy = System.of({"heavy": arm}).set({"heavy.m": [4.0, 2.0]})["heavy"]
    >>> heavy
    <Component heavy: Plant, 2 inputs, 14 outputs, m[1] = 4, m[2] = 2>
    >>> arm.path == file, arm.sample_time, arm.continuous, scenario("fig2")["sensor"].sample_time
    (True, None, True, 0.0001)
    """

    name: str
    description: Description
    start: Mapping[str, float | str] = field(default_factory=dict)

    @classmethod
    def read(cls, path: str | Path, name: str = "") -> "Component":
        """A component from an FMU file; its name is that of the file if none is given.

        Raises
        ------
        ArchiveError
            If the file is no FMI 2.0 co-simulation FMU.

        Examples
        --------
        >>> from orchestration import Component, scenario
        >>> Component.read(scenario("fig2")["sensor"].path)
        <Component ForceSensor: ForceSensor, 2 inputs, 2 outputs>
        """
        file = a_path("An FMU", path)
        return cls(name or file.stem, read_description(file))

    def variable(self, name: str) -> Variable:
        """Return the variable of a name.

        Raises
        ------
        SystemDescriptionError
            If the component has no such variable. The message gives near names.
        """
        try:
            return self.description.variables[name]
        except KeyError:
            help_ = suggestion(name, self.description.variables, f"{self.name}.")
            msg = f"{self.name} has no variable {name}; {help_}"
            raise SystemDescriptionError(msg) from None

    def __getitem__(self, name: str) -> "float | str | np.ndarray":
        """Start value that is in force, in the unit of the FMU; of an array, an array of its shape.

        Raises
        ------
        UnknownNameError
            If there is no such variable, or it has no start value, as most outputs. It is a KeyError.
        """
        elements = self.description.elements(name)
        if elements is None:
            return self._in_force(name)
        shape = self.description.arrays[name].shape
        return np.array([self._in_force(element) for element in elements]).reshape(shape)

    def __contains__(self, name: object) -> bool:
        """Whether there is a variable or an array of that name."""
        return isinstance(name, str) and (name in self.description.variables or name in self.description.arrays)

    def __iter__(self) -> Iterator[str]:
        """Names of the variables, in the order of the FMU."""
        return iter(self.description.variables)

    def _ipython_key_completions_(self) -> list[str]:
        started = tuple(name for name, v in self.description.variables.items() if v.start is not None)
        return [*arrays(started), *started]

    def _in_force(self, name: str) -> float | str:
        variables = self.description.variables
        value = self.start.get(name, variables[name].start if name in variables else None)
        if value is None:
            lacks = "start value" if name in variables else "variable"
            known = [other for other in variables if variables[other].start is not None]
            msg = f"{self.name} has no {lacks} {name}; {suggestion(name, known)}"
            raise UnknownNameError(msg)
        return value

    def __repr__(self) -> str:
        """Name, model, numbers of inputs and outputs, start values that differ from the FMU's."""
        return component_line(self)

    def _repr_html_(self) -> str:
        return component_html(self)

    @property
    def path(self) -> Path:
        """The FMU file."""
        return self.description.path

    @property
    def sample_time(self) -> float | None:
        """Sampling period, s; None for a component that is not sampled.

        A component is sampled if all of its outputs are discrete and it has a Real parameter ``sample_time`` in s. A
        parameter of that name with another type or unit, or beside continuous outputs, means something else.
        """
        variable = self.description.sampling_period
        period = None if variable is None else self.start.get(SAMPLE_TIME, variable.start)
        return None if period is None else float(period)

    @property
    def continuous(self) -> bool:
        """Whether outputs change continuously: there is no ``sample_time``, and some output is not discrete."""
        if self.description.discrete_outputs and self.description.of_causality("output"):
            return False
        return self.sample_time is None


@dataclass(frozen=True, order=True, repr=False)
class Connection:
    """A connection from a scalar output to a scalar input: input = factor * output + offset.

    Attributes
    ----------
    source, output
        Component and variable that give the value.
    target, input
        Component and variable that take the value.
    factor
        Unit of the input per unit of the output; other than 1 for Reals only. None stands for the conversion
        between both units, and a `System` replaces None by the number.
    offset
        Added value, in the unit of the input.

    Examples
    --------
    A damper at each joint turns a joint's rate into a torque against it:

    >>> from orchestration import Connection, System, scenario, simulate
    >>> dampers = [Connection("arm", f"dq[{i}]", "arm", f"tau[{i}]", factor=-20.0) for i in (1, 2)]  # N.m.s/rad
    >>> system = System.of({"arm": scenario("fig2")["plant"]}).connect(*dampers)
    >>> result = simulate(system, stop_time=1.0, step=1e-3)
    >>> print(abs(result["arm.dq"][[0, -1]]).round(2))  # rad/s
    [[2.09 0.  ]
     [0.02 0.01]]
    >>> dampers[0].scale.factor, dampers[0].scale.offset
    (-20.0, 0.0)
    """

    source: str
    output: str
    target: str
    input: str
    factor: float | None = None
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a factor or an offset that is not a number."""
        ends = f"Connection {self.source}.{self.output} -> {self.target}.{self.input}"
        for what, value in (("factor", self.factor), ("offset", self.offset)):
            if value is not None:
                require_type(f"{ends}: the {what}", value, (int, float), "give a number")

    def __str__(self) -> str:
        """Both ends, such as ``plant.x[1] -> controller.x[1]``, with factor and offset unless these are 1 and 0."""
        ends = f"{self.source}.{self.output} -> {self.target}.{self.input}"
        if self.scale.trivial:
            return ends
        return f"{ends} (factor {self.scale.factor!r}, offset {self.scale.offset!r})"

    def __repr__(self) -> str:
        """Both ends, as in the text."""
        return f"<Connection {self}>"

    @property
    def scale(self) -> Linear:
        """Linear function from the output to the input."""
        return Linear(1.0 if self.factor is None else float(self.factor), float(self.offset))


def unit_scale(source: Component, output: Variable, target: Component, input_: Variable) -> Linear | None:
    """Return the conversion from the unit of an output to the unit of an input.

    Returns
    -------
    Linear or None
        Linear function; None if the units have different dimensions. A variable without a unit needs no
        conversion.
    """
    units = source.description.unit(output), target.description.unit(input_)
    found = conversion(*units, relative=output.relative or input_.relative)
    return None if found is None else Linear(*found)


def checked_connection(connection: Connection, source: Component, target: Component) -> Connection:
    """Check a connection, and replace a missing factor by the conversion between both units.

    Raises
    ------
    SystemDescriptionError
        If causalities, types or units of the ends do not fit together, or a factor or offset is not allowed.
    """
    output, input_ = source.variable(connection.output), target.variable(connection.input)
    if output.causality != "output":
        turned = input_.causality == "output" and output.causality == "input"
        advice = "turn it round" if turned else "connections begin at outputs"
        msg = f"Connection {connection}: {output.name} has causality {output.causality}, not output; {advice}."
        raise SystemDescriptionError(msg)
    if input_.causality != "input":
        advice = "only inputs can be driven"
        msg = f"Connection {connection}: {input_.name} has causality {input_.causality}, not input; {advice}."
        raise SystemDescriptionError(msg)
    if output.type != input_.type:
        advice = f"connect an output of type {input_.type}"
        msg = f"Connection {connection}: types {output.type} and {input_.type} differ; {advice}."
        raise SystemDescriptionError(msg)
    scale = connection.scale
    if connection.factor is None:
        by_units = unit_scale(source, output, target, input_)
        if by_units is None:
            advice = f"connect an output in {input_.unit}, or give a Connection with a factor"
            msg = f"Connection {connection}: units {output.unit} and {input_.unit} differ; {advice}."
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
    """Refuse a variable whose start value a user must not set.

    Raises
    ------
    SystemDescriptionError
        If the FMU computes the start value.
    """
    path = f"{component.name}.{variable.name}"
    if not variable.can_start:
        settable = [v.name for v in component.description.variables.values() if v.can_start]
        close = [f"{component.name}.{name}" for name in near(base_name(variable.name), settable)]
        meant = f"did you mean {' or '.join(close)}?" if close else "leave it out."
        which = "only parameters, inputs and initial states"
        msg = f"{path} has causality {variable.causality}; {which} can be set; {meant}"
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


def start_value(path: str, variable: Variable, value: float | bool | str) -> float | str:
    """Convert a start value to the type of its variable; Booleans become 0 or 1, names of items their numbers.

    Parameters
    ----------
    path
        Variable as ``component.variable``, for messages.
    variable
        Variable that takes the value.
    value
        Number, Boolean or text.

    Raises
    ------
    SystemDescriptionError
        If the value does not have the type of the variable.
    """
    if variable.type == STRING and isinstance(value, str):
        return value
    if isinstance(value, str) and value.strip() in variable.items:
        return float(variable.items[value.strip()])
    found = math.nan
    with suppress(ValueError, KeyError, TypeError):
        found = math.nan if variable.type == STRING else parse_value(value, variable.stands_for or variable.type)
    if math.isnan(found):
        msg = f"{path} = {shown(value)}: {_needed(variable, value)}."
        raise SystemDescriptionError(msg)
    return found


def _needed(variable: Variable, value: Any) -> str:
    """What a variable needs instead of a value that does not fit."""
    if variable.type == BOOLEAN:
        return "true or false is needed, since the variable is a Boolean"
    if variable.stands_for == BOOLEAN:
        return "0 or 1 is needed, since the variable stands for a Boolean"
    if variable.type == STRING:
        return "a text is needed, since the variable is a String"
    if variable.items:
        named = ", ".join(f"{name} ({number})" for name, number in list(variable.items.items())[:MOST_ITEMS])
        return f"an item of the Enumeration is needed, such as {named}"
    if INTEGER in (variable.type, variable.stands_for):
        return f"an integer of 32 bits is needed, a whole number of at most {2**31 - 1}"
    in_unit = f" in {variable.unit}" if variable.unit else ""
    text = str(value).strip()
    if isinstance(value, str) and (match := _NUMBER.match(text)) and text[match.end() :].strip() == variable.unit != "":
        return f"a plain number{in_unit} is needed; write {match[0]}"
    if isinstance(value, str) and _NUMBER.fullmatch(text.replace(",", ".", 1)) and text.count(",") == 1:
        return f"a plain number{in_unit} is needed; write {text.replace(',', '.')}"
    if hasattr(value, "__len__") and not isinstance(value, str):
        return f"the variable is a scalar, but {len(value)} values are given; one number{in_unit} is needed"
    if isinstance(value, str):
        return f"a plain number{in_unit} is needed, without a unit"
    return f"a finite number{in_unit} is needed"


def sources_of(components: Sequence[Component], target: Component, name: str) -> list[Component]:
    """Return all components, except the target, that have an output of a given name."""
    return [c for c in components if _has_output(c, name) and c is not target]


def _has_output(component: Component, name: str) -> bool:
    """Whether a component has an output of a given name."""
    variable = component.description.variables.get(name)
    return variable is not None and variable.causality == "output"
