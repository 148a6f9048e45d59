"""How much of each signal is error of the communication step: the same run with halved steps.

Three runs with the steps h, h/2 and h/4 are compared at the points of the first one. If the error of a signal is
e(h) = c h^p, the differences d_1 = y(h) - y(h/2) and d_2 = y(h/2) - y(h/4) give its order and its size:

    p = log2(|d_1| / |d_2|)             e(h) = d_1 2^p / (2^p - 1)

(L. F. Richardson, "The approximate arithmetical solution by finite differences", 1911.) Magnitudes are root mean
squares over the run. Sampling periods and start values stay the same, so the study sees what the coupling does, and
not what sampling does. A signal that jumps has its jumps a step later or earlier: then the mean square falls with the
square root of h, and the largest difference does not fall at all.
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from time import perf_counter

import numpy as np

from orchestration.analysis.doctor.case import Case
from orchestration.errors import OrchestrationError, SimulationError
from orchestration.fmi.codes import REAL
from orchestration.master.options import Options
from orchestration.master.simulate import prepare
from orchestration.results.result import Result
from orchestration.stages import stage

HALVINGS = 2
PIECES = 32  # of a run, between which the clock is read
MOST_VALUES = 20_000_000  # recorded in a run
ROUNDING = 1e-9  # of the range: differences that rounding and the FMUs' own solvers explain
LEAST_ORDER, JUMPING_ORDER, MOST_ORDER = 0.7, 0.25, 6.0


class Kind(StrEnum):
    """What halving the step does to a signal."""

    ORDER = "order"
    EXACT = "exact"
    JUMPS = "jumps"
    NONE = "none"


@dataclass(frozen=True)
class SignalError:
    """Error of a signal that comes from the communication step.

    Attributes
    ----------
    name, unit
        Signal as ``component.variable``, and its unit.
    kind
        ``order``: the error falls with a power of the step. ``exact``: no error is to be seen. ``jumps``: the signal
        jumps at instants that depend on the step. ``none``: smaller steps do not bring the runs together.
    order
        Observed order; None unless the kind is ``order``.
    error, largest
        Estimated error of the run, in the unit of the signal: its root mean square, and its largest value. Where no
        order is seen, the difference to the run with half the step.
    relative, relative_largest
        The same as shares of the range of the signal.
    """

    name: str
    unit: str
    kind: Kind
    order: float | None
    error: float
    largest: float
    relative: float
    relative_largest: float


@dataclass(frozen=True)
class Study:
    """A run with halved steps.

    Attributes
    ----------
    steps
        Steps of the runs that were made, s, the longest first.
    until
        Time that all of them reached, s.
    signals
        Errors of all Real outputs, the largest share of the range first; empty with fewer than two runs.
    result
        Rows of the run with the longest step; None if it failed.
    spread
        How many times larger the differences between the first two runs are over the whole run than over its first
        tenth; infinite if there are none at first, 1 with fewer than two runs.
    failure
        Why that run failed; empty if it did not.
    cause
        Why there are fewer runs than three; empty if there are three.
    """

    steps: tuple[float, ...]
    until: float
    signals: tuple[SignalError, ...]
    result: Result | None
    spread: float = 1.0
    failure: str = ""
    cause: str = ""


def study(case: Case, budget: float) -> Study:
    """Run a case with halved steps.

    Parameters
    ----------
    case
        Run that is examined.
    budget
        Time for all runs together, s. The first run gets an eighth of it; if that is not enough, the study ends at
        the time that was reached.
    """
    first = _Attempt(case, 1, budget / 2 ** (HALVINGS + 1))
    rows = first.run(_fitting(case))
    if rows is None:
        return Study((case.step,), first.reached, (), None, failure=first.failure)
    until = first.reached
    if case.algorithm.control is not None:
        cause = f"{case.algorithm.name} chooses its steps itself; its tolerance bounds their error."
        return Study((case.step,), until, (), rows, cause=cause)
    made, ends, cause = [rows], perf_counter() + budget, ""
    for i in range(1, HALVINGS + 1):
        finer = case.but(step=case.step / 2**i, stop_time=until)
        attempt = _Attempt(finer, 2**i, ends - perf_counter())
        found = attempt.run(until)
        if found is None or len(found.time) < len(rows.time):
            cause = attempt.failure or f"a step of {finer.step:.3g} s takes longer than the budget."
            break
        made.append(found)
    steps = tuple(case.step / 2**i for i in range(len(made)))
    return Study(steps, until, _errors(case, made), rows, _spread(made), cause=cause)


def failure_of(case: Case, budget: float) -> str:
    """Why a run is refused or fails; empty if it does not fail within a time, s."""
    attempt = _Attempt(case, 1, budget)
    try:
        attempt.run(_fitting(case))
    except OrchestrationError as error:
        return str(error)
    return attempt.failure


@dataclass
class _Attempt:
    """A run with one step, of which every `every`-th row is kept, and which ends when its time, s, is over."""

    case: Case
    every: int
    time: float
    failure: str = ""
    reached: float = 0.0

    def run(self, until: float) -> Result | None:
        """Run until a time, s, or the end of the time that the run has; None after a failure."""
        case = self.case
        options = Options(every=self.every, isolate=case.isolation)
        run = prepare(case.changed_system, case.stop_time, case.step, case.algorithm, options=options)
        doing = f"running {case.system.name} with a step of {case.step:.3g} s"
        try:
            with stage(doing, doing.replace("running", "ran")), run:
                times, limit = run.grid.times, perf_counter() + self.time
                for k in self._ends(until, times):
                    run.run(until=float(times[k]))
                    if perf_counter() > limit:
                        break
                self.reached = run.time
                return run.result()
        except SimulationError as error:
            self.failure = str(error)
            self.reached = 0.0 if error.result is None else float(error.result.time[-1])
            return None

    def _ends(self, until: float, times: np.ndarray) -> list[int]:
        """Indices of communication points at which the clock is read; all rows that are kept fit them."""
        n = int(np.searchsorted(times, until + self.case.step / 2) - 1)
        piece = max(1, n // (PIECES * self.every)) * self.every
        return [*range(piece, n, piece), n]


def _fitting(case: Case) -> float:
    """Time until which the rows of a run fit the memory that a study may take, s."""
    columns = sum(len(c.description.of_causality("output")) for c in case.system.components)
    n = min(case.n, max(1, MOST_VALUES // max(1, columns)))
    return case.stop_time if n == case.n else case.system.start_time + n * case.step


def _spread(made: list[Result]) -> float:
    """How many times larger the differences of two runs are over the whole run than over its first tenth."""
    if len(made) < HALVINGS:
        return 1.0
    span = np.ptp(made[1].rows, axis=0)
    apart = np.abs(made[0].rows - made[1].rows)[:, span > 0] / span[span > 0]
    early = _peak(apart[: max(2, len(apart) // 10)])
    return _peak(apart) / early if early else math.inf


def _errors(case: Case, made: list[Result]) -> tuple[SignalError, ...]:
    """Errors of all Real outputs from two or three runs with the same rows."""
    if len(made) < HALVINGS:
        return ()
    found = []
    for component in case.system.components:
        for variable in component.description.of_causality("output"):
            name = f"{component.name}.{variable.name}"
            if variable.type == REAL:
                found.append(signal_error(name, variable.unit, [rows[name] for rows in made]))
    return tuple(sorted(found, key=lambda signal: -signal.relative))


def signal_error(name: str, unit: str, values: list[np.ndarray]) -> SignalError:
    """Error of a signal from its values with the steps h, h/2 and h/4, or with the first two.

    Parameters
    ----------
    name, unit
        Signal as ``component.variable``, and its unit.
    values
        Values at the same instants, shape (n_rows,) each, the longest step first.
    """
    span = float(np.ptp(values[-1])) or float(np.abs(values[-1]).max(initial=0.0))
    first = values[0] - values[1]
    kind, order, factor = Kind.NONE, None, 1.0
    if _peak(first) <= ROUNDING * span:
        kind = Kind.EXACT
    elif len(values) > HALVINGS:
        second = values[1] - values[2]
        seen = _order(_size(first), _size(second))
        if seen >= LEAST_ORDER:
            kind, order, factor = Kind.ORDER, seen, 2**seen / (2**seen - 1)
        elif seen >= JUMPING_ORDER and _peak(second) > _peak(first) / 2:
            kind = Kind.JUMPS
    error, largest = factor * _size(first), factor * _peak(first)
    relative = [value / span if span else 0.0 if value == 0 else math.inf for value in (error, largest)]
    return SignalError(name, unit, kind, order, error, largest, *relative)


def _order(first: float, second: float) -> float:
    """Observed order; of differences that vanish, the highest that is believed."""
    return min(MOST_ORDER, math.log2(first / second)) if second > 0 else MOST_ORDER


def _size(values: np.ndarray) -> float:
    """Root mean square, of numbers whose squares may overflow."""
    peak = _peak(values)
    return peak * float(np.sqrt(np.mean(np.square(values / peak)))) if peak else 0.0


def _peak(values: np.ndarray) -> float:
    return float(np.abs(values).max(initial=0.0))
