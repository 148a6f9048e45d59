"""Co-simulation algorithms: when values are exchanged, and which of them are corrected.

Every algorithm is one small record, `Algorithm`. A communication step goes from t to t + h:

    save the states of the continuous components            if inputs are corrected
    sweep: set inputs, doStep, get outputs
        sequential: component by component                  (Gauss-Seidel)
        parallel:   all inputs, all steps, all outputs      (Jacobi)
    until inputs and outputs at t + h agree:                if inputs are corrected
        correct the inputs; restore the continuous components; sweep over these components again

A sampled component takes part in the first sweep only, because its tick has happened then and its
outputs hold. Inputs of sampled components are never extrapolated. An input of a continuous component
follows a polynomial over a step if its source is continuous too. This polynomial has the degree
`order`. It passes through the values of the source at the communication points before, and through
the value at t + h as far as that is known or assumed. Degree 0 holds a value.

With step control, a step is made once as a whole and once in two halves. The difference of the two
results, divided by 2^(order + 1) - 1, estimates the error of the halves (E. Hairer, S. Noersett,
G. Wanner, "Solving Ordinary Differential Equations I", II.4). A PI controller chooses the next step
(K. Gustafsson, "Control theoretic techniques for stepsize selection in explicit Runge-Kutta
methods", 1991).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.given import positive, require_type
from orchestration.fmi.names import suggestion

SEQUENTIAL, PARALLEL = "sequential", "parallel"
FIXED_POINT, NEWTON = "fixed-point", "newton"
DIFFERENCES, DIRECTIONAL = "differences", "directional"
MAX_ORDER = 2


def _choice(what: str, value: str, known: tuple[str, ...]) -> None:
    """Refuse a value that is not known, with a message that lists the known values."""
    if value not in known:
        msg = f"There is no {what} {value!r}; {suggestion(str(value), known)}"
        raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class Tolerance:
    """Bound of an error that is accepted: ``absolute + relative |value|``.

    Attributes
    ----------
    relative
        Share of the absolute value, dimensionless.
    absolute
        Absolute part for each physical unit, such as ``{"m": 1e-9, "N": 1e-3}``. A unit that is missing
        here gets the number `relative`, in that unit.

    Raises
    ------
    SystemDescriptionError
        If a number is not positive and finite.

    Examples
    --------
    >>> from orchestration import Tolerance
    >>> tolerance = Tolerance(1e-6, {"N": 1e-3})  # forces to 1 mN, everything else to 1e-6 of its unit
    >>> tolerance.absolute_of("N"), tolerance.absolute_of("m")
    (0.001, 1e-06)
    """

    relative: float
    absolute: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse numbers that are not positive and finite."""
        require_type("The absolute tolerance", self.absolute, Mapping, 'give one for each unit, as {"m": 1e-9}')
        positive("The relative tolerance", self.relative, unit="")
        for name, value in self.absolute.items():
            positive(f"The absolute tolerance in {name}", value, unit=name)

    def absolute_of(self, unit: str) -> float:
        """Return the absolute part for a variable with the physical unit `unit`, in that unit."""
        return self.absolute.get(unit, self.relative)


@dataclass(frozen=True)
class Correction:
    """How each step is repeated until inputs and outputs at the end of the step agree.

    Attributes
    ----------
    method
        `FIXED_POINT` iteration with Aitken's relaxation, or `NEWTON`.
    tolerance
        Accepted difference between an input and its source.
    max_iterations
        Largest number of sweeps in one step. A run that needs more ends in an error that names the worst
        connection.
    sweeps
        Exact number of sweeps in one step. With this number no agreement is tested. Default: sweep until
        inputs and outputs agree.
    jacobian
        Where Newton's method takes its Jacobian from: `DIFFERENCES` of repeated steps, or `DIRECTIONAL`
        derivatives that the FMUs compute. Directional derivatives see direct feedthrough only, and need
        the `PARALLEL` exchange.

    Raises
    ------
    SystemDescriptionError
        If a choice is not known, or a number of sweeps is not a positive integer.

    Examples
    --------
    >>> from orchestration import Algorithm, Connection, Correction, System, scenario, simulate
    >>> dampers = [Connection("arm", f"dq[{i}]", "arm", f"tau[{i}]", factor=-20.0) for i in (1, 2)]  # N.m.s/rad
    >>> system = System.of({"arm": scenario("fig2")["plant"]}).connect(*dampers)
    >>> implicit = Algorithm("implicit", order=1, correction=Correction("newton"))
    >>> result = simulate(system, stop_time=1.0, step=1e-2, algorithm=implicit)
    >>> int(result.metadata["sweeps"]) / int(result.metadata["steps_made"])  # sweeps in a step
    3.72
    """

    method: str = FIXED_POINT
    tolerance: Tolerance = Tolerance(1e-9)
    max_iterations: int = 50
    sweeps: int | None = None
    jacobian: str = DIFFERENCES

    def __post_init__(self) -> None:
        """Refuse unknown choices and impossible numbers of sweeps."""
        require_type("The tolerance of a correction", self.tolerance, Tolerance, "give a Tolerance, as Tolerance(1e-9)")
        _choice("correction", self.method, (FIXED_POINT, NEWTON))
        _choice("Jacobian", self.jacobian, (DIFFERENCES, DIRECTIONAL))
        for name, value in (("max_iterations", self.max_iterations), ("sweeps", self.sweeps)):
            if value is not None and not (isinstance(value, int) and value >= 1 and value is not True):
                msg = f"{name} = {value!r}: an integer of at least 1 is needed."
                raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class StepControl:
    """How the length of each step is chosen from its estimated error.

    Attributes
    ----------
    tolerance
        Accepted error of the outputs of continuous components at the stop time. The errors of all steps
        add up, so a step that takes a tenth of the run may spend a tenth of the tolerance. Errors of
        outputs with direct feedthrough do not add up; for these outputs each step may spend the whole
        tolerance.
    first
        Length of the first step, s. Default: the step of the run.
    smallest
        Shortest step that is tried before the run ends in an error, s. Default: 1e-6 of the step of the run.
    largest
        Longest step, s. Default: the time between two ticks, or the whole run if nothing is sampled.

    Raises
    ------
    SystemDescriptionError
        If a step is not positive and finite.

    Examples
    --------
    >>> from orchestration import Algorithm, Connection, StepControl, System, Tolerance, scenario, simulate
    >>> dampers = [Connection("arm", f"dq[{i}]", "arm", f"tau[{i}]", factor=-20.0) for i in (1, 2)]  # N.m.s/rad
    >>> system = System.of({"arm": scenario("fig2")["plant"]}).connect(*dampers)
    >>> for accepted in (1e-3, 1e-6):
    ...     controlled = Algorithm("mine", order=1, control=StepControl(Tolerance(accepted)))
    ...     result = simulate(system, stop_time=1.0, step=1e-2, algorithm=controlled)
    ...     print(accepted, result.metadata["steps_made"], "steps")
    0.001 1... steps
    1e-06 4... steps
    """

    tolerance: Tolerance = Tolerance(1e-4)
    first: float | None = None
    smallest: float | None = None
    largest: float | None = None

    def __post_init__(self) -> None:
        """Refuse steps that are not positive and finite."""
        example = "give a Tolerance, as Tolerance(1e-4)"
        require_type("The tolerance of a step control", self.tolerance, Tolerance, example)
        for name in ("first", "smallest", "largest"):
            value = getattr(self, name)
            if value is not None:
                positive(f"The {name} step", value)


@dataclass(frozen=True)
class Algorithm:
    """A co-simulation algorithm.

    Attributes
    ----------
    name
        Name of the algorithm in messages and in the metadata of results.
    exchange
        When values are exchanged: `SEQUENTIAL` (Gauss-Seidel) or `PARALLEL` (Jacobi).
    order
        Degree of the polynomials that inputs follow over a step, 0 to 2. A component whose FMU cannot
        interpolate holds its inputs.
    correction
        How a step is repeated. Default: each step is made once.
    control
        How the length of a step is chosen. Default: all steps are equal.

    Raises
    ------
    SystemDescriptionError
        If a choice is not known, or the choices do not fit together.

    Examples
    --------
    >>> from orchestration import Algorithm, Connection, System, compare, scenario, simulate
    >>> dampers = [Connection("arm", f"dq[{i}]", "arm", f"tau[{i}]", factor=-20.0) for i in (1, 2)]  # N.m.s/rad
    >>> system = System.of({"arm": scenario("fig2")["plant"]}).connect(*dampers)
    >>> exact = simulate(system, stop_time=1.0, step=1e-4, algorithm=Algorithm("parabolas", order=2))
    >>> for order in (0, 1, 2):
    ...     algorithm = Algorithm("mine", order=order)  # inputs are held, follow a line, a parabola
    ...     result = simulate(system, stop_time=1.0, step=1e-2, algorithm=algorithm)
    ...     print(order, f"{compare(exact, result).worst.relative:.0e}")
    0 3e-01
    1 6e-02
    2 6e-02

    Properties say what an algorithm demands of the FMUs:

    >>> Algorithm("held").plain, Algorithm("mine", order=1).plain
    (True, False)
    >>> from orchestration import StepControl
    >>> Algorithm("mine", control=StepControl()).rolls_back  # so each FMU must save and restore its state
    True
    """

    name: str
    exchange: str = SEQUENTIAL
    order: int = 0
    correction: Correction | None = None
    control: StepControl | None = None

    def __post_init__(self) -> None:
        """Refuse unknown choices, and choices that do not fit together."""
        require_type("The name of an algorithm", self.name, str, "give a text, such as 'mine'")
        _choice("exchange", self.exchange, (SEQUENTIAL, PARALLEL))
        given = (("correction", self.correction, Correction), ("control", self.control, StepControl))
        for what, value, kind in given:
            require_type(f"The {what}", value, (kind, type(None)), f"give a {kind.__name__}, as {kind.__name__}()")
        if not isinstance(self.order, int) or self.order not in range(MAX_ORDER + 1):
            msg = f"The order {self.order!r} of the inputs is not 0, 1 or 2."
            raise SystemDescriptionError(msg)
        if self.correction is None:
            return
        if self.correction.jacobian == DIRECTIONAL and self.exchange != PARALLEL:
            msg = "Directional derivatives go with the parallel exchange only; use differences."
            raise SystemDescriptionError(msg)

    @property
    def plain(self) -> bool:
        """Whether inputs are held, each step is made once, and all steps are equal."""
        return self.order == 0 and self.correction is None and self.control is None

    @property
    def rolls_back(self) -> bool:
        """Whether components must save and restore their states."""
        return self.control is not None or (self.correction is not None and self.correction.sweeps != 1)


ALGORITHMS: Mapping[str, Algorithm] = {
    algorithm.name: algorithm
    for algorithm in (
        Algorithm("gauss-seidel"),
        Algorithm("jacobi", PARALLEL),
        Algorithm("iterative", PARALLEL, correction=Correction()),
        Algorithm("newton", PARALLEL, correction=Correction(NEWTON)),
        Algorithm("adaptive", order=1, control=StepControl()),
    )
}

SUMMARIES: Mapping[str, str] = {
    "gauss-seidel": "one component after the other, each with the newest outputs; steps of one length",
    "jacobi": "all components at once, with the outputs of the step before; steps of one length",
    "iterative": "repeats each step until inputs and outputs agree, by fixed-point iteration",
    "newton": "repeats each step until inputs and outputs agree, by Newton's method",
    "adaptive": "chooses the length of each step by an estimate of its error; inputs follow straight lines",
}
"""What each of `ALGORITHMS` does, in one line."""


def find_algorithm(algorithm: str | Algorithm) -> Algorithm:
    """Return the algorithm with a name; an `Algorithm` is returned as it is.

    Raises
    ------
    SystemDescriptionError
        If there is no algorithm of that name. The message gives near names.
    """
    if isinstance(algorithm, Algorithm):
        return algorithm
    try:
        return ALGORITHMS[algorithm]
    except (KeyError, TypeError):
        msg = f"There is no algorithm {algorithm!r}; {suggestion(str(algorithm), ALGORITHMS)}"
        raise SystemDescriptionError(msg) from None
