"""Draws Fig. 6 with its difference from Fig. 5: where the actuators saturate, and what that does to the errors."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orchestration.paper.figures.control import four_panels
from orchestration.paper.figures.over_time import Curve, time_axis
from orchestration.paper.figures.run import Run
from orchestration.paper.figures.style import BLACK, BLUE, SKY, VERMILLION, legend_above, new_figure
from orchestration.paper.figures.torques import LIMIT, draw_limit
from orchestration.paper.figures.windows import Windows, within
from orchestration.paper.measure import norms


def saturated_figure(run: Run, unsaturated: Run, windows: Windows, title: str) -> Figure:
    """Panels (a) to (d) with Fig. 5 behind; (e), (f) torques of the joints; (g), (h) errors minus those of Fig. 5."""
    figure, axes = new_figure(4, 2, f"{title}, and what differs from Fig. 5")
    four_panels(axes[:2], run, windows, unsaturated)
    for joint, axis in enumerate(axes[2]):
        _torque(axis, run, joint, windows)
    error = norms(run.e) - _at(run.ticks, unsaturated.ticks, norms(unsaturated.e))
    _difference(axes[3, 0], run, 1e3 * error)
    time_axis(axes[3, 0], run, r"(g) $\|e\|$ of Fig. 6 minus Fig. 5", "difference (µm)")
    force = run.force - _at(run.result.time, unsaturated.result.time, unsaturated.force)
    _difference(axes[3, 1], run, _at(run.ticks, run.result.time, force))
    time_axis(axes[3, 1], run, r"(h) $\|F_{ext}\|$ of Fig. 6 minus Fig. 5", "difference (N)")
    for axis in axes[2:].flat:
        axis.set_xlim(*windows.contact)
    for axis in axes[3]:
        legend_above(axis)
    return figure


def _torque(axis: Axes, run: Run, joint: int, windows: Windows) -> None:
    """The command, and in front of it what the actuator gives."""
    Curve(run.ticks, run.command[:, joint], "command", VERMILLION, 0.9).draw(axis, windows.contact)
    Curve(run.ticks, run.torque[:, joint], "actuator", SKY, 0.9).draw(axis, windows.contact)
    draw_limit(axis, run, joint)
    cut = float(within(run, run.saturated[:, joint], run.span).mean())
    how = f"saturated in {100 * cut:.2g} % of the contact" if cut else "not saturated in contact"
    time_axis(axis, run, f"({'ef'[joint]}) Joint {joint + 1}, {how}", "torque (N m)")
    legend_above(axis, ["command", "actuator", LIMIT])


def _difference(axis: Axes, run: Run, values: np.ndarray) -> None:
    Curve(run.ticks, values, "difference", BLUE, 1.0).draw(axis)
    axis.axhline(0, color=BLACK, lw=0.8)
    times = run.ticks[run.saturated.any(axis=1)]
    marks = {"color": VERMILLION, "ms": 6, "transform": axis.get_xaxis_transform()}
    axis.plot(times, np.full_like(times, 0.025), "|", label="a joint saturates", **marks)


def _at(ticks: np.ndarray, t: np.ndarray, y: np.ndarray) -> np.ndarray:
    return y if np.array_equal(ticks, t) else np.interp(ticks, t, y)
