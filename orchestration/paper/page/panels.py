"""The panels of the paper for a page: torques or the estimate, the tracking error, and the contact force.

The path of the tip, the paper's panel (a), is the drawing of the arm.
"""

from collections.abc import Sequence

import numpy as np

from orchestration.paper.figures.overlay import ERROR, FORCE, MEASURED, SMALLEST_SPAN, TORQUES, missing_columns
from orchestration.paper.task_shape import PLANAR, shape_of
from orchestration.report.panels import Curve, Panel
from orchestration.results.result import Result

MM_PER_M = 1e3


def paper_panels(results: Sequence[Result]) -> list[Panel]:
    """The panels of runs of the paper's loop; none if a run lacks their columns, or the tasks of the runs differ."""
    shapes = {shape_of(result) for result in results}
    if len(shapes) != 1 or any(missing_columns(result) for result in results):
        return []
    (shape,) = shapes
    panels = []
    if any(shape.estimate in result and np.ptp(result[shape.estimate]) > SMALLEST_SPAN for result in results):
        what = ("link 2", "m2") if shape.size == PLANAR else ("the payload", "the payload's mass")
        panels.append(Panel(f"Estimated mass of {what[0]}", "kg", [Curve([shape.estimate], f"estimate of {what[1]}")]))
    torque = next((name for name in TORQUES if all(name in result for result in results)), None)
    if torque is not None:
        title = "Torques of the actuators" if torque == TORQUES[0] else "Commanded torques"
        joints = range(1, shape.joints + 1)
        panels.append(Panel(title, "N.m", [Curve([f"{torque}[{i}]"], f"joint {i}") for i in joints]))
    errors = [Curve([f"{ERROR}[{i}]"], f"e{i}") for i in range(1, shape.size + 1)]
    of_position, of_angle = errors[: shape.positions], errors[shape.positions :]
    panels.append(Panel("Tracking error e = x - x_t", "mm", of_position, MM_PER_M))
    if of_angle:
        panels.append(Panel("Tracking error of the angles", "mrad", of_angle, MM_PER_M))
    forces = [Curve(_elements(FORCE, shape.positions), "on the wall")]
    if all(MEASURED in result for result in results):
        forces.append(Curve(_elements(MEASURED, shape.positions), "measured", hidden=len(results) > 1))
    panels.append(Panel("Contact force, norm", "N", forces))
    return panels


def _elements(name: str, positions: int) -> list[str]:
    return [f"{name}[{i}]" for i in range(1, positions + 1)]
