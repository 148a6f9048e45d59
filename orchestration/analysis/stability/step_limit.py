"""The largest step at which an algorithm is stable on a system.

At every step that is examined the units are identified anew, so it is their own solvers that are
judged. Steps sqrt(10) apart are examined, from the given one outwards; bisection finds the limit between the
last two. The radius is uncertain by the noise of the identification: so much do radii of models differ
that the noise, or the drift of a moving unit, allows as well. A double eigenvalue 1, of a free mass,
splits by the square root of the noise; this way of measuring sees it.

Undamped systems coupled explicitly are unstable at every step, with a radius whose excess over 1 falls as a
power of h until the threshold hides it. Such a fading excess is told from a limit by its size at the last
step at which it is seen.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from orchestration.analysis.stability.operating_point import Probe, operating_point
from orchestration.analysis.stability.pulse_response import identify
from orchestration.analysis.stability.step_map import Coupled
from orchestration.errors import SimulationError
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.master.algorithm import Algorithm
from orchestration.system.system import System

FLOOR = 1e-11  # of the threshold: rounding of eigenvalues
SAMPLES, SEED = 6, 1991  # models within the noise, from which the threshold is derived
GRID = math.sqrt(10.0)  # ratio of the steps that are examined
BELOW, ABOVE, NEAR = 6, 4, 3  # so many of them below the given step, above, and below one that is stable
PRECISION = 0.01  # relative, of the largest stable step
SMALL, MOST_POWER = 0.1, 6.0  # excesses over 1 that may be a power of h, and its exponent
MOST_STEPS = 20000  # to reach an operating point, when the step is searched


@dataclass(frozen=True)
class Point:
    """Radius at a step, s, and how wrong it may be."""

    step: float
    radius: float
    threshold: float

    @property
    def stable(self) -> bool:
        """Whether deviations do not grow, as far as can be seen."""
        return self.radius <= 1 + self.threshold

    @property
    def decays(self) -> bool:
        """Whether they surely decay."""
        return self.radius < 1 - self.threshold


@dataclass(frozen=True)
class Examined:
    """The system at its operating point, ready to be examined at other steps."""

    system: System
    step: float
    at: float
    probes: list[Probe]
    algorithm: Algorithm

    def coupled(self, h: float, order: int) -> Coupled:
        """The linear system at a step of h, s; its sample times follow in proportion."""
        with self._probes(h) as (system, probes):
            return Coupled.of(system, [identify(probe, h, order) for probe in probes], h)

    def judged(self, coupled: Coupled, h: float) -> Point:
        """Radius, and threshold by models that noise and drift allow as well."""
        radius, random = radius_of(coupled, self.algorithm, h), np.random.default_rng(SEED)
        off = [
            radius_of(replace(coupled, units=tuple(u.shaken(random) for u in coupled.units)), self.algorithm, h)
            for _ in range(SAMPLES)
        ]
        later = radius_of(replace(coupled, units=tuple(u.later() for u in coupled.units)), self.algorithm, h)
        spread = max(abs(r - radius) for r in off) if math.isfinite(radius) else 0.0
        drift = abs(later - radius) if math.isfinite(radius) else 0.0
        return Point(h, radius, FLOOR + 3 * spread + drift)

    def at_step(self, h: float) -> Point | None:
        """The judgement at another step; None if the system cannot be examined there."""
        if h < self.step and self.at / h > MOST_STEPS and self._periods():
            return None
        try:
            return self.judged(self.coupled(h, self.algorithm.order), h)
        except SimulationError:
            return None

    def _periods(self) -> dict[str, float]:
        return {c.name: c.sample_time for c in self.system.components if c.sample_time is not None}

    @contextmanager
    def _probes(self, h: float) -> Iterator[tuple[System, list[Probe]]]:
        periods = self._periods()
        if h == self.step or not periods:
            yield self.system, self.probes
            return
        scaled = {f"{name}.{SAMPLE_TIME}": period * h / self.step for name, period in periods.items()}
        system = self.system.set(scaled)
        with operating_point(system, h, self.at) as probes:
            yield system, probes


@dataclass
class Search:
    """Search for the largest stable step, from the given one outwards.

    Attributes
    ----------
    power
        Of h, with which an instability at all steps fades; None if there is none.
    gap
        A step below the given one that is unstable, although the given one is stable, s; or None.
    """

    examined: Examined
    here: Point
    power: float | None = None
    gap: float | None = None

    def largest(self) -> float | None:
        """The step, s; None if none is stable, infinite if all are."""
        if not self.here.stable:
            return self._downwards(self.here)
        below = [self._neighbour(self.here, -k) for k in range(1, NEAR + 1)]
        unstable = [point for point in below if point is not None and point.radius > 1 + 10 * point.threshold]
        if unstable:
            self.gap = unstable[0].step
            return self._downwards(unstable[-1])
        return self._upwards()

    def _downwards(self, unstable: Point) -> float | None:
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
        return self.examined.at_step(point.step * GRID**k)

    def _limit(self, stable: Point, unstable: Point, beyond: Point | None) -> float | None:
        """The limit between two neighbours, unless the instability fades."""
        return None if self._fades(stable, unstable, beyond) else self._between(stable, unstable)

    def _fades(self, stable: Point, unstable: Point, beyond: Point | None) -> bool:
        """Whether the excess over 1 is a power of h that sinks below the threshold, and no crossing."""
        if stable.decays:
            return False
        power = _power(unstable, beyond) or 2.0
        expected = (unstable.radius - 1) * (stable.step / unstable.step) ** power
        if expected > 3 * stable.threshold + 2 * abs(stable.radius - 1):
            return False
        self.power = power
        return True

    def _between(self, stable: Point, unstable: Point) -> float:
        """Bisection on a logarithmic scale."""
        while unstable.step > (1 + PRECISION) * stable.step:
            middle = self.examined.at_step(math.sqrt(stable.step * unstable.step))
            if middle is None or not middle.stable:
                unstable = middle or replace(unstable, step=math.sqrt(stable.step * unstable.step))
            else:
                stable = middle
        return stable.step


def _power(unstable: Point, beyond: Point | None) -> float | None:
    """The power of h by which a small excess over 1 grows to the next step; None if it is none."""
    if beyond is None or not (1 < unstable.radius < 1 + SMALL and 1 < beyond.radius):
        return None
    power = math.log((beyond.radius - 1) / (unstable.radius - 1)) / math.log(beyond.step / unstable.step)
    return power if 1 <= power <= MOST_POWER else None


def radius_of(coupled: Coupled, algorithm: Algorithm, h: float, gains: np.ndarray | None = None) -> float:
    """Spectral radius per step; infinite where implicit inputs have no solution."""
    try:
        return coupled.radius(algorithm, h, gains)
    except np.linalg.LinAlgError:
        return math.inf
