"""The report of one or two runs as a page: what any run has, and what the paper's loop has besides."""

from collections.abc import Mapping
from pathlib import Path

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.figures.phases import FORCE, phases
from orchestration.paper.page.arm import SCRIPT, arm_of, arm_section, columns, has_arm, script
from orchestration.paper.page.panels import paper_panels
from orchestration.report.page import Page
from orchestration.report.run_page import Views, run_page
from orchestration.results.result import Result


def report_page(results: Mapping[str, Result]) -> Page:
    """The page of runs of any systems.

    Parameters
    ----------
    results
        Results by their labels, one or two.
    """
    armed = {label: result for label, result in results.items() if has_arm(result)}
    runs = list(results.values())
    views = Views(
        panels=paper_panels(runs),
        phases=[phases(result) if FORCE in result else {} for result in runs],
        extra=[{"arm": arm_of(result)} if has_arm(result) else {} for result in runs],
        first=[arm_section(armed)] if armed else [],
        needed=columns(),
        modules=[script()] if armed else [],
        starts=[SCRIPT] if armed else [],
    )
    return run_page(results, views)


def write_report(results: Mapping[str, Result], path: Path) -> None:
    """Write the page of runs as an HTML file."""
    write_whole(path, report_page(results).html().encode("utf-8"))
