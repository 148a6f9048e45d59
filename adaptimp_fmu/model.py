"""The declaration of a model, from which everything in its FMU follows.

Order of variables, value references, XML, C tables, dependencies and GUID follow from the
declaration. There are two kinds: a `ContinuousModel` has derivatives, which the runtime
integrates; a `SampledModel` is updated every ``sample_time``.

Every symbol is a CasADi ``SX`` column vector (a scalar is of length one).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.expressions import depends, expression
from adaptimp_fmu.guide import Guide
from adaptimp_fmu.icon import Icon
from adaptimp_fmu.metadata import Experiment, Ownership
from adaptimp_fmu.names import suggestion
from adaptimp_fmu.per_element import PerElement, Start, per_element, start_numbers
from adaptimp_fmu.references import ParameterSet, ReferenceRun
from adaptimp_fmu.variables import INTEGER_LIMIT, Role, Type, Variable, element_names, matrix_names


@dataclass(frozen=True)
class Limits:
    """Closed range of a parameter, in its unit.

    Examples
    --------
    `ANY`, `POSITIVE` and `NOT_NEGATIVE` are limits that are needed often.

    >>> from adaptimp_fmu import NOT_NEGATIVE, ContinuousModel, Limits
    >>> tank = ContinuousModel("Tank", "A tank with a valve")
    >>> valve = tank.parameter("valve", 0.5, limits=Limits(0.0, 1.0), description="How far the valve is open")
    >>> inflow = tank.parameter("inflow", 1.0, unit="m3/s", limits=NOT_NEGATIVE, description="Inflow")
    """

    minimum: float = -float("inf")
    maximum: float = float("inf")

    def __post_init__(self) -> None:
        """Refuse a range that no number is in."""
        if not self.minimum <= self.maximum:
            msg = f"Limits({self.minimum!r}, {self.maximum!r}): the minimum must not exceed the maximum; swap them."
            raise DefinitionError(msg)


SYMMETRY = 1e-12
"""Relative difference up to which two elements of a matrix are taken for equal."""
ANY = Limits()
POSITIVE = Limits(minimum=1e-12)
NOT_NEGATIVE = Limits(minimum=0.0)


@dataclass
class State:
    """A state vector of a model: its symbol, its first value, and its derivative or update.

    A `slow` state of a sampled model is updated at every n-th tick only.
    """

    name: str
    symbol: ca.SX
    initial: ca.SX
    evolution: ca.SX | None = None
    slow: bool = False


@dataclass(frozen=True)
class Check:
    """A condition on a model: the expression `value` must be positive, else `sentence` is the error message."""

    value: ca.SX
    sentence: str


@dataclass(frozen=True)
class Declaration:
    """Name, role, type and range of a variable that is declared; one range for all elements, or one each."""

    name: str
    role: Role
    type: Type
    limits: Limits | Sequence[Limits] = ANY


@dataclass
class Model:
    """Base of the two kinds of models, `ContinuousModel` and `SampledModel`.

    Parameters
    ----------
    name
        Model identifier, a C identifier.
    description
        One sentence for modelDescription.xml.

    Attributes
    ----------
    documentation
        Texts with the equations by title, for the documentation in the FMU.
    guide
        Formulas, drawings, partners and topics for the documentation; by default none.
    icon
        The FMU's picture.
    ownership
        Author, version, copyright and license; by default the FMU claims none of them.
    experiment
        Default experiment; by default the FMU suggests none.
    reference_runs, parameter_sets
        Runs that show another tool whether it simulates the FMU correctly, and sets of start values. The FMU carries
        them as files beside its definition.
    terminals
        Groups of variables that tools may connect as one: names of variables by name of the group; an array stands
        for its elements.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, Model, Role
    >>> def names(model: Model, *roles: Role) -> list[str]:
    ...     return [variable.name for variable in model.with_role(*roles)]
    >>> spring = ContinuousModel("Spring", "A spring")
    >>> x = spring.input("x", [0.0, 0.0], unit="m", description="Positions of both ends")
    >>> spring.output("F", 100.0 * (x[1] - x[0]), unit="N", description="Force")
    >>> names(spring, Role.INPUT), names(spring, Role.OUTPUT)
    (['x[1]', 'x[2]'], ['F'])

    What a model declares, and where a variable is in the FMU:

    >>> gain = ContinuousModel("Gain", "A gain with a memory")
    >>> k = gain.parameter("k", 2.0, unit="1/s", description="Rate of the memory")
    >>> u = gain.input("u", 0.0, description="Input")
    >>> y = gain.state("y", 0.0)
    >>> gain.derivative(y, k * (u - y))
    >>> gain.output("y", y, description="Input as it was a while ago")
    >>> gain.require(k, "k must be positive")
    >>> [variable.name for variable in gain.ordered_variables()], gain.reference("u")
    (['dt_max', 'k', 'u', 'y'], 2)
    """

    name: str
    description: str
    variables: list[Variable] = field(default_factory=list)
    parameter_symbols: list[ca.SX] = field(default_factory=list)
    input_symbols: list[ca.SX] = field(default_factory=list)
    output_values: list[ca.SX] = field(default_factory=list)
    states: list[State] = field(default_factory=list)
    static_checks: list[Check] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    time: ca.SX = field(default_factory=lambda: ca.SX.sym("t"))
    documentation: Mapping[str, str] = field(default_factory=dict)
    guide: Guide = field(default_factory=Guide)
    icon: Icon = field(default_factory=Icon)
    ownership: Ownership = field(default_factory=Ownership)
    experiment: Experiment = field(default_factory=Experiment)
    reference_runs: Sequence[ReferenceRun] = ()
    parameter_sets: Sequence[ParameterSet] = ()
    terminals: Mapping[str, Sequence[str]] = field(default_factory=dict)
    period_name: str = field(default="", init=False)

    def parameter(
        self,
        name: str,
        start: Start,
        *,
        unit: PerElement = "",
        display_unit: PerElement = "",
        description: PerElement,
        limits: Limits | Sequence[Limits] = ANY,
        tunable: bool = False,
        type: Type = Type.REAL,
    ) -> ca.SX:
        """Declare a parameter.

        Parameters
        ----------
        start
            A number for a scalar, a sequence for a vector.
        unit, description
            One for all elements, or one each. Units are coherent with the SI, such as rad and N.m.
        display_unit
            Unit in which tools show the value, such as ``deg``; one for all elements, or one each. The value
            itself is in `unit`.
        limits
            Range of all elements, or one each.
        tunable
            Whether it may change between steps.

        Returns
        -------
        SX
            Its symbol, shape (n,).

        Raises
        ------
        DefinitionError
            If a name, a unit, a start value or its range cannot be declared.
        """
        ranges = limits if isinstance(limits, Sequence) else [limits]
        if not all(isinstance(one, Limits) for one in ranges):
            msg = f"{self.name}.{name}: limits {limits!r} are not a range; give one, as Limits(0.0, 1.0), or one each."
            raise DefinitionError(msg)
        role = Role.TUNABLE_PARAMETER if tunable else Role.FIXED_PARAMETER
        if type is Type.INTEGER:
            ranges = [
                Limits(max(one.minimum, -INTEGER_LIMIT), INTEGER_LIMIT) if one.maximum == float("inf") else one
                for one in ranges
            ]
        limits = ranges if isinstance(limits, Sequence) else ranges[0]
        symbol = self._declare(Declaration(name, role, type, limits), start, (unit, display_unit, description))
        self.parameter_symbols.append(symbol)
        return symbol

    def symmetric_parameter(
        self,
        name: str,
        diagonal: Sequence[float],
        *,
        unit: PerElement = "",
        description: PerElement,
        limits: Limits = ANY,
        tunable: bool = False,
    ) -> ca.SX:
        """Declare a symmetric matrix of n rows as a parameter.

        All elements are declared, row by row: ``name[1,1]``, ``name[1,2]``, ..., ``name[n,n]``, because FMI 2.0 knows
        arrays without holes only. An element must be equal to the one across the diagonal to rounding, else it is an
        error when the parameters begin to act; the upper triangle is what counts.

        Parameters
        ----------
        diagonal
            Start values of the diagonal, shape (n,); the others start at 0.
        unit, description
            One for all elements, or one each.
        limits
            Range of the elements of the diagonal; the others may have any value.
        tunable
            Whether it may change between steps.

        Returns
        -------
        SX
            The matrix of its symbols, shape (n, n).

        Raises
        ------
        DefinitionError
            If a name, a unit, a start value or its range cannot be declared.

        Examples
        --------
        >>> from adaptimp_fmu import POSITIVE, SampledModel
        >>> model = SampledModel("Spring", "A spring in the plane")
        >>> K = model.symmetric_parameter("K", [4e3, 4e3], unit="N/m", limits=POSITIVE, description="Stiffness")
        >>> [variable.name for variable in model.variables], K.shape
        (['sample_time', 'K[1,1]', 'K[1,2]', 'K[2,1]', 'K[2,2]'], (2, 2))
        """
        values, _ = start_numbers(diagonal, f"{self.name}.{name}")
        n = len(values)
        places = [(i, j) for i in range(n) for j in range(n)]
        starts = [values[i] if i == j else 0.0 for i, j in places]
        role = Role.TUNABLE_PARAMETER if tunable else Role.FIXED_PARAMETER
        ranges = [limits if i == j else ANY for i, j in places]
        declared = Declaration(name, role, Type.REAL, ranges)
        self._add_variables(declared, matrix_names(name, n), starts, (unit, "", description))
        symbol = ca.SX.sym(name, len(places))
        self.parameter_symbols.append(symbol)
        matrix = ca.reshape(symbol, n, n).T
        diagonals = ca.sqrt(ca.fabs(ca.mtimes(ca.diag(matrix), ca.diag(matrix).T)))
        rounding = SYMMETRY * (ca.fabs(matrix) + ca.fabs(matrix.T) + diagonals)
        differing = ca.sum1(ca.vec(ca.fabs(matrix - matrix.T) > rounding))
        self.require(0.5 - differing, f"{name} must be symmetric: {name}[i,j] and {name}[j,i] must be equal; set both")
        return ca.triu2symm(ca.triu(matrix))

    def input(
        self,
        name: str,
        start: Start,
        *,
        unit: PerElement = "",
        display_unit: PerElement = "",
        description: PerElement,
        type: Type = Type.REAL,
    ) -> ca.SX:
        """Declare an input; see `parameter`."""
        symbol = self._declare(Declaration(name, Role.INPUT, type), start, (unit, display_unit, description))
        self.input_symbols.append(symbol)
        return symbol

    def output(
        self,
        name: str,
        value: ca.SX,
        *,
        unit: PerElement = "",
        display_unit: PerElement = "",
        description: PerElement,
        type: Type = Type.REAL,
        scalar: bool | None = None,
    ) -> None:
        """Declare an output and its value.

        Parameters
        ----------
        value
            Expression of shape (n,).
        scalar
            Whether a value of one element is called `name`, without an index. Default: yes, as an input or a
            parameter that starts with a number is; False calls it ``name[1]``.
        """
        value = expression(value, f"{self.name}: output {name}")
        one = value.numel() == 1 if scalar is None else scalar
        names = element_names(name, None if one else value.numel())
        starts = [None] * value.numel()
        self._add_variables(Declaration(name, Role.OUTPUT, type), names, starts, (unit, display_unit, description))
        self.output_values.append(value)

    def state(self, name: str, initial: ca.SX | Start) -> ca.SX:
        """Declare a state, shape (n,), from its first value; returns its symbol.

        The first value may depend on parameters and, in a sampled model, on the first tick's inputs.
        """
        initial = expression(initial, f"{self.name}: the first value of state {name}")
        symbol = ca.SX.sym(name, initial.numel())
        self.states.append(State(name, symbol, initial))
        return symbol

    def require(self, value: ca.SX, sentence: str) -> None:
        """Demand that `value` is positive.

        A demand on parameters alone is checked when they change, any other at every evaluation
        of the outputs.
        """
        value = expression(value, f"{self.name}: the demand {sentence!r}")
        static = not depends(value, [self.time, *self.input_symbols, *(s.symbol for s in self.states)])
        (self.static_checks if static else self.checks).append(Check(value, sentence))

    def with_role(self, *roles: Role) -> list[Variable]:
        """The variables of the given roles, in order."""
        return [variable for variable in self.variables if variable.role in roles]

    def ordered_variables(self) -> list[Variable]:
        """All variables in the order of their value references: parameters, inputs, outputs."""
        parameters = [variable for variable in self.variables if variable.role.is_parameter]
        return [*parameters, *self.with_role(Role.INPUT), *self.with_role(Role.OUTPUT)]

    def reference(self, name: str) -> int:
        """Value reference of a variable."""
        names = [variable.name for variable in self.ordered_variables()]
        if name not in names:
            msg = f"{self.name} has no variable {name}; {suggestion(name, names)}"
            raise DefinitionError(msg)
        return names.index(name)

    def _evolve(self, symbol: ca.SX, value: ca.SX) -> None:
        """Record what becomes of a state."""
        for state in self.states:
            if state.symbol is symbol:
                state.evolution = expression(value, f"{self.name}: the evolution of state {state.name}")
                if state.evolution.numel() != symbol.numel():
                    msg = (
                        f"{self.name}.{state.name} has {symbol.numel()} elements,"
                        f" its evolution {state.evolution.numel()}; it needs as many."
                    )
                    raise DefinitionError(msg)
                return
        msg = f"{self.name}: {symbol} is not a state of this model; declare it with model.state(...)."
        raise DefinitionError(msg)

    def _declare(self, declared: Declaration, start: Start, texts: tuple[PerElement, PerElement, PerElement]) -> ca.SX:
        """Add the scalars of a variable; returns its symbol."""
        starts, shape = start_numbers(start, f"{self.name}.{declared.name}")
        self._add_variables(declared, element_names(declared.name, shape), starts, texts)
        return ca.SX.sym(declared.name, len(starts))

    def _add_variables(
        self,
        declared: Declaration,
        names: Sequence[str],
        starts: Sequence[float | None],
        texts: tuple[PerElement, PerElement, PerElement],
    ) -> None:
        """Add scalars; the texts are unit, display unit and description."""
        name, role, type = declared.name, declared.role, declared.type
        taken = {variable.name.partition("[")[0] for variable in self.variables}
        if name.partition("[")[0] in taken:
            msg = f"{self.name} already has a variable {name}; give the other one another name."
            raise DefinitionError(msg)
        what = ("units", "display units", "descriptions")
        each = zip(*(per_element(text, names, w) for text, w in zip(texts, what, strict=True)), strict=True)
        ranges = [declared.limits] * len(names) if isinstance(declared.limits, Limits) else declared.limits
        if len(ranges) != len(names):
            msg = f"{names[0]}: {len(names)} elements but {len(ranges)} limits; give one for all, or one for each."
            raise DefinitionError(msg)
        for element, start, limits, (unit, shown, text) in zip(names, starts, ranges, each, strict=True):
            least, most = limits.minimum, limits.maximum
            self.variables.append(Variable(element, role, type, unit, text, start, least, most, shown))
