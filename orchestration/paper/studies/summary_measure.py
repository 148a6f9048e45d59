"""The summary of a run as a measure of studies, and summaries back from the rows of a table."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from orchestration.campaigns.measuring.measure import Measure
from orchestration.paper.laboratory import Job, Runner
from orchestration.paper.measure import ESTIMATE, RECORDED, Summary, summarize
from orchestration.results.result import Result

FORCE = ("plant.F_ext[1]", "plant.F_ext[2]")
TORQUES = ("torque_1", "torque_2")
UNITS: Mapping[str, str] = {
    "m2_settled": "s",
    "m2_at_contact": "kg",
    "m2_in_contact": "kg",
    "m2_fluctuation": "kg",
    "m2_recovery": "s",
    "e_start": "m",
    "e_free": "m",
    "e_contact": "m",
    "e_contact_rms": "m",
    "e_max": "m",
    "force_error": "N",
    "end": "m",
    **dict.fromkeys(TORQUES, "N.m"),
}
"""Unit of each number of a `Summary`; its torques have a column for each joint."""


def summary_measure(ideal_force: np.ndarray | None = None) -> Measure:
    """The numbers of a `Summary` as a measure.

    Parameters
    ----------
    ideal_force
        F_ext of the ideal run at the same communication points, N, shape (n_rows, 2); without it, ``force_error`` is
        left out.
    """
    names = tuple(name for name in UNITS if ideal_force is not None or name != "force_error")

    def numbers(result: Result) -> dict[str, float]:
        found = summarize(result, ideal_force)
        torques = dict(zip(TORQUES, found.torque.tolist(), strict=True))
        return {name: torques[name] if name in torques else float(getattr(found, name)) for name in names}

    return Measure.of(numbers, names, [UNITS[name] for name in names], [*RECORDED, ESTIMATE])


def summary_of(row: Mapping[str, Any], prefix: str = "") -> Summary:
    """The summary of a run from the row of a table, whose columns may have a prefix such as ``fig5.``."""
    plain = {name: float(row[f"{prefix}{name}"]) for name in UNITS if name not in (*TORQUES, "force_error")}
    torque = np.array([float(row[f"{prefix}{name}"]) for name in TORQUES])
    return Summary(**plain, torque=torque, force_error=float(row.get(f"{prefix}force_error", np.nan)))


def ideal_force(laboratory: Runner) -> np.ndarray:
    """F_ext of the ideal run, N, shape (n_rows, 2)."""
    return laboratory.run(Job("ideal"), FORCE)["plant.F_ext"]
