"""Phases of a run as bands over time: contact, flight between two contacts, saturation; what is left is free motion."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import blended_transform_factory

from orchestration.paper.figures.theme import Theme
from orchestration.paper.measure import norms
from orchestration.results.result import Result

FORCE, SATURATED = "plant.F_ext", "actuator.saturated"
CONTACT, FLIGHT, LIMITED = "in contact", "in flight", "saturated"
SEEN = 0.8  # points: width at which saturation of a single tick is seen
STRIP, STRIPS = 0.03, 0.13  # of the height of a panel: a strip of one run of several, and all strips at most


def intervals(times: np.ndarray, holds: np.ndarray) -> np.ndarray:
    """When a condition holds.

    Parameters
    ----------
    times, holds
        Instants, s, and whether the condition holds there, shape (n,).

    Returns
    -------
    ndarray
        Begin and end of each interval, s, shape (n_intervals, 2): the first and the last instant.
    """
    edges = np.diff(np.concatenate([[False], holds, [False]]).astype(int))
    return np.column_stack([times[np.flatnonzero(edges > 0)], times[np.flatnonzero(edges < 0) - 1]])


def phases(result: Result) -> dict[str, np.ndarray]:
    """Return the intervals of each phase that occurs in a run, s, shape (n_intervals, 2)."""
    contact = intervals(result.time, norms(result[FORCE]) > 0)
    found = {CONTACT: contact, FLIGHT: np.column_stack([contact[:-1, 1], contact[1:, 0]])}
    if SATURATED in result:
        # A row of a sampled component shows the value of the step before it.
        limited = result[SATURATED][1:].any(axis=1)
        begins, ends = result.time[:-1], result.time[1:]
        edges = np.diff(np.concatenate([[False], limited, [False]]).astype(int))
        found[LIMITED] = np.column_stack([begins[np.flatnonzero(edges > 0)], ends[np.flatnonzero(edges < 0) - 1]])
    return {name: spans for name, spans in found.items() if len(spans)}


def height_of_strips(runs: int) -> float:
    """Height of the strips of several runs, of the height of a panel; 0 for a single run."""
    return min(1.2 * STRIP * runs, STRIPS) if runs > 1 else 0.0


def draw_phases(axis: Axes, found: Sequence[Mapping[str, np.ndarray]], theme: Theme) -> None:
    """Draw the bands of one run over the whole height of a panel, those of several runs in a strip for each.

    Saturation is a strip at the upper edge, so that it does not cover the contact. The strips of several runs lie
    above the panel's frame, and each bears the colour of its run at its left end.
    """
    several = len(found) > 1
    pitch = height_of_strips(len(found)) / max(1, len(found))
    for place, run in enumerate(found):
        bottom, height = 1 + pitch * (len(found) - 0.9 - place), 0.8 * pitch
        for name, spans in run.items():
            whole, low = ((bottom, height), bottom + height / 2) if several else ((0, 1), 1 - STRIP)
            extent = (low, whole[0] + whole[1] - low) if name == LIMITED else whole
            _band(axis, name, spans, extent, theme)
        if several:
            marks = {"marker": "s", "ms": 5, "transform": axis.transAxes, "clip_on": False, "ls": "none"}
            axis.plot(-0.012, bottom + height / 2, color=theme.curves[place], **marks)


def _band(axis: Axes, name: str, spans: np.ndarray, extent: tuple[float, float], theme: Theme) -> None:
    colour = {CONTACT: theme.contact, FLIGHT: theme.flight, LIMITED: theme.saturated}[name]
    bars = [(begin, end - begin) for begin, end in spans]
    width = SEEN if name == LIMITED else 0.0
    transform = blended_transform_factory(axis.transData, axis.transAxes)
    bands = axis.broken_barh(bars, extent, transform=transform, color=colour, lw=width, zorder=0, label=name)
    bands.set_clip_on(extent[0] < 1)
