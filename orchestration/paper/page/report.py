"""Reports as pages: of one run or two, and of the whole paper; what any run has, and what the paper's loop has."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.errors import OrchestrationError
from orchestration.fmi.given import a_path
from orchestration.paper.claims.claim import Claim
from orchestration.paper.figures.phases import FORCE, phases
from orchestration.paper.page.again import command_again
from orchestration.paper.page.arm import SCRIPT, arm_of, arm_section, columns, has_arm, script
from orchestration.paper.page.assumptions import assumptions_section
from orchestration.paper.page.claims import claims_section
from orchestration.paper.page.panels import paper_panels
from orchestration.paper.run_numbers import run_numbers
from orchestration.paper.scenarios import SCENARIOS
from orchestration.report.page import Page
from orchestration.report.run_page import Views, run_page
from orchestration.report.tables import Told
from orchestration.results.result import Result
from orchestration.results.row_hash import row_hash
from orchestration.system.system import System

NAME, SUFFIX = "report.html", ".html"
AT_FIRST = "fig5"
"""What the page of the paper shows until the reader chooses; the live part starts from it, too."""
MOST_RUNS = 2


def write_report(results: Mapping[str, Result], path: str | Path, systems: Mapping[str, System] | None = None) -> None:
    """Write a page about one run or two: plots, numbers, the system and its origin; of the paper's loop also the arm.

    Parameters
    ----------
    results
        Results by their labels, one or two.
    path
        File for the page, with the suffix ``.html``. The page needs no network.
    systems
        Systems that were run, by the label of the run, as far as they are at hand. With them the page tells the energy
        that the coupling has added.

    Raises
    ------
    OrchestrationError
        If there are no results or more than two, a result has no rows, the suffix is another one, or the file cannot be
        written.

    Examples
    --------
    >>> from pathlib import Path
    >>> from orchestration import scenario, simulate, write_report
    >>> write_report({"fig2": simulate(scenario("fig2"), stop_time=1.2)}, "fig2.html")
    >>> Path("fig2.html").read_text(encoding="utf-8").splitlines()[0]
    '<!DOCTYPE html>'
    """
    target = a_path("The file of a page", path)
    if target.suffix.lower() != SUFFIX:
        msg = f"{target}: a page has the suffix {SUFFIX}; Result.plot draws pictures."
        raise OrchestrationError(msg)
    write_page(report_page(results, systems), target)


def report_page(results: Mapping[str, Result], systems: Mapping[str, System] | None = None) -> Page:
    """The page of one run or of two, of any systems.

    Parameters
    ----------
    results
        Results by their labels.
    systems
        Systems that were run, by the label of the run, as far as they are at hand.

    Raises
    ------
    OrchestrationError
        If there are no results, or more than two, or a result has no rows.
    """
    if not 0 < len(results) <= MOST_RUNS:
        msg = f"{len(results)} results were given; a report is about one, or compares two."
        raise OrchestrationError(msg)
    for label, result in results.items():
        if not len(result.time):
            msg = f"{label}: the result has no rows, so there is nothing to report; record at least one step."
            raise OrchestrationError(msg)
    return run_page(results, _views(results, systems or {}))


def paper_page(results: Mapping[str, Result], claims: Sequence[Claim], words: Mapping[str, str]) -> Page:
    """The page of the paper: all runs of its figures, among which the reader chooses, and the claims.

    Parameters
    ----------
    results
        Results of the scenarios by name.
    claims, words
        The claims, and how strongly each holds, in a phrase, by claim.
    """
    views = _views(results, {})
    needed = {name for panel in views.panels for curve in panel.curves for name in curve.columns} | {*views.needed}
    kept = {label: _only(result, needed) for label, result in results.items()}
    offered = {name: SCENARIOS[name].caption for name in results}
    views = replace(views, offered=offered, last=[claims_section(claims, words), *views.last])
    views = replace(views, at_first=AT_FIRST if AT_FIRST in results else "")
    page = run_page(kept, views)
    lead = "Runs of the figures of Lu and Meng (1991), made from FMUs, and what they say of the claims of the paper."
    return replace(page, title="Adaptive impedance control: the paper reproduced", lead=lead)


def write_page(page: Page, path: Path) -> None:
    """Write a page as an HTML file.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    try:
        write_whole(path, page.html().encode("utf-8"))
    except OSError as error:
        msg = f"{path}: the page cannot be written: {error.strerror or error}; choose another place."
        raise OrchestrationError(msg) from error


def _views(results: Mapping[str, Result], systems: Mapping[str, System]) -> Views:
    armed = {label: result for label, result in results.items() if has_arm(result)}
    runs = list(results.values())
    assumed = assumptions_section(results, systems)
    return Views(
        panels=paper_panels(runs),
        phases=[phases(result) if FORCE in result else {} for result in runs],
        extra=[{"arm": arm_of(result)} if has_arm(result) else {} for result in runs],
        first=[arm_section(armed)] if armed else [],
        last=[] if assumed is None else [assumed],
        needed=columns(),
        modules=[script()] if armed else [],
        starts=[SCRIPT] if armed else [],
        told={label: _told(result, systems.get(label)) for label, result in results.items()},
    )


def _told(result: Result, system: System | None) -> Told:
    numbers = [(name, number.value, number.unit) for name, number in run_numbers(result).items()]
    return Told(system, numbers, command_again(result), row_hash(result))


def _only(result: Result, needed: set[str]) -> Result:
    """A result with the columns that a page shows."""
    places = [place for place, name in enumerate(result.names) if name in needed]
    return replace(result, names=tuple(result.names[i] for i in places), rows=result.rows[:, places])
