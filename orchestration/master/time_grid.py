"""The communication points of a run, and how the sampling periods of components fit the points."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.given import a_number, positive, shown
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

    @property
    def unequal(self) -> bool:
        """Whether the intervals differ in length by more than rounding."""
        return bool(np.ptp(self.lengths) > RATIO_TOLERANCE * self.step)

    def rows_per_tick(self, every: int) -> dict[str, int]:
        """Return the rows per sampling period, of components for which they are whole; every n-th step is recorded."""
        return {name: n // every for name, n in self.steps_per_tick.items() if n % every == 0}

    def progress(self, interval: int, time: float, *, controlled: bool) -> tuple[int, int]:
        """Return how far a run is, as steps made and all steps; as thousandths of its duration if it is controlled."""
        if not controlled:
            return interval, self.n
        return int(1000 * (time - self.times[0]) / (self.times[-1] - self.times[0])), 1000

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
    _require_span(span, step)
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
    points = _given_points(times)
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
    _require_span(span, step)
    start, stop = span
    ratios = system.steps_per_tick(step)
    if not ratios:
        return Grid(np.array([start, stop]), np.array([stop - start]), step)
    interval = math.gcd(*ratios.values()) * step
    whole = math.floor((stop - start) / interval * (1 + RATIO_TOLERANCE))
    require_memory(system.name, whole, whole, 0)  # the points and the lengths
    points = start + np.arange(whole + 1) * interval
    if stop - points[-1] > RATIO_TOLERANCE * interval:
        points = np.append(points, stop)
    return Grid(points, np.diff(points), step)


def with_points(grid: Grid, times: Collection[float] | np.ndarray) -> Grid:
    """Return a grid with further points, s, at which steps must end; what lies outside or is a point is left out.

    The ticks keep their times, to the bit. A point within 1e-9 of another one, relative to the larger of 1 s and the
    time, is the same.
    """
    wanted = np.unique(np.asarray(times, float))
    slack = RATIO_TOLERANCE * np.maximum(1.0, np.abs(wanted))
    after = np.searchsorted(grid.times, wanted)
    inside = (after > 0) & (after <= grid.n)
    wanted, slack, after = wanted[inside], slack[inside], after[inside]
    apart = (grid.times[after] - wanted > slack) & (wanted - grid.times[after - 1] > slack)
    wanted, slack = wanted[apart], slack[apart]
    wanted = wanted[np.diff(wanted, prepend=-np.inf) > slack]
    if not wanted.size:
        return grid
    points = np.sort(np.concatenate([grid.times, wanted]))
    return Grid(points, np.diff(points), grid.step, grid.steps_per_tick)


def _given_points(times: np.ndarray) -> np.ndarray:
    """Communication points as an array, s, shape (n + 1,); refuses what does not increase."""
    what = "The communication points"
    try:
        points = np.array(times, dtype=float)
    except (TypeError, ValueError) as error:
        msg = f"{what} are {shown(times)}; give increasing numbers, in s."
        raise SystemDescriptionError(msg) from error
    if points.ndim != 1 or points.size < 2:
        msg = f"{what} have the shape {points.shape}; give at least two increasing times, in s, shape (n + 1,)."
        raise SystemDescriptionError(msg)
    if not np.isfinite(points).all():
        k = int(np.argmin(np.isfinite(points)))
        msg = f"{what} have {float(points[k])!r} at index {k}; give finite, increasing times, in s."
        raise SystemDescriptionError(msg)
    if not (np.diff(points) > 0).all():
        k = int(np.argmin(np.diff(points) > 0))
        msg = f"{what} go from {points[k]:.9g} s to {points[k + 1]:.9g} s at index {k}; give increasing times."
        raise SystemDescriptionError(msg)
    return points


def _require_span(span: tuple[float, float], step: float) -> None:
    """Refuse a run without length, and a step that is not positive or too short to advance the time."""
    start, stop = a_number("The start time", span[0]), a_number("The stop time", span[1])
    positive("The step", step)
    if not stop > start:
        msg = f"The stop time {stop:g} s is not after the start time {start:g} s; give a later stop time."
        raise SystemDescriptionError(msg)
    apart = math.ulp(max(abs(start), abs(stop)))
    if step <= apart:
        msg = (
            f"The step {step:g} s does not advance the time between the start time {start:.9g} s and the stop time"
            f" {stop:.9g} s, where numbers are {apart:.2g} s apart; use a larger step."
        )
        raise SystemDescriptionError(msg)


def _points(name: str, span: tuple[float, float], step: float) -> np.ndarray:
    """Communication points t0 + k step, s, shape (n + 1,)."""
    t0, stop_time = span
    count = (stop_time - t0) / step
    n = round(count) if math.isfinite(count) else -1
    if n < 1 or abs(count - n) > RATIO_TOLERANCE * n:
        whole = t0 + max(1, n) * step
        msg = (
            f"The run from {t0:g} s to {stop_time:g} s is not a multiple of the step {step:g} s;"
            f" stop at {whole:.9g} s instead."
        )
        raise SystemDescriptionError(msg)
    require_memory(name, n, 0, 0)
    points = np.arange(n + 1, dtype=float)  # in one array, for this is the memory that a streamed run needs
    points *= step
    points += t0
    return points


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
