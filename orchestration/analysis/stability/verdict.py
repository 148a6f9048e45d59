"""Prediction, before a run, whether a co-simulation algorithm is stable on a system at a step.

All components are linearised at an operating point (`pulse_response`). The linear map of the coupled system
from one communication point to the next follows (`step_map`). Its spectral radius rho is the largest factor
by which a small deviation grows in one step:

    growth rate = log(rho) / h          amplification over a run of length T = rho^(T / h)

The prediction holds near one operating point. A contact that opens, a saturation that ends or a gain that
changes with the motion needs a second verdict at another time (`at`). The prediction excludes states that
connected inputs do not change, or that connected outputs do not show.

A system whose undamped parts are coupled explicitly is unstable at every step. Growth rate and amplification
then tell whether the instability matters in a run of the intended length.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

from orchestration.analysis.stability.influence import influences
from orchestration.analysis.stability.operating_point import operating_point
from orchestration.analysis.stability.step_limit import (
    ABOVE,
    BELOW,
    DOUBLING,
    FLOOR,
    GRID,
    Examined,
    Point,
    Search,
    radius_of,
)
from orchestration.analysis.stability.step_map import Coupled
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import REAL
from orchestration.fmi.display import escaped
from orchestration.fmi.given import a_number, positive
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import (
    MAX_ORDER,
    NEWTON,
    PARALLEL,
    SEQUENTIAL,
    Algorithm,
    Correction,
    find_algorithm,
)
from orchestration.sandbox.guard import Guard
from orchestration.system.system import Connection, System

MOST_ORDERED = 5  # most components for which all orders are tried


@dataclass(frozen=True)
class Alternative:
    """Another algorithm, or another order of the components, that is stable at the same step or grows less.

    Attributes
    ----------
    algorithm
        Co-simulation algorithm.
    order
        Names of the components in the order of stepping; None for the order of the system.
    radius
        Spectral radius per step.
    """

    algorithm: Algorithm
    order: tuple[str, ...] | None
    radius: float


@dataclass(frozen=True, repr=False)
class Verdict:
    """Predicted stability of a co-simulation algorithm on a system at a communication step.

    Attributes
    ----------
    system, algorithm
        Names of the system and of the algorithm.
    step
        Communication step, s.
    stop_time
        Stop time of the system, s, for the amplification; None if the system has none.
    radius
        Spectral radius per step.
    threshold
        Bound on the error of the radius.
    contraction
        Factor by which a sweep without relaxation multiplies the error of corrected inputs. None if the
        algorithm corrects no input.
    largest_stable_step
        Largest stable step, s, within 1 %. All sampling periods change in proportion to the step. None if
        every examined step is unstable, infinite if no examined step is unstable.
    blame
        Connections with their influence |d radius / d factor|, the largest first.
    advice
        Sentences for the user.
    better
        What is stable at this step, or at least grows less, if the algorithm is unstable.
    hidden
        Components that move so much during the experiment that not all of their states can be told from the motion.
        Then the radius is rough.

    Examples
    --------
    >>> from orchestration import scenario
    >>> verdict = scenario("fig2").with_sample_time(7e-3).stability(algorithm="jacobi")
    >>> verdict.stable, round(verdict.growth_rate, 1), verdict.amplification > 1e12, verdict.largest_stable_step < 6e-3
    (False, 14.1, True, True)
    >>> print(*verdict.advice[:2], sep="; ")
    Use a step of at most 0.00539 s.; gauss-seidel with order 0 is stable at this step (radius 1 -0.233).
    """

    system: str
    algorithm: str
    step: float
    stop_time: float | None
    radius: float
    threshold: float
    contraction: float | None
    largest_stable_step: float | None
    blame: tuple[tuple[Connection, float], ...]
    advice: tuple[str, ...]
    better: tuple[Alternative, ...] = ()
    hidden: tuple[str, ...] = ()

    @property
    def stable(self) -> bool:
        """Whether no deviation visibly grows: the radius exceeds 1 by at most the threshold, and by at most 1."""
        return self.radius <= 1 + min(self.threshold, DOUBLING)

    @property
    def growth_rate(self) -> float:
        """Growth rate of the fastest growing deviation, 1/s; negative if all deviations decay."""
        return math.log(max(self.radius, 1e-300)) / self.step

    @property
    def amplification(self) -> float | None:
        """Factor by which a deviation grows until the stop time, at worst; None if there is no stop time."""
        if self.stop_time is None:
            return None
        exponent = self.growth_rate * self.stop_time
        return math.exp(exponent) if exponent < 700 else math.inf

    def _grown(self) -> str:
        return "" if self.stop_time is None else f": {self.amplification:.4g} times over {self.stop_time:g} s"

    def __repr__(self) -> str:
        """Verdict in one line."""
        word = "stable" if self.stable else "unstable"
        what = f"{self.system}, {self.algorithm} with a step of {self.step:g} s"
        return f"<Verdict: {what} is {word}, radius 1 {self.radius - 1:+.3e} per step>"

    def _repr_html_(self) -> str:
        lines = "\n".join(map(escaped, str(self).split("\n")))
        return f"<pre>{lines}</pre>"

    def __str__(self) -> str:
        """Verdict as several lines of text for a terminal."""
        word = "stable" if self.stable else "UNSTABLE"
        if self.stable and self.largest_stable_step is None:
            word = "stable as far as can be seen"
        lines = [
            f"{self.system}: {self.algorithm} with a step of {self.step:g} s is {word}",
            f"  radius         1 {self.radius - 1:+.3e} per step, within {self.threshold:.1e}",
            f"  growth         {self.growth_rate:+.4g} 1/s{self._grown()}",
            f"  largest step   {_step_text(self.largest_stable_step)}",
        ]
        if self.contraction is not None:
            lines.append(f"  sweeps         leave {self.contraction:.3g} of their error without relaxation")
        lines += [f"  weight         {weight:9.3g}  {connection}" for connection, weight in self.blame[:3]]
        return "\n".join([*lines, *(f"  - {sentence}" for sentence in self.advice)])


def stability(
    system: System,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    at: float = 0.0,
    isolation: Isolation | None = None,
) -> Verdict:
    """Predict whether a co-simulation algorithm is stable on a system, and give advice.

    The docstring of the module states what the prediction covers.

    Parameters
    ----------
    system
        System whose components can save their states.
    step
        Communication step, s. Default: the step of the system. For an algorithm with step control, the
        verdict is about a step of this size.
    algorithm
        Co-simulation algorithm, or its name.
    at
        Time of the operating point, s, rounded down to a common tick of all sampled components. The run to
        the operating point uses the Gauss-Seidel algorithm.
    isolation
        Components whose FMUs live in processes of their own; none if it is None.

    Returns
    -------
    Verdict
        Spectral radius, largest stable step and advice.

    Raises
    ------
    SystemDescriptionError
        If a component cannot save its state, if there is no step or it does not fit a sampling period, or if
        the step or the time is out of range.
    SimulationError
        If the run to the operating point fails, or a step from there.
    """
    algorithm, step = find_algorithm(algorithm), system.run_step(step)
    step = positive("The step", step)
    if a_number("The time", at) < 0:
        msg = f"The time of the verdict, at = {at:g} s, is before the start at 0 s; give a later time."
        raise SystemDescriptionError(msg)
    guard = Guard()
    with operating_point(system, step, at, isolation, guard) as saved:
        examined = Examined(system, step, at, saved, algorithm, isolation, guard)
        coupled = examined.coupled(step, algorithm.order)
        here = examined.judged(coupled, step)
        search = Search(examined, here)
        largest = search.largest()
        advice, better = [_limits(search, largest)], list[Alternative]()
        if not here.stable:
            for sentence, found in _alternatives(examined, coupled, here):
                advice.append(sentence)
                better.append(found)
    contraction = coupled.contraction(algorithm, step)
    advice += _remarks(system, algorithm, contraction)
    hidden = tuple(model.name for model in coupled.models if model.map.hidden)
    if hidden and not here.stable:
        names = ", ".join(hidden)
        advice.append(f"The motion of {names} at that instant hides some of its states, so the radius is rough.")
    return Verdict(
        *(system.name, algorithm.name, step, system.stop_time),
        *(here.radius, here.threshold, contraction, largest),
        blame=influences(coupled, algorithm, step),
        advice=tuple(advice),
        better=tuple(better),
        hidden=hidden,
    )


def is_stable(
    system: System,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    isolation: Isolation | None = None,
) -> bool:
    """Whether a co-simulation algorithm is stable on a system at the start of a run; see `judged`."""
    return judged(system, step, algorithm, isolation=isolation).stable


def judged(
    system: System,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    at: float = 0.0,
    isolation: Isolation | None = None,
) -> Point:
    """Predict how much deviations grow in a step.

    This function is faster than `stability`, because it neither searches for steps nor gives advice.

    Parameters
    ----------
    system
        System whose components can save their states.
    step
        Communication step, s. Default: the step of the system.
    algorithm
        Co-simulation algorithm, or its name.
    at
        Time of the operating point, s, as for `stability`.
    isolation
        Components whose FMUs live in processes of their own; none if it is None.

    Raises
    ------
    SystemDescriptionError
        If a component cannot save its state, or the step does not fit a sampling period.
    SimulationError
        If the run to the operating point fails, or a step after it.
    """
    algorithm, step = find_algorithm(algorithm), system.run_step(step)
    with operating_point(system, step, at, isolation) as saved:
        examined = Examined(system, step, at, saved, algorithm, isolation)
        return examined.judged(examined.coupled(step, algorithm.order), step)


def _limits(search: Search, largest: float | None) -> str:
    """Sentence on the largest stable step."""
    h = search.here.step
    if search.power is not None:
        return f"The radius exceeds 1 by a share of h^{search.power:.1f}: no step is stable, smaller ones grow slower."
    if largest is None:
        return f"No step down to {h * GRID**-BELOW:.3g} s is stable."
    if math.isinf(largest):
        return f"No step up to {h * GRID**ABOVE:.3g} s, as far as it can be examined, is unstable."
    if search.gap is not None:
        return (
            f"Use a step of at most {largest:.3g} s: a step of {search.gap:.3g} s is unstable,"
            " and the given step is only too long to see that growth."
        )
    if not search.here.stable:
        return f"Use a step of at most {largest:.3g} s."
    return f"Steps up to {largest:.3g} s, {largest / h:.3g} times this one, are stable."


def _alternatives(examined: Examined, coupled: Coupled, here: Point) -> Iterator[tuple[str, Alternative]]:
    """Algorithms that are stable at this step, with a sentence each; or else a sentence on the one that grows least."""
    h, algorithm = here.step, examined.algorithm
    if algorithm.exchange == SEQUENTIAL and algorithm.correction is None:
        yield from _orders(examined, coupled, here)
    smooth = any(link.smooth for link in coupled.links)
    full = examined.coupled(h, MAX_ORDER) if smooth else coupled
    others = [Algorithm("gauss-seidel", order=p) for p in range(MAX_ORDER + 1)]
    others += [Algorithm("newton", PARALLEL, p, Correction(NEWTON)) for p in range(MAX_ORDER + 1)]
    if not smooth:
        others = others[:1]
    tried = [(radius_of(full, other, h), other) for other in others]
    good = [(radius, other) for radius, other in tried if radius <= 1 + min(max(here.threshold, FLOOR), DOUBLING)]
    for radius, other in good[:3]:
        sentence = f"{_named(other, full, h)} is stable at this step (radius 1 {radius - 1:+.3g})."
        yield sentence, Alternative(other, None, radius)
    if not good:
        radius, other = min(tried, key=lambda pair: pair[0])
        if radius - 1 < 0.9 * (here.radius - 1):
            rate = math.log(radius) / h
            named = _named(other, full, h)
            sentence = f"{named} grows least at this step, by {rate:.3g} 1/s (radius 1 {radius - 1:+.3g})."
            yield sentence, Alternative(other, None, radius)


def _named(algorithm: Algorithm, coupled: Coupled, h: float) -> str:
    """Name and order of an algorithm for the user, with ``iterative`` as an alternative where sweeps converge."""
    contraction = coupled.contraction(algorithm, h)
    name = "newton or iterative" if contraction is not None and contraction < 1 else algorithm.name
    return f"{name} with order {algorithm.order}"


def _orders(examined: Examined, coupled: Coupled, here: Point) -> Iterator[tuple[str, Alternative]]:
    """Best order of the components, if it is much better than the given order, with a sentence."""
    names = [model.name for model in coupled.models]
    if len(names) > MOST_ORDERED:
        return
    trials = [
        (radius_of(coupled.ordered(order), examined.algorithm, here.step), order)
        for order in itertools.permutations(range(len(names)))
    ]
    radius, order = min(trials)
    if radius - 1 < 0.5 * (here.radius - 1) - here.threshold:
        named = tuple(names[i] for i in order)
        sentence = f"The order {', '.join(named)} has a radius of 1 {radius - 1:+.3g}."
        yield sentence, Alternative(examined.algorithm, named, radius)


def _remarks(system: System, algorithm: Algorithm, contraction: float | None) -> Iterator[str]:
    """Sentences on sweeps that do not converge, and on connections that the prediction leaves out."""
    if contraction is not None and contraction >= 1:
        yield _sweeps(algorithm, contraction)
    outputs = (system.resolve(f"{c.source}.{c.output}")[1] for c in system.connections)
    held = sum(output.type != REAL or bool(output.stands_for) for output in outputs)
    if held:
        yield f"{held} Integer or Boolean connections are treated as constant during a step."


def _sweeps(algorithm: Algorithm, contraction: float) -> str:
    """Sentence on sweeps that do not converge."""
    if algorithm.correction is not None and algorithm.correction.method == NEWTON:
        return f"Sweeps alone would multiply their error by {contraction:.3g}; newton does not depend on sweeps."
    return f"Sweeps multiply their error by {contraction:.3g}: use newton, or relaxation so that sweeps converge."


def _step_text(step: float | None) -> str:
    """Largest stable step as text for a terminal."""
    if step is None:
        return "none is stable"
    return "no limit found" if math.isinf(step) else f"{step:.3g} s"
