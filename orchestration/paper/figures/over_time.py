"""Panels over time: curves over the whole run, shading while the tip touches the wall, and a view of the contact."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import blended_transform_factory

from orchestration.paper.figures.run import Run, Span
from orchestration.paper.figures.style import SHADE, envelope
from orchestration.paper.figures.windows import INSET_EDGE, INSET_HEIGHT, INSET_TEXT, INSET_X


@dataclass(frozen=True)
class Curve:
    """A curve over time.

    Attributes
    ----------
    t, y
        Times, s, and values, shape (n,).
    """

    t: np.ndarray
    y: np.ndarray
    label: str
    colour: str
    width: float = 1.3
    dashed: bool = False

    def draw(self, axis: Axes, span: Span | None = None) -> None:
        """Draw the curve, thinned to what is seen in a span of time."""
        t, y = self.t, self.y
        if span is not None:
            kept = slice(*np.searchsorted(t, span, side="left"))
            t, y = t[kept], y[kept]
        style = "--" if self.dashed else "-"
        axis.plot(*envelope(t, y), style, color=self.colour, lw=self.width, label=self.label)


def time_axis(axis: Axes, run: Run, title: str, ylabel: str) -> None:
    """Label a panel over the whole time of a run, and shade it while the tip touches the wall."""
    shade(axis, run)
    axis.set_title(title)
    axis.set_xlabel("t (s)", labelpad=1)
    axis.set_ylabel(ylabel, labelpad=2)
    axis.set_xlim(run.result.time[0], run.result.time[-1])
    axis.xaxis.set_major_locator(MaxNLocator(4))


def shade(axis: Axes, run: Run) -> None:
    """Shade the time in which the tip touches the wall, every contact for itself."""
    transform = blended_transform_factory(axis.transData, axis.transAxes)
    widths = run.phases[:, 1] - run.phases[:, 0]
    bars = list(zip(run.phases[:, 0], widths, strict=True))
    axis.broken_barh(bars, (0, 1), transform=transform, facecolor=SHADE, lw=0, zorder=0, label="touching")


def zoom(axis: Axes, run: Run, curves: Sequence[Curve], contact: Span, near: Span, *, at_top: bool) -> Axes:
    """An inset that shows curves near the contact.

    Parameters
    ----------
    contact, near
        Times, s, and values that the inset shows.
    at_top
        Whether the inset is in the upper half of the panel.
    """
    bottom = 1 - INSET_EDGE - INSET_TEXT - INSET_HEIGHT if at_top else INSET_EDGE + INSET_TEXT
    inset = axis.inset_axes((INSET_X[0], bottom, INSET_X[1] - INSET_X[0], INSET_HEIGHT))
    shade(inset, run)
    for curve in curves:
        curve.draw(inset, contact)
    inset.set_xlim(*contact)
    inset.set_ylim(*near)
    inset.tick_params(labelsize=7.5, pad=2)
    inset.xaxis.set_major_locator(MaxNLocator(3))
    inset.yaxis.set_major_locator(MaxNLocator(4))
    return inset
