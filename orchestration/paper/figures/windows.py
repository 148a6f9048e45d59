"""Windows that several runs share, so that a reader compares their figures."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from orchestration.paper.figures.run import Run, Span

MARGIN = 0.06  # of a range, left free at both of its ends
INSET_X, INSET_HEIGHT = (0.63, 0.975), 0.42  # where an inset is, as shares of the panel
INSET_EDGE, INSET_TEXT = 0.03, 0.075  # room beyond an inset, and for its title or its tick labels
MAGNIFIED = 0.5  # of the whole range: curves near the contact that fill more of it need no inset


@dataclass(frozen=True)
class Range:
    """What a panel over time and its inset show.

    Attributes
    ----------
    whole
        Values that the panel shows.
    near
        Values that the inset shows; None if curves near the contact fill the panel.
    inset_at_top
        Whether an inset is in the upper half of the panel.
    """

    whole: Span
    near: Span | None
    inset_at_top: bool

    def near_of(self, run_near: Span) -> Span | None:
        """What the inset of one run shows: the common range, or else its own if that is small; None for no inset."""
        return self.near or (run_near if _magnified(run_near, self.whole) else None)


@dataclass(frozen=True)
class Windows:
    """What the panels of a group of runs show.

    Attributes
    ----------
    contact
        Times of the contact with a margin, s.
    near_x, near_y
        The surroundings of the wall between a and b, m.
    error, torque, mass
        Tracking errors, mm, torques, N.m, and estimates of m2, kg.
    force
        Norms of forces, N.
    sliding
        The largest force that an inset shows: those of the sliding are far below the impact, N.
    """

    contact: Span
    near_x: Span
    near_y: Span
    error: Range
    torque: Range
    mass: Range
    force: Span
    sliding: float


def windows_of(runs: Sequence[Run], true_mass: float) -> Windows:
    """The windows that hold the curves of some runs.

    Parameters
    ----------
    true_mass
        The true m2, kg, whose band of 20 % is shown whole.
    """
    first, last = min(run.span[0] for run in runs), max(run.span[1] for run in runs)
    edge = 0.12 * (last - first)
    contact = first - edge, last + 2 * edge
    band = 0.8 * true_mass, 1.2 * true_mass
    sliding = max(max(float(run.force[run.sliding].max(initial=0.0)), 1.4 * run.steady_force) for run in runs)
    return Windows(
        contact=contact,
        **_near_the_wall(runs),
        error=_range(runs, contact, lambda run: run.e),
        torque=_range(runs, contact, lambda run: run.torque),
        mass=_range(runs, contact, lambda run: run.estimate, band),
        force=(0.0, _largest_force(runs)),
        sliding=1.25 * sliding,
    )


def within(run: Run, values: np.ndarray, span: Span) -> np.ndarray:
    """Those values at the ticks that lie in a span of time."""
    return values[(run.ticks >= span[0]) & (run.ticks <= span[1])]


def with_margin(low: float, high: float) -> Span:
    """A range with some room at both ends."""
    edge = MARGIN * (high - low) or 1.0
    return low - edge, high + edge


def _near_the_wall(runs: Sequence[Run]) -> dict[str, Span]:
    """The straight segment and the bounce off the wall."""
    wall, depth = runs[0].wall_offset, runs[0].depth
    top = runs[0].a_and_b[0][1]
    touched = [run.x[(run.result.time >= run.span[0]) & (run.result.time <= run.span[1]), 0] for run in runs]
    left = min(-wall - depth, *(float(x.min()) for x in touched))
    right = max(-wall + depth, *(float(x.max()) for x in touched))
    return {"near_x": (left - 0.4 * depth, right + 0.6 * depth), "near_y": (-1.5 * top, 1.5 * top)}


def near_contact(run: Run, values: np.ndarray, contact: Span) -> Span:
    """The range of values at the ticks near the contact, with a margin."""
    return with_margin(*_ends([within(run, values, contact)], None))


def _range(runs: Sequence[Run], contact: Span, curve: Callable[[Run], np.ndarray], shown: Span | None = None) -> Range:
    whole = with_margin(*_ends([curve(run) for run in runs], shown))
    near = with_margin(*_ends([within(run, curve(run), contact) for run in runs], shown))
    common = near if _magnified(near, whole) else None
    zoomed = [run for run in runs if common or _magnified(near_contact(run, curve(run), contact), whole)]
    if not zoomed:
        return Range(whole, None, inset_at_top=True)
    beside = _ends([within(run, curve(run), _inset_times(run)) for run in zoomed], shown if common else None)
    return Range(*_with_room(whole, common, beside))


def _magnified(near: Span, whole: Span) -> bool:
    return near[1] - near[0] < MAGNIFIED * (whole[1] - whole[0])


def _largest_force(runs: Sequence[Run]) -> float:
    """The upper end of the panel of forces, which leaves room for the inset at the top, N."""
    largest = max(float(max(run.force.max(), run.measured.max())) for run in runs)
    beside = max(float(within(run, run.measured, _inset_times(run)).max()) for run in runs)
    return max(1.08 * largest, beside / (1 - _inset_share()))


def _inset_times(run: Run) -> Span:
    """The times, s, that lie above or below the inset of a panel over the whole time of a run."""
    begin, end = float(run.result.time[0]), float(run.result.time[-1])
    return begin + (INSET_X[0] - INSET_TEXT) * (end - begin), end


def _inset_share() -> float:
    return INSET_HEIGHT + 2 * INSET_TEXT + INSET_EDGE


def _with_room(whole: Span, near: Span | None, beside: Span) -> tuple[Span, Span | None, bool]:
    """Grow a range at the end where less is needed, until an inset covers nothing of what is beside it."""
    low, high = whole
    left = 1 - _inset_share()
    raised = max(high, low + (beside[1] - low) / left)
    lowered = min(low, high - (high - beside[0]) / left)
    at_top = raised - high <= low - lowered
    return ((low, raised) if at_top else (lowered, high)), near, at_top


def _ends(curves: Sequence[np.ndarray], shown: Span | None) -> Span:
    values = [*curves, np.array(shown)] if shown else curves
    return min(float(v.min()) for v in values), max(float(v.max()) for v in values)
