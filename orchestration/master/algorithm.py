"""Co-simulation algorithms, each the same small record: what is exchanged when, what is corrected.

One communication step from t to t + h, for every algorithm:

    save the continuous units                               if inputs are corrected
    sweep: set inputs, doStep, get outputs
        sequential: component by component                  (Gauss-Seidel)
        parallel:   all inputs, all steps, all outputs      (Jacobi)
    until inputs and outputs at t + h agree:                if inputs are corrected
        correct the inputs; restore the continuous units; sweep over them again

A sampled unit takes part in the first sweep only: its tick has happened, and its outputs hold. Its
inputs are never extrapolated. Inputs of continuous units that come from continuous units follow,
over a step, a polynomial of degree `order` through the values of their sources at t + h, as far as
these are known or assumed, and at the communication points before. Degree 0 holds a value.

With step control, a step is made once as a whole and once in halves; their difference, divided by
2^(order + 1) - 1, estimates the error of the halves (E. Hairer, S. Noersett, G. Wanner, "Solving
Ordinary Differential Equations I", II.4), and a PI controller chooses the next step (K. Gustafsson,
"Control theoretic techniques for stepsize selection in explicit Runge-Kutta methods", 1991).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from orchestration.errors import SystemDescriptionError

SEQUENTIAL, PARALLEL = "sequential", "parallel"
FIXED_POINT, NEWTON = "fixed-point", "newton"
DIFFERENCES, DIRECTIONAL = "differences", "directional"
MAX_ORDER = 2


def _choice(what: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        msg = f"There is no {what} {value!r}; there are {', '.join(known)}."
        raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class Tolerance:
    """An error is accepted up to ``absolute + relative |value|``.

    Attributes
    ----------
    relative
        Dimensionless.
    absolute
        By unit, such as ``{"m": 1e-9, "N": 1e-3}``, in that unit; `relative` where none is given.
    """

    relative: float
    absolute: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse numbers that accept nothing."""
        for name, value in (("relative", self.relative), *self.absolute.items()):
            if not (math.isfinite(value) and value > 0):
                msg = f"The tolerance {name} = {value!r} is not positive and finite."
                raise SystemDescriptionError(msg)

    def absolute_of(self, unit: str) -> float:
        """The absolute part for a variable of that unit."""
        return self.absolute.get(unit, self.relative)


@dataclass(frozen=True)
class Correction:
    """Iterate each step until inputs and outputs at its end agree.

    Attributes
    ----------
    method
        `FIXED_POINT` with Aitken's relaxation, or `NEWTON`.
    tolerance
        Of the difference between an input and its source.
    max_iterations
        Sweeps per step; one more is an error that names the worst connection.
    sweeps
        Make exactly so many sweeps and test nothing, if given.
    jacobian
        Of Newton: `DIFFERENCES` of repeated steps, or `DIRECTIONAL` derivatives of the units, which see
        direct feedthrough only (`PARALLEL` exchange).
    """

    method: str = FIXED_POINT
    tolerance: Tolerance = Tolerance(1e-9)
    max_iterations: int = 50
    sweeps: int | None = None
    jacobian: str = DIFFERENCES

    def __post_init__(self) -> None:
        """Check the choices."""
        _choice("correction", self.method, (FIXED_POINT, NEWTON))
        _choice("Jacobian", self.jacobian, (DIFFERENCES, DIRECTIONAL))
        for name, value in (("max_iterations", self.max_iterations), ("sweeps", self.sweeps)):
            if value is not None and not (isinstance(value, int) and value >= 1):
                msg = f"{name} = {value!r}: an integer of at least 1 is needed."
                raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class StepControl:
    """Choose the step by its estimated error.

    Attributes
    ----------
    tolerance
        Of the outputs of continuous units at the stop time: a step may spend the share of it that it
        takes of the run, so that the errors of all steps add up to it. Outputs that declare a
        dependency on an input do not add up errors; each step may spend all of it.
    first, smallest, largest
        Steps, s. If None: the system's step, 1e-6 of it, and the time between two ticks (or the whole run).
    """

    tolerance: Tolerance = Tolerance(1e-4)
    first: float | None = None
    smallest: float | None = None
    largest: float | None = None

    def __post_init__(self) -> None:
        """Check the steps."""
        for name in ("first", "smallest", "largest"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                msg = f"The {name} step {value!r} s is not positive and finite."
                raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class Algorithm:
    """A co-simulation algorithm.

    Attributes
    ----------
    exchange
        `SEQUENTIAL` or `PARALLEL`.
    order
        Degree, 0 to 2, of the inputs' polynomials; units that cannot interpolate hold their inputs.
    correction, control
        See `Correction` and `StepControl`; None for none.
    """

    name: str
    exchange: str = SEQUENTIAL
    order: int = 0
    correction: Correction | None = None
    control: StepControl | None = None

    def __post_init__(self) -> None:
        """Check the choices."""
        _choice("exchange", self.exchange, (SEQUENTIAL, PARALLEL))
        if self.order not in range(MAX_ORDER + 1):
            msg = f"The order {self.order!r} of the inputs is none of 0, 1, 2."
            raise SystemDescriptionError(msg)
        if self.correction is None:
            return
        if self.correction.jacobian == DIRECTIONAL and self.exchange != PARALLEL:
            msg = "Directional derivatives serve the parallel exchange only; use differences."
            raise SystemDescriptionError(msg)

    @property
    def plain(self) -> bool:
        """Whether nothing is extrapolated, corrected or controlled."""
        return self.order == 0 and self.correction is None and self.control is None

    @property
    def rolls_back(self) -> bool:
        """Whether units must save and restore their state."""
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


def find_algorithm(algorithm: str | Algorithm) -> Algorithm:
    """An algorithm by name; one that is given is returned.

    Raises
    ------
    SystemDescriptionError
        Listing the known names.
    """
    if isinstance(algorithm, Algorithm):
        return algorithm
    try:
        return ALGORITHMS[algorithm]
    except KeyError:
        msg = f"There is no algorithm {algorithm!r}; there are {', '.join(ALGORITHMS)}."
        raise SystemDescriptionError(msg) from None
