"""Examines an FMU and prints the report: ``adaptimp check``.

Exit codes: 0 no errors, 1 errors were found, 2 the file cannot be examined.
"""

import json as formats
from collections.abc import Sequence
from pathlib import Path

from rich.table import Column, Table
from rich.text import Text

from orchestration.check import Report, Severity, check
from orchestration.check.rules import PAGE, rule_of
from orchestration.cli.codes import ExitCode
from orchestration.cli.output import output, watched
from orchestration.cli.settings import setting_of
from orchestration.errors import ArchiveError, SystemDescriptionError, printable
from orchestration.paper.closed_loop import in_loop, paper_loop
from orchestration.paper.roles import ROLES, role_named

COLOURS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.NOTE: "dim"}


def run_check(path: Path, role: str | None = None, json: bool = False, mapping: Sequence[str] = ()) -> int:
    """Check an FMU and print the report, as a table or as JSON; returns the exit code.

    Parameters
    ----------
    role
        The role whose interface the FMU must have; None takes the role whose defining output the FMU has.
    mapping
        Texts OURS=THEIRS: a name of the role, and the FMU's name for the same variable.
    """
    try:
        names = dict(map(setting_of("--map"), mapping))
        wanted = ROLES.values() if role is None else role_named(role)
        with watched() as line:
            line.begin(f"examining {printable(path.name)}")
            report = check(path, wanted, mapping=names, trial=in_loop(paper_loop))
    except (ArchiveError, SystemDescriptionError, OSError) as error:
        if json:
            output.data(formats.dumps({"file": str(path), "error": str(error)}, indent=2))
        output.error(f"Error: {error}")
        return ExitCode.REFUSED
    if json:
        output.data(report.json())
    else:
        _print(report)
    return ExitCode.FAILED if report.failed else ExitCode.SUCCESS


def _print(report: Report) -> None:
    if report.findings:
        more = [Column("what to do", overflow="fold")] if output.verbose else []
        table = Table("rule", "severity", Column("finding", overflow="fold"), *more, show_edge=False)
        for finding in report.findings:
            rule = rule_of(finding.rule, finding.severity)
            advice = ["" if rule is None else rule.remedy] if output.verbose else []
            table.add_row(finding.rule, Text(finding.severity, COLOURS[finding.severity]), finding.message, *advice)
        output.show(table)
        output.show(f"{PAGE} explains the rules; --verbose says what to do.")
    for fact in report.facts:
        output.show(fact)
    output.show(report.summary())
