"""The page of one run or of two: plots, differences, the system and where the numbers come from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.report.differences import differences
from orchestration.report.markup import render
from orchestration.report.page import Page, Section
from orchestration.report.panels import MOST_CURVES, PANEL_HEIGHT, Panel, norms_of, panels_by_unit, with_norms
from orchestration.report.stored_run import StoredRun, store
from orchestration.report.tables import Told, numbers_section, origin_section, system_section
from orchestration.results.result import Result

BUDGET = 1_200_000
"""Bytes of the packed columns of all runs of a page."""
PACKAGE = "orchestration.report"
TWO = 2


@dataclass(frozen=True)
class Views:
    """What a page shows of runs beyond what it shows of any run.

    Attributes
    ----------
    panels
        Default: those of the first columns, by unit.
    phases
        Of each run: begin and end, s, of the intervals of each phase, shape (n_intervals, 2).
    extra
        Of each run: what modules of sections need besides, for JSON.
    first, last
        Sections before the plots, and after all others.
    needed
        Columns besides those of the panels that are to be stored as finely as possible.
    modules, starts, data, blocks
        As in `orchestration.report.page.Page`.
    told
        What is said of runs, by their labels.
    offered
        Captions of runs by their labels, among which the reader chooses. Without any, all runs are shown.
    at_first
        Label of the offered run that is shown until the reader chooses. Default: the first one.
    """

    panels: Sequence[Panel] = ()
    phases: Sequence[Mapping[str, np.ndarray]] = ()
    extra: Sequence[Mapping[str, Any]] = ()
    first: Sequence[Section] = ()
    last: Sequence[Section] = ()
    needed: Sequence[str] = ()
    modules: Sequence[Path] = ()
    starts: Sequence[str] = ()
    told: Mapping[str, Told] = field(default_factory=dict)
    offered: Mapping[str, str] = field(default_factory=dict)
    at_first: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    blocks: Mapping[str, bytes] = field(default_factory=dict)


def run_page(results: Mapping[str, Result], views: Views, budget: int = BUDGET) -> Page:
    """Make the page of one run or of several.

    Parameters
    ----------
    results
        Results by their labels.
    budget
        Bytes of the packed columns.
    """
    panels = views.panels or panels_by_unit(list(results.values()))
    share = budget // (len(results) + (len(results) == TWO))  # the difference of two runs counts as a run
    runs = _stored(results, views, panels, share)
    data: dict[str, Any] = {"runs": [run.record() for run in runs], "panels": [panel.record() for panel in panels]}
    told = {label: views.told.get(label, Told()) for label in results}
    shown = list(range(len(runs)))
    if views.offered:
        shown = [list(results).index(views.at_first or next(iter(results)))]
    data["shown"] = shown
    sections = [*views.first, _plots(runs, panels, shown, views.offered)]
    if len(results) == TWO and not views.offered:
        section, difference = differences(results, panels, share)
        sections.append(section)
        data["difference"] = difference
    sections += [numbers_section(results, told), system_section(results), *views.last, origin_section(results, told)]
    return Page(
        title=f"{' and '.join(results)}: {'a run' if len(results) == 1 else 'runs'} of a co-simulation",
        lead=" ".join(_lead(label, result) for label, result in results.items()),
        sections=sections,
        data={"runs": data, **views.data},
        blocks=views.blocks,
        modules=views.modules,
        starts=views.starts,
    )


def _lead(label: str, result: Result) -> str:
    """One sentence on a run."""
    span = f", t = {result.time[0]:g} to {result.time[-1]:g} s" if len(result.time) else ""
    return f"{label}: {len(result.time)} rows{span}, {len(result)} columns."


def _stored(results: Mapping[str, Result], views: Views, panels: Sequence[Panel], budget: int) -> list[StoredRun]:
    shown = [name for panel in panels for curve in panel.curves for name in curve.columns]
    norms = norms_of(panels)
    first = list(dict.fromkeys([*shown, *norms, *views.needed]))
    return [
        store(label, with_norms(result, norms), budget, first, **_views_of(views, place))
        for place, (label, result) in enumerate(results.items())
    ]


def _views_of(views: Views, place: int) -> dict[str, Any]:
    phases = views.phases[place] if views.phases else {}
    return {
        "phases": {name: spans.tolist() for name, spans in phases.items()},
        "extra": views.extra[place] if views.extra else {},
    }


def _plots(
    runs: Sequence[StoredRun], panels: Sequence[Panel], shown: Sequence[int], offered: Mapping[str, str]
) -> Section:
    names = list(dict.fromkeys(name for run in runs for name in run.columns))
    html = render(
        PACKAGE,
        "plots.html.j2",
        offered=offered,
        shown=[runs[place].label for place in shown],
        phases=list(dict.fromkeys(name for run in runs for name in run.phases)),
        several=len(runs) > 1,
        height=PANEL_HEIGHT * -(-len(panels) // 2),
        names=names,
        most=MOST_CURVES,
        notes=[run.note() for run in runs],
    )
    return Section("plots", "Plots", html)
