"""What the command check does.

Exit codes: 0 no errors, 1 errors were found, 2 the file cannot be examined.
"""

import json as formats
from collections.abc import Sequence
from pathlib import Path

import typer
from rich.table import Column, Table
from rich.text import Text

from orchestration.check import Loop, Report, Severity, check
from orchestration.cli.commands import console, setting_of
from orchestration.errors import ArchiveError, SystemDescriptionError

COLOURS = {Severity.ERROR: "red", Severity.WARNING: "yellow", Severity.NOTE: "dim"}
FAILED, NOT_EXAMINED = 1, 2
STEP = 1e-4  # s
REDUNDANT_LIMIT = 1e4  # N.m, far above what three joints of the redundant arm need


def run_check(path: Path, role: str | None = None, json: bool = False, mapping: Sequence[str] = ()) -> int:
    """Check an FMU and print the report, as a table or as JSON; returns the exit code.

    Parameters
    ----------
    mapping
        Texts OURS=THEIRS.
    """
    try:
        names = dict(map(setting_of("--map"), mapping))
        report = check(path, role, mapping=names, loop=paper_loop)
    except (ArchiveError, SystemDescriptionError, OSError) as error:
        if json:
            typer.echo(formats.dumps({"file": str(path), "error": str(error)}, indent=2))
        typer.echo(f"Error: {error}", err=True)
        return NOT_EXAMINED
    if json:
        typer.echo(report.json())
    else:
        _print(report)
    return FAILED if report.failed else 0


def paper_loop(joints: int) -> Loop | None:
    """The loop for two joints or three, without noise and limits; None for more.

    That of Fig. 2, with the damping of Figs. 5 to 7, with which adaptive controllers are strictly positive real.
    """
    from orchestration.paper.built_fmus import fmus
    from orchestration.paper.scenarios import TORQUE_LIMITS, VARIANTS
    from orchestration.system.system import System

    if joints == 2:
        chosen = VARIANTS["ideal"]
        return Loop(chosen.system(fmus(chosen.units.values())).with_sample_time(STEP), TORQUE_LIMITS)
    if joints == 3:
        units = {
            "trajectory": "VirtualTrajectory",
            "sensor": "ForceSensor",
            "controller": "HoganImpedance3R",
            "actuator": "Actuator3R",
            "plant": "Plant3R",
        }
        files = fmus(units.values())
        system = System.connected_by_name("redundant", {name: files[unit] for name, unit in units.items()})
        return Loop(system, (REDUNDANT_LIMIT,) * 3)
    return None


def _print(report: Report) -> None:
    if report.findings:
        table = Table("rule", "severity", Column("finding", overflow="fold"), show_edge=False)
        for finding in report.findings:
            table.add_row(finding.rule, Text(finding.severity, COLOURS[finding.severity]), finding.message)
        console.print(table)
    for fact in report.facts:
        console.print(fact)
    console.print(report.summary())
