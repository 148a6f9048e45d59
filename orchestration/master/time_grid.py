"""The communication points of a run, and how the sampling periods of components fit the points."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.master.memory import require_memory
from orchestration.system.sampling import RATIO_TOLERANCE
from orchestration.system.system import System


@dataclass(frozen=True)
class Grid:
    """Points of time at which steps must end.

    Attributes
    ----------
    times
        The points, s, shape (n + 1,), increasing.
    lengths
        Lengths of the intervals between the points, s, shape (n,), or (1,) if all are equal.
    step
        Communication step, s: the length of the first interval, or the step that a controlled run was
        asked for.
    steps_per_tick
        Number of intervals in one sampling period, by component name. Empty if these numbers are not
        whole.
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
        """Return the index of the point at the time `until`, s, which must not lie before `now`, s.

        Raises
        ------
        SystemDescriptionError
            If there is not a point at that time. The message names the nearest point.
        """
        k = int(np.argmin(np.abs(self.times - until)))
        if abs(self.times[k] - until) > RATIO_TOLERANCE * max(1.0, abs(until)) or self.times[k] < now:
            points = self.times[self.times >= now]
            near = points[np.argmin(np.abs(points - until))]
            msg = f"t = {until:.9g} s is not a communication point ahead of {now:.9g} s; {near:.9g} s is one."
            raise SystemDescriptionError(msg)
        return k


def fixed_grid(system: System, span: tuple[float, float], step: float, *, stale: bool) -> Grid:
    """Return the communication points of a run with fixed steps: t0 + k step.

    Parameters
    ----------
    system
        System whose sampling periods must fit.
    span
        Start and stop time, s.
    step
        Communication step, s.
    stale
        Whether sampling periods need not be multiples of the step.

    Raises
    ------
    SystemDescriptionError
        If the step is not positive, or if the duration or a sampling period is not a multiple of the step.
    """
    _require_positive(step)
    lengths = np.array([step], dtype=float)
    ratios = _ratios(system, lengths, stale=stale)
    return Grid(_points(system.name, span, step), lengths, float(step), ratios)


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
    """Return the points at which controlled steps must end: the ticks of all components, and the stop time.

    Parameters
    ----------
    system
        System whose sampled components tick.
    span
        Start and stop time, s.
    step
        Step of which every sampling period must be a multiple, s.

    Raises
    ------
    SystemDescriptionError
        If the step or the length of the run is not positive, or a sampling period is not a
        multiple of the step.
    """
    _require_positive(step)
    start, stop = span
    if not (math.isfinite(stop) and stop > start):
        msg = f"The run from {start:g} s to {stop:g} s does not have a positive, finite length."
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
    """Refuse a step that is not positive and finite."""
    if not (np.isfinite(step) and step > 0):
        msg = f"The step {step!r} s is not positive."
        raise SystemDescriptionError(msg)


def _points(name: str, span: tuple[float, float], step: float) -> np.ndarray:
    """Communication points t0 + k step, s, shape (n + 1,)."""
    t0, stop_time = span
    if not (math.isfinite(stop_time) and stop_time > t0):
        msg = f"The run from {t0:g} s to {stop_time:g} s does not have a positive, finite length."
        raise SystemDescriptionError(msg)
    count = (stop_time - t0) / step
    n = round(count) if math.isfinite(count) else -1
    if n < 1 or abs(count - n) > RATIO_TOLERANCE * n:
        whole = t0 + max(1, n) * step
        msg = (
            f"The run from {t0:g} s to {stop_time:g} s is not a multiple of the step {step:g} s;"
            f" stop at {whole:.9g} s instead."
        )
        raise SystemDescriptionError(msg)
    require_memory(name, n, n, 0)  # the points are made of two arrays
    return t0 + np.arange(n + 1) * step


def _ratios(system: System, steps: np.ndarray, *, stale: bool) -> Mapping[str, int]:
    """Return the steps per tick of each sampled component; empty if inputs may be stale and a ratio is not whole."""
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
