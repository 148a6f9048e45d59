"""Two runs side by side: a verdict, the columns that differ, and what the second run has more than the first."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from orchestration.errors import OrchestrationError
from orchestration.report.markup import table
from orchestration.report.page import Section
from orchestration.report.panels import PANEL_HEIGHT, Panel, norms_of, with_norms
from orchestration.report.stored_run import store
from orchestration.report.tables import paragraph
from orchestration.results.comparison import Comparison, common_rows, compare, verdict_of
from orchestration.results.result import Result

MOST_SHOWN = 12  # columns of the table
HEAD = ("column", "unit", "largest", "at t (s)", "of range", "first at t (s)", "first row")


def differences(
    results: Mapping[str, Result], panels: Sequence[Panel], budget: int
) -> tuple[Section, dict[str, Any] | None]:
    """The section that compares two runs, and the difference of the shown columns as data of the page.

    Parameters
    ----------
    results
        Two results by their labels.
    panels
        What the page shows; the difference is shown in the same panels.
    budget
        Bytes of the packed differences.

    Returns
    -------
    tuple
        The section, and ``difference`` of the block ``runs``; None if no communication point or no column is common.
    """
    (one, first), (other, second) = results.items()
    try:
        found = compare(first, second)
    except OrchestrationError as error:
        return Section("differences", "Differences", paragraph(str(error))), None
    parts = [paragraph(verdict_of(found, (len(first.time), len(second.time)))), _table(found, first)]
    shown = [name for panel in panels for curve in panel.curves for name in curve.columns]
    both = [name for name in dict.fromkeys(shown) if name in first.names and name in second.names]
    data = None
    if both:
        parts.append(paragraph(f"The plots show {other} minus {one}, at the rows that both have."))
        height = PANEL_HEIGHT * -(-len(panels) // 2)
        parts.append(Markup('<div id="difference-panels" style="min-height: {}rem"></div>').format(height))
        gaps = with_norms(_difference(first, second, both), norms_of(panels))
        run = store(f"{other} - {one}", gaps, budget)
        data = {"run": run.record(), "panels": [_difference_panel(panel) for panel in panels]}
    return Section("differences", "Differences", Markup().join(parts)), data


def _table(found: Comparison, first: Result) -> Markup:
    differing = [d for d in found.differences if d.first is not None]
    rows = [
        (d.name, d.unit, d.largest, d.at, d.relative, d.first, str(first.time.searchsorted(d.first)))
        for d in differing[:MOST_SHOWN]
        if d.first is not None
    ]
    rest = f"{len(differing) - MOST_SHOWN} more columns differ; adaptimp compare --json lists them."
    return table(HEAD, rows) + (paragraph(rest) if len(differing) > MOST_SHOWN else Markup()) if rows else Markup()


def _difference(first: Result, second: Result, names: Sequence[str]) -> Result:
    """The second result minus the first, at the rows that both have."""
    rows, others = common_rows(first.time, second.time)
    gaps = np.column_stack([second[name][others] - first[name][rows] for name in names])
    whole = len(rows) == len(first.time) == len(second.time)
    units = {name: first.unit(name) for name in names}
    held = first.sample_times if whole else {}
    return Result(first.time[rows], tuple(names), gaps, units=units, sample_times=held)


def _difference_panel(panel: Panel) -> dict[str, Any]:
    return {**panel.record(), "title": f"Difference: {panel.title}"}
