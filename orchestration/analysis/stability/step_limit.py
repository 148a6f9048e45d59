"""Search for the largest communication step at which a co-simulation algorithm is stable on a system.

At every examined step the components are identified again, so the verdict includes their own solvers. The
search examines steps with a ratio of sqrt(10), from the given step outwards. Bisection finds the limit between
a stable and an unstable step.

The spectral radius is uncertain, because the identified models are uncertain. The threshold of a verdict is
derived from the radii of other models that noise and drift allow as well. This method also covers the double
eigenvalue 1 of a free mass, which noise splits by the square root of its size.

An undamped system with explicit coupling is unstable at every step. The excess of the radius over 1 then falls
as a power of h, until the excess is smaller than the threshold. The search distinguishes such a fading excess
from a true limit by the size of the excess at the last step at which it is visible.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np

from orchestration.analysis.stability.operating_point import SavedComponent, operating_point
from orchestration.analysis.stability.pulse_response import identify
from orchestration.analysis.stability.step_map import Coupled
from orchestration.errors import SimulationError
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import Algorithm
from orchestration.sandbox.guard import Guard
from orchestration.system.system import System

FLOOR = 1e-11  # smallest threshold: rounding errors of the eigenvalues
SAMPLES, SEED = 6, 1991  # number of random models within the noise that give the threshold
GRID = math.sqrt(10.0)  # ratio of neighbouring examined steps
BELOW, ABOVE, NEAR = 6, 4, 3  # examined steps below an unstable given step, above it, and below a stable one
DOUBLING = 1.0  # excess over 1 of a deviation that doubles in each step: growth, however rough the models are
PRECISION = 0.01  # relative precision of the largest stable step
SMALL, MOST_POWER = 0.1, 6.0  # largest excess over 1 that can follow a power of h, and largest exponent
MOST_STEPS = 20000  # most steps of a run to the operating point during the search


@dataclass(frozen=True)
class Point:
    """Spectral radius of the coupled system at one communication step.

    Attributes
    ----------
    step
        Communication step, s.
    radius
        Spectral radius per step.
    threshold
        Bound on the error of the radius.
    """

    step: float
    radius: float
    threshold: float

    @property
    def stable(self) -> bool:
        """Whether no deviation visibly grows: the radius exceeds 1 by at most the threshold, and by at most 1."""
        return self.radius <= 1 + min(self.threshold, DOUBLING)

    @property
    def decays(self) -> bool:
        """Whether all deviations decay for certain: the radius is below 1 by more than the threshold."""
        return self.radius < 1 - self.threshold


@dataclass(frozen=True)
class Examined:
    """A system at its operating point, with the means to examine its stability at any step.

    Attributes
    ----------
    system
        Coupled system.
    step
        Communication step of the run to the operating point, s.
    at
        Time of the operating point, s.
    saved
        Components at the operating point.
    algorithm
        Co-simulation algorithm to be judged.
    isolation
        Which FMUs live in processes of their own.
    guard
        Puts back what an FMU changes in this process.
    """

    system: System
    step: float
    at: float
    saved: list[SavedComponent]
    algorithm: Algorithm
    isolation: Isolation | None = None
    guard: Guard = field(default_factory=Guard)

    def coupled(self, h: float, order: int) -> Coupled:
        """Linear coupled system at a step of h, s; all sampling periods change in proportion to the step."""
        with self._saved_at(h) as (system, saved):
            return Coupled.of(system, [identify(one, h, order) for one in saved], h)

    def judged(self, coupled: Coupled, h: float) -> Point:
        """Spectral radius of a linear system, and its threshold from other models within noise and drift."""
        radius, random = radius_of(coupled, self.algorithm, h), np.random.default_rng(SEED)
        off = [
            radius_of(replace(coupled, models=tuple(m.shaken(random) for m in coupled.models)), self.algorithm, h)
            for _ in range(SAMPLES)
        ]
        later = radius_of(replace(coupled, models=tuple(m.later() for m in coupled.models)), self.algorithm, h)
        spread = max(abs(r - radius) for r in off) if math.isfinite(radius) else 0.0
        drift = abs(later - radius) if math.isfinite(radius) else 0.0
        return Point(h, radius, FLOOR + 3 * spread + drift)

    def at_step(self, h: float) -> Point | None:
        """Spectral radius at another step, s; None if the system cannot be examined there."""
        if h < self.step and self.at / h > MOST_STEPS and self._periods():
            return None
        try:
            return self.judged(self.coupled(h, self.algorithm.order), h)
        except SimulationError:
            return None

    def _periods(self) -> dict[str, float]:
        """Sampling periods by component, s."""
        return {c.name: c.sample_time for c in self.system.components if c.sample_time is not None}

    @contextmanager
    def _saved_at(self, h: float) -> Iterator[tuple[System, list[SavedComponent]]]:
        """Provide the system and its components at the operating point, for a step of h, s."""
        periods = self._periods()
        if h == self.step or not periods:
            yield self.system, self.saved
            return
        scaled = {f"{name}.{SAMPLE_TIME}": period * h / self.step for name, period in periods.items()}
        system = self.system.set(scaled)
        with operating_point(system, h, self.at, self.isolation, self.guard) as saved:
            yield system, saved


@dataclass
class Search:
    """Search for the largest stable step, from the given step outwards.

    Attributes
    ----------
    examined
        System at its operating point.
    here
        Spectral radius at the given step.
    power
        Exponent p, if the system is unstable at every step and the excess of the radius falls as h^p; else None.
    gap
        Unstable step below a given step that is itself stable, s; None if there is no such step.
    """

    examined: Examined
    here: Point
    power: float | None = None
    gap: float | None = None

    def largest(self) -> float | None:
        """Largest stable step, s; None if no examined step is stable, infinite if all are stable."""
        if not self.here.stable:
            return self._downwards(self.here)
        below = [self._neighbour(self.here, -k) for k in range(1, NEAR + 1)]
        unstable = [point for point in below if point is not None and point.radius > 1 + 10 * point.threshold]
        if unstable:
            self.gap = unstable[0].step
            return self._downwards(unstable[-1])
        return self._upwards()

    def _downwards(self, unstable: Point) -> float | None:
        """Search for a stable step below an unstable one, s; None if there is none."""
        beyond = self._neighbour(unstable, 1)
        while unstable.step > 1.5 * self.here.step * GRID**-BELOW:
            point = self._neighbour(unstable, -1)
            if point is None:
                break
            if point.stable:
                return self._limit(point, unstable, beyond)
            beyond, unstable = unstable, point
        self.power = _power(unstable, beyond)
        return None

    def _upwards(self) -> float | None:
        """Search for an unstable step above the given one, and return the limit, s; infinite if there is none."""
        stable = self.here
        for _ in range(ABOVE):
            point = self._neighbour(stable, 1)
            if point is None:
                break
            if not point.stable:
                return self._limit(stable, point, self._neighbour(point, 1))
            stable = point
        return math.inf

    def _neighbour(self, point: Point, k: int) -> Point | None:
        """Spectral radius at the step k places away in the search; None if the step cannot be examined."""
        return self.examined.at_step(point.step * GRID**k)

    def _limit(self, stable: Point, unstable: Point, beyond: Point | None) -> float | None:
        """Largest stable step between two neighbours, s; None if the instability fades as a power of h."""
        return None if self._fades(stable, unstable, beyond) else self._between(stable, unstable)

    def _fades(self, stable: Point, unstable: Point, beyond: Point | None) -> bool:
        """Whether the excess over 1 falls below the threshold as a power of h, without a true limit."""
        if stable.decays:
            return False
        power = _power(unstable, beyond) or 2.0
        expected = (unstable.radius - 1) * (stable.step / unstable.step) ** power
        if expected > 3 * stable.threshold + 2 * abs(stable.radius - 1):
            return False
        self.power = power
        return True

    def _between(self, stable: Point, unstable: Point) -> float:
        """Find the limit by bisection on a logarithmic scale, s."""
        while unstable.step > (1 + PRECISION) * stable.step:
            middle = self.examined.at_step(math.sqrt(stable.step * unstable.step))
            if middle is None or not middle.stable:
                unstable = middle or replace(unstable, step=math.sqrt(stable.step * unstable.step))
            else:
                stable = middle
        return stable.step


def _power(unstable: Point, beyond: Point | None) -> float | None:
    """Exponent of h with which a small excess over 1 grows to the next step; None if no power of h fits."""
    if beyond is None or not (1 < unstable.radius < 1 + SMALL and 1 < beyond.radius):
        return None
    power = math.log((beyond.radius - 1) / (unstable.radius - 1)) / math.log(beyond.step / unstable.step)
    return power if 1 <= power <= MOST_POWER else None


def radius_of(coupled: Coupled, algorithm: Algorithm, h: float, gains: np.ndarray | None = None) -> float:
    """Spectral radius of a coupled system per step; infinite where corrected inputs have no solution.

    Parameters
    ----------
    coupled
        Linear coupled system at the step.
    algorithm
        Co-simulation algorithm.
    h
        Communication step, s.
    gains
        Factors of the connections, shape (n_links,). Default: all 1.
    """
    try:
        return coupled.radius(algorithm, h, gains)
    except np.linalg.LinAlgError:
        return math.inf
