"""Communication points of a run, and how sampling periods fit them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.system.system import RATIO_TOLERANCE, System


@dataclass(frozen=True)
class Grid:
    """Points on which steps must end.

    Attributes
    ----------
    times
        s, shape (n + 1,).
    lengths
        Of the intervals between them, s, shape (n,), or (1,) if all are equal.
    steps_per_tick
        Intervals per sampling period, by component; empty where they are not whole.
    step
        The communication step, s: the length of the intervals, unless steps are controlled.
    """

    times: np.ndarray
    lengths: np.ndarray
    step: float
    steps_per_tick: Mapping[str, int] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of intervals."""
        return self.times.size - 1

    def ahead(self, until: float, now: float) -> int:
        """The index of the point at the time `until`, s, not before `now`.

        Raises
        ------
        SystemDescriptionError
            If there is none; naming the nearest that there is.
        """
        k = int(np.argmin(np.abs(self.times - until)))
        if abs(self.times[k] - until) > RATIO_TOLERANCE * max(1.0, abs(until)) or self.times[k] < now:
            points = self.times[self.times >= now]
            near = points[np.argmin(np.abs(points - until))]
            msg = f"t = {until:.9g} s is no communication point ahead of {now:.9g} s; {near:.9g} s is one."
            raise SystemDescriptionError(msg)
        return k


def fixed_grid(system: System, span: tuple[float, float], step: float, *, stale: bool) -> Grid:
    """The points t0 + k step.

    Parameters
    ----------
    span
        Start and stop time, s.
    stale
        Whether sampling periods need not be multiples of the step.

    Raises
    ------
    SystemDescriptionError
        If the run is no multiple of the step, or a sampling period is not.
    """
    _require_positive(step)
    lengths = np.array([step], dtype=float)
    ratios = _ratios(system, lengths, stale=stale)
    return Grid(_points(span, step), lengths, float(step), ratios)


def given_grid(system: System, times: np.ndarray, *, stale: bool) -> Grid:
    """Points that the caller chose, s, shape (n + 1,); `stale` as of `fixed_grid`.

    Raises
    ------
    SystemDescriptionError
        If there are fewer than two points, they do not increase, or the steps do not fit a sampling period.
    """
    points = np.array(times, dtype=float)
    shaped = points.ndim == 1 and points.size > 1
    if not (shaped and np.isfinite(points).all() and (np.diff(points) > 0).all()):
        msg = "The communication points must be at least two finite, increasing times."
        raise SystemDescriptionError(msg)
    lengths = np.diff(points)
    return Grid(points, lengths, float(lengths[0]), _ratios(system, lengths, stale=stale))


def tick_grid(system: System, span: tuple[float, float], step: float) -> Grid:
    """The points that contain every tick, for steps that are controlled: no more than these.

    Raises
    ------
    SystemDescriptionError
        If a sampling period is no multiple of the step.
    """
    _require_positive(step)
    start, stop = span
    if not (math.isfinite(stop) and stop > start):
        msg = f"The run from {start:g} s to {stop:g} s has no length."
        raise SystemDescriptionError(msg)
    ratios = system.steps_per_tick(step)
    if not ratios:
        return Grid(np.array([start, stop]), np.array([stop - start]), step)
    interval = math.gcd(*ratios.values()) * step
    whole = math.floor((stop - start) / interval * (1 + RATIO_TOLERANCE))
    points = start + np.arange(whole + 1) * interval
    if stop - points[-1] > RATIO_TOLERANCE * interval:
        points = np.append(points, stop)
    return Grid(points, np.diff(points), step)


def _require_positive(step: float) -> None:
    if not (np.isfinite(step) and step > 0):
        msg = f"The step {step!r} s is not positive."
        raise SystemDescriptionError(msg)


def _points(span: tuple[float, float], step: float) -> np.ndarray:
    """Communication points t0 + k step, s, shape (n + 1,)."""
    t0, stop_time = span
    count = (stop_time - t0) / step
    n = round(count) if np.isfinite(count) else -1
    if n < 1 or abs(count - n) > RATIO_TOLERANCE * n:
        whole = t0 + max(1, n) * step
        msg = (
            f"The run from {t0:g} s to {stop_time:g} s is no multiple of the step {step:g} s;"
            f" stop at {whole:.9g} s instead."
        )
        raise SystemDescriptionError(msg)
    return t0 + np.arange(n + 1) * step


def _ratios(system: System, steps: np.ndarray, *, stale: bool) -> Mapping[str, int]:
    """Steps per tick of the sampled components; empty where they are not whole."""
    if stale:
        try:
            return system.steps_per_tick(float(steps[0]))
        except SystemDescriptionError:
            return {}
    shortest, longest = float(steps.min()), float(steps.max())
    ratios = system.steps_per_tick(shortest)
    if longest - shortest > RATIO_TOLERANCE * longest and system.steps_per_tick(longest) != ratios:
        msg = f"Steps from {shortest:g} s to {longest:g} s do not fit the sample times."
        raise SystemDescriptionError(msg)
    return ratios
