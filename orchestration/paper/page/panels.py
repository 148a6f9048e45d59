"""The panels of the paper for a page: torques or the estimate, the tracking error, and the contact force.

The path of the tip, the paper's panel (a), is the drawing of the arm.
"""

from collections.abc import Sequence

import numpy as np

from orchestration.paper.figures.overlay import ERROR, FORCE, MEASURED, SMALLEST_SPAN, TORQUES, missing_columns
from orchestration.paper.measure import ESTIMATE
from orchestration.report.panels import Curve, Panel
from orchestration.results.result import Result

MM_PER_M = 1e3


def paper_panels(results: Sequence[Result]) -> list[Panel]:
    """The panels of runs of the paper's loop; none if a run lacks their columns."""
    if any(missing_columns(result) for result in results):
        return []
    panels = []
    if any(ESTIMATE in result and np.ptp(result[ESTIMATE]) > SMALLEST_SPAN for result in results):
        panels.append(Panel("Estimated mass of link 2", "kg", [Curve([ESTIMATE], "estimate of m2")]))
    torque = next((name for name in TORQUES if all(name in result for result in results)), None)
    if torque is not None:
        title = "Torques of the actuators" if torque == TORQUES[0] else "Commanded torques"
        panels.append(Panel(title, "N.m", [Curve([f"{torque}[{i}]"], f"joint {i}") for i in (1, 2)]))
    errors = [Curve([f"{ERROR}[{i}]"], f"e{i}") for i in (1, 2)]
    panels.append(Panel("Tracking error e = x - x_t", "mm", errors, MM_PER_M))
    forces = [Curve(_elements(FORCE), "on the wall")]
    if all(MEASURED in result for result in results):
        forces.append(Curve(_elements(MEASURED), "measured", hidden=len(results) > 1))
    panels.append(Panel("Contact force, norm", "N", forces))
    return panels


def _elements(name: str) -> list[str]:
    return [f"{name}[{i}]" for i in (1, 2)]
