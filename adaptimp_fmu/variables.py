"""Scalar variables of a model, with all attributes that FMI 2.0 declares for them."""

import enum
import math
import re
from dataclasses import dataclass

from adaptimp_fmu.display_units import advice, require_display_unit
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.units import base_exponents

INTEGER_LIMIT = 2**31 - 1
_NAME = re.compile(r"[A-Za-z_]\w*(\[[1-9]\d*(,[1-9]\d*)*\])?", re.ASCII)


class Role(enum.Enum):
    """Role of a variable: parameter, input or output; the value is the role's name in the runtime.

    Examples
    --------
    >>> from adaptimp_fmu import Role, SampledModel
    >>> model = SampledModel("Gain", "A gain")
    >>> k = model.parameter("k", 2.0, description="Gain", tunable=True)
    >>> [variable.name for variable in model.with_role(Role.FIXED_PARAMETER, Role.TUNABLE_PARAMETER)]
    ['sample_time', 'k']
    >>> Role.TUNABLE_PARAMETER.is_parameter, Role.INPUT.is_parameter
    (True, False)
    """

    FIXED_PARAMETER = "ROLE_FIXED_PARAMETER"
    TUNABLE_PARAMETER = "ROLE_TUNABLE_PARAMETER"
    INPUT = "ROLE_INPUT"
    OUTPUT = "ROLE_OUTPUT"

    @property
    def is_parameter(self) -> bool:
        """Whether the variable is a parameter."""
        return self in (Role.FIXED_PARAMETER, Role.TUNABLE_PARAMETER)


class Type(enum.Enum):
    """Type of a variable in FMI 2.0; the value is the element's name in modelDescription.xml.

    Examples
    --------
    >>> from adaptimp_fmu import SampledModel, Type
    >>> model = SampledModel("Counter", "Counts ticks while it is enabled")
    >>> enabled = model.input("enabled", 1, type=Type.BOOLEAN, description="Whether it counts")
    >>> n = model.state("n", 0)
    >>> model.update(n, n + enabled)
    >>> model.output("n", n, type=Type.INTEGER, description="Number of ticks")
    """

    REAL = "Real"
    INTEGER = "Integer"
    BOOLEAN = "Boolean"


_NEEDED = {
    Type.REAL: "a finite number",
    Type.INTEGER: f"a whole number of at most {INTEGER_LIMIT}",
    Type.BOOLEAN: "True or False",
}


@dataclass(frozen=True)
class Variable:
    """A scalar variable of a model.

    Attributes
    ----------
    name
        Structured name, elements 1-based: ``q[1]``, ``M[1,2]``.
    start
        Start value in `unit`; ``None`` for outputs, which are calculated.
    minimum, maximum
        Closed range in `unit`, infinite where there is no bound.
    display_unit
        Unit in which tools show the value, such as ``deg`` for rad; empty if it is `unit`.
    stands_for
        Type of the values that a Real may have: Booleans, which are 0 and 1, or Integers. None for all numbers.

    Raises
    ------
    DefinitionError
        If FMI 2.0 or a reader could not use the variable.

    Examples
    --------
    >>> from adaptimp_fmu import SampledModel
    >>> model = SampledModel("Gain", "A gain")
    >>> k = model.parameter("k", [2.0, 3.0], unit="N/m", description="Gain for each axis")
    >>> [(variable.name, variable.start, variable.unit) for variable in model.variables]
    [('sample_time', 0.0001, 's'), ('k[1]', 2.0, 'N/m'), ('k[2]', 3.0, 'N/m')]
    >>> from adaptimp_fmu import NOT_NEGATIVE
    >>> d = model.parameter("d", 0.1, unit="m", limits=NOT_NEGATIVE, description="Dead zone")
    >>> model.variables[-1].range
    'at least 0 m'
    >>> model.variables[-1].require(-1.0, "d")
    Traceback (most recent call last):
        ...
    adaptimp_fmu.errors.DefinitionError: d -1.0 must be at least 0 m.
    """

    name: str
    role: Role
    type: Type
    unit: str
    description: str
    start: float | None = None
    minimum: float = -math.inf
    maximum: float = math.inf
    display_unit: str = ""
    stands_for: Type | None = None

    def __post_init__(self) -> None:
        """Refuse what FMI 2.0 or a reader could not use."""
        if not _NAME.fullmatch(self.name):
            advice = "use letters, digits and _, and count elements from 1"
            msg = f"{self.name!r} is not a structured FMI name such as q, q[1] or M[1,2]; {advice}."
            raise DefinitionError(msg)
        if not self.description:
            msg = f"{self.name}: a description is missing; give one, such as description='Joint angle'."
            raise DefinitionError(msg)
        if self.unit and self.type is not Type.REAL:
            msg = f"{self.name}: only a Real has a unit, this is a {self.type.value} in {self.unit}."
            raise DefinitionError(msg)
        self._require_units()
        if self.start is not None:
            self.require(self.start, f"{self.name}: start")

    def require(self, value: float, what: str) -> None:
        """Refuse a value that the variable cannot have, with a `DefinitionError` whose message begins with `what`."""
        if not self._is_of_type(value):
            msg = f"{what} {value!r} is not of type {self.type.value}; {_NEEDED[self.type]} is needed."
            raise DefinitionError(msg)
        if not self.minimum <= value <= self.maximum:
            msg = f"{what} {value!r} must be {self.range}."
            raise DefinitionError(msg)

    @property
    def range(self) -> str:
        """What the value must be, such as ``at least 0 N/m``; empty if it can be any."""
        if self.stands_for is not None:
            return whole_range_in_words(self.minimum, self.maximum)
        return range_in_words(self.minimum, self.maximum, self.unit)

    def _require_units(self) -> None:
        """Refuse a unit that is not coherent with the SI, and a display unit that does not fit it."""
        try:
            base_exponents(self.unit)
        except DefinitionError as error:
            meant = advice(self.unit)
            msg = f'{self.name}: unit "{self.unit}": {meant}' if meant else f"{self.name}: {error}"
            raise DefinitionError(msg) from error
        if not self.display_unit:
            return
        try:
            require_display_unit(self.display_unit, self.unit)
        except DefinitionError as error:
            msg = f"{self.name}: {error}"
            raise DefinitionError(msg) from error

    def _is_of_type(self, value: float) -> bool:
        """Whether a value is the same number in XML, which is written by type, and in C, which stores doubles."""
        if self.type is Type.BOOLEAN:
            return value in (0, 1)
        if self.type is Type.INTEGER:
            return abs(value) <= INTEGER_LIMIT and float(value).is_integer()
        return math.isfinite(value)


def element_names(name: str, shape: int | None) -> list[str]:
    """Return the names of a variable's scalars: the name if `shape` is None, else ``name[1]`` to ``name[n]``."""
    return [name] if shape is None else [f"{name}[{i + 1}]" for i in range(shape)]


def matrix_names(name: str, n: int) -> list[str]:
    """Return the names of the elements of a square matrix of n rows: ``name[1,1]``, ``name[1,2]``, ..., row by row."""
    return [f"{name}[{i + 1},{j + 1}]" for i in range(n) for j in range(n)]


def range_in_words(minimum: float, maximum: float, unit: str) -> str:
    """Return what a value must be, such as ``at least 0 N/m``; empty if both bounds are infinite."""
    with_unit = f" {unit}" if unit else ""
    least, most = _short(minimum), _short(maximum)
    if math.isfinite(minimum) and math.isfinite(maximum):
        return f"from {least} to {most}{with_unit}"
    if math.isfinite(minimum):
        return f"at least {least}{with_unit}"
    return f"at most {most}{with_unit}" if math.isfinite(maximum) else ""


def whole_range_in_words(minimum: float, maximum: float) -> str:
    """Return what a Real that stands for a Boolean or an Integer must be, such as ``0 or 1``."""
    if (minimum, maximum) == (0, 1):
        return "0 or 1"
    least, most = max(minimum, -INTEGER_LIMIT - 1), min(maximum, INTEGER_LIMIT)
    return f"a whole number from {least:.0f} to {most:.0f}"


def _short(value: float) -> str:
    """A number with as few digits as tell it from all others."""
    return repr(float(value)).removesuffix(".0")
