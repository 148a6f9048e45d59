"""Defines the command on pages about runs: ``adaptimp report``."""

from pathlib import Path
from typing import Annotated

import typer

from orchestration.cli import completion
from orchestration.cli.program import closing

EPILOG = closing("adaptimp report fig5", "adaptimp report fig2.parquet fig5.parquet -o both.html")


def report(
    runs: Annotated[
        list[str],
        typer.Argument(
            metavar="RUN",
            help="A result, .csv or .parquet, or a system to run: a scenario, an .ssp or .ssd file, a folder. Two are"
            " compared.",
            autocompletion=completion.subjects,
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE", help="File for the page, .html.", show_default=True)
    ] = Path("report.html"),
) -> None:
    """Write a page about one run, or about two: the arm in motion, plots, numbers, the system and its origin."""
    from orchestration.cli.pages import report_runs

    report_runs(runs, out)
