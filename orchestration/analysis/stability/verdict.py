"""Whether a co-simulation algorithm is stable on a system at a step, before anything is run.

The units are identified at an operating point (`pulse_response`), the step-to-step
map of the coupled system is built (`step_map`), and its spectral radius rho says by what
factor deviations grow in a step at worst:

    growth rate = log(rho) / h          amplification over a run of T = rho^(T / h)

This is a linearisation at one instant: contacts that open, saturations that end and gains that change
with the motion need further instants (`at`). States of a unit that no connected input moves, or no
connected output shows, take no part.

A system whose undamped parts are coupled explicitly is unstable at every step: growth rate and
amplification say whether that matters.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from orchestration.analysis.stability.operating_point import operating_point
from orchestration.analysis.stability.step_limit import ABOVE, BELOW, FLOOR, GRID, Examined, Point, Search, radius_of
from orchestration.analysis.stability.step_map import Coupled
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import REAL
from orchestration.master.algorithm import (
    MAX_ORDER,
    NEWTON,
    PARALLEL,
    SEQUENTIAL,
    Algorithm,
    Correction,
    find_algorithm,
)
from orchestration.system.system import Connection, System

GAIN = 1e-6  # by which a connection's gain is changed
MOST_ORDERED = 5  # components of which all orders are tried


@dataclass(frozen=True)
class Verdict:
    """Whether an algorithm is stable on a system at a step.

    Attributes
    ----------
    step
        Communication step, s.
    stop_time
        The system's stop time, s; None if it has none.
    radius, threshold
        Spectral radius per step, and how wrong it may be.
    contraction
        Factor by which a sweep without relaxation multiplies the error of corrected inputs; None if
        nothing is corrected.
    largest_stable_step
        s, within 1 %; with sampled units, of a step that all sampling periods follow in proportion.
        None if every step is unstable, infinite if none in reach is.
    blame
        Connections with |d radius / d gain|, the largest first.
    advice
        Sentences.
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

    @property
    def stable(self) -> bool:
        """Whether deviations do not grow, as far as can be seen."""
        return self.radius <= 1 + self.threshold

    @property
    def growth_rate(self) -> float:
        """1/s; negative if deviations decay."""
        return math.log(max(self.radius, 1e-300)) / self.step

    @property
    def amplification(self) -> float | None:
        """Factor by which a deviation grows until the system's stop time; None if the system has no stop time."""
        if self.stop_time is None:
            return None
        exponent = self.growth_rate * self.stop_time
        return math.exp(exponent) if exponent < 700 else math.inf

    def _grown(self) -> str:
        return "" if self.stop_time is None else f": {self.amplification:.4g} times over {self.stop_time:g} s"

    def __str__(self) -> str:
        """Several lines for a terminal."""
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
    system: System, step: float | None = None, algorithm: str | Algorithm = "gauss-seidel", *, at: float = 0.0
) -> Verdict:
    """Judge an algorithm before it is run; see the module for what a verdict can say.

    Parameters
    ----------
    step
        s; the system's own if None. With step control, of a step of that size.
    at
        Time of the operating point, s, rounded down to a common tick; reached with Gauss-Seidel.

    Raises
    ------
    SystemDescriptionError
        If units cannot save their state, there is no step, or it does not fit the sample times.
    SimulationError
        If the operating point cannot be reached, or a unit not be stepped from there.
    """
    algorithm, step = find_algorithm(algorithm), system.run_step(step)
    if not (math.isfinite(step) and step > 0 and math.isfinite(at) and at >= 0):
        msg = f"The step {step!r} s must be positive, and the instant {at!r} s not negative."
        raise SystemDescriptionError(msg)
    with operating_point(system, step, at) as probes:
        examined = Examined(system, step, at, probes, algorithm)
        coupled = examined.coupled(step, algorithm.order)
        here = examined.judged(coupled, step)
        search = Search(examined, here)
        largest = search.largest()
        advice = [_limits(search, largest)]
        if not here.stable:
            advice += _alternatives(examined, coupled, here)
    contraction = coupled.contraction(algorithm, step)
    if contraction is not None and contraction >= 1:
        advice.append(_sweeps(algorithm, contraction))
    held = sum(system.resolve(f"{c.source}.{c.output}")[1].type != REAL for c in system.connections)
    if held:
        advice.append(f"{held} Integer or Boolean connections are taken as held.")
    return Verdict(
        *(system.name, algorithm.name, step, system.stop_time),
        *(here.radius, here.threshold, contraction, largest),
        blame=_blame(coupled, algorithm, step),
        advice=tuple(advice),
    )


def is_stable(system: System, step: float | None = None, algorithm: str | Algorithm = "gauss-seidel") -> bool:
    """Whether deviations do not grow at the start: `stability` without the search for steps and advice."""
    algorithm, step = find_algorithm(algorithm), system.run_step(step)
    with operating_point(system, step, 0.0) as probes:
        examined = Examined(system, step, 0.0, probes, algorithm)
        return examined.judged(examined.coupled(step, algorithm.order), step).stable


def _limits(search: Search, largest: float | None) -> str:
    """What the search found."""
    h = search.here.step
    if search.power is not None:
        return f"The radius exceeds 1 by a share of h^{search.power:.1f}: no step is stable, smaller ones grow slower."
    if largest is None:
        return f"No step down to {h * GRID**-BELOW:.3g} s is stable."
    if math.isinf(largest):
        return f"No step up to {h * GRID**ABOVE:.3g} s, as far as it can be examined, is unstable."
    if search.gap is not None:
        return (
            f"Use a step of at most {largest:.3g} s: one of {search.gap:.3g} s is unstable, and this one only too"
            " long to see what grows there."
        )
    if not search.here.stable:
        return f"Use a step of at most {largest:.3g} s."
    return f"Steps up to {largest:.3g} s, {largest / h:.3g} times this one, are stable."


def _alternatives(examined: Examined, coupled: Coupled, here: Point) -> Iterator[str]:
    """Sentences on what would be stable at this step, or would grow least."""
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
    good = [(radius, other) for radius, other in tried if radius <= 1 + max(here.threshold, FLOOR)]
    for radius, other in good[:3]:
        yield f"{_named(other, full, h)} is stable at this step (radius 1 {radius - 1:+.3g})."
    if not good:
        radius, other = min(tried, key=lambda pair: pair[0])
        if radius - 1 < 0.9 * (here.radius - 1):
            rate = math.log(radius) / h
            yield f"{_named(other, full, h)} grows least at this step, by {rate:.3g} 1/s (radius 1 {radius - 1:+.3g})."


def _named(algorithm: Algorithm, coupled: Coupled, h: float) -> str:
    """What to ask for; iterative beside newton where its sweeps converge."""
    contraction = coupled.contraction(algorithm, h)
    name = "newton or iterative" if contraction is not None and contraction < 1 else algorithm.name
    return f"{name} with order {algorithm.order}"


def _orders(examined: Examined, coupled: Coupled, here: Point) -> Iterator[str]:
    """A sentence on the best order of the components, if it is better by far."""
    names = [unit.name for unit in coupled.units]
    if len(names) > MOST_ORDERED:
        return
    trials = [
        (radius_of(coupled.ordered(order), examined.algorithm, here.step), order)
        for order in itertools.permutations(range(len(names)))
    ]
    radius, order = min(trials)
    if radius - 1 < 0.5 * (here.radius - 1) - here.threshold:
        listed = ", ".join(names[i] for i in order)
        yield f"The order {listed} has a radius of 1 {radius - 1:+.3g}."


def _sweeps(algorithm: Algorithm, contraction: float) -> str:
    if algorithm.correction is not None and algorithm.correction.method == NEWTON:
        return f"Sweeps alone would multiply their error by {contraction:.3g}; newton does not depend on that."
    return f"Sweeps multiply their error by {contraction:.3g}: only relaxation can make them converge; newton does."


def _blame(coupled: Coupled, algorithm: Algorithm, h: float) -> tuple[tuple[Connection, float], ...]:
    """|d radius / d gain| by connection, the largest first."""
    base, n = radius_of(coupled, algorithm, h), len(coupled.links)
    weights = []
    for j, link in enumerate(coupled.links):
        gains = np.ones(n)
        gains[j] += GAIN
        weights.append((link.connection, abs(radius_of(coupled, algorithm, h, gains) - base) / GAIN))
    return tuple(sorted(weights, key=lambda pair: -pair[1]))


def _step_text(step: float | None) -> str:
    if step is None:
        return "none is stable"
    return "no limit found" if math.isinf(step) else f"{step:.3g} s"
