"""Draws the commanded torques of both algorithms at each joint, whole and in contact, with Fig. 6's limits."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orchestration.paper.figures.over_time import Curve, time_axis
from orchestration.paper.figures.run import Run
from orchestration.paper.figures.style import BLACK, ORANGE, SKY, legend_above, new_figure
from orchestration.paper.figures.windows import windows_of
from orchestration.paper.numbers import TORQUE_SHARE, TRUE_M2

LIMIT = f"{100 * TORQUE_SHARE:g} % limit of Fig. 6"


def torque_figure(one: Run, two: Run, saturated: Run | None) -> Figure:
    """A row of panels for each joint: the whole run, and the contact.

    Parameters
    ----------
    one, two
        Runs of algorithms 1 and 2.
    saturated
        Run of algorithm 1 with limits; without it no limits are drawn.
    """
    figure, axes = new_figure(2, 2, "Commanded torques of algorithm 1 (Fig. 5) and algorithm 2 (Fig. 7)")
    contact = windows_of([one, two], TRUE_M2).contact
    for joint, row in enumerate(axes):
        curves = [
            Curve(one.ticks, one.command[:, joint], f"algorithm 1: {_largest(one, joint)}", SKY, 0.8),
            Curve(two.ticks, two.command[:, joint], f"algorithm 2: {_largest(two, joint)}", ORANGE, 0.8),
        ]
        for axis, span, where in zip(row, (None, contact), ("", ", in contact"), strict=True):
            for curve in curves:
                curve.draw(axis, span)
            draw_limit(axis, saturated, joint)
            title = f"({'abcd'[2 * joint + (span is not None)]}) Joint {joint + 1}{where}"
            time_axis(axis, one, title, "torque (N m)")
        row[1].set_xlim(*contact)
        row[1].set_ylim(*row[0].get_ylim())
        legend_above(row[0], [curve.label for curve in curves])
        legend_above(row[1], [LIMIT, "touching"])
    return figure


def _largest(run: Run, joint: int) -> str:
    return f"$\\leq$ {np.abs(run.command[:, joint]).max():.0f} N m"


def draw_limit(axis: Axes, saturated: Run | None, joint: int) -> None:
    """Draw the limit of a joint, if the run shows one: the torque at which the actuator cut the command."""
    if saturated is None:
        return
    cut = saturated.saturated[:, joint]
    if not cut.any():
        return
    limit = float(np.abs(saturated.torque[cut, joint]).max())
    axis.axhline(limit, color=BLACK, ls=":", lw=1.2, label=LIMIT)
    axis.axhline(-limit, color=BLACK, ls=":", lw=1.2)
