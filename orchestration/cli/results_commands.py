"""Defines the commands on results that are recorded already: ``adaptimp plot`` and ``adaptimp compare``."""

from pathlib import Path
from typing import Annotated

import typer

from orchestration.cli.codes import ExitCode
from orchestration.cli.options import Json
from orchestration.cli.program import closing

PLOT_EPILOG = closing(
    "adaptimp plot fig2.parquet plant.x controller.e -o tip.svg",
    "adaptimp plot fig2.parquet fig5.parquet --dark",
)
COMPARE_EPILOG = closing(
    "adaptimp compare fig2.parquet fig5.parquet",
    "adaptimp compare fig2.parquet fig5.parquet --json",
    codes={
        ExitCode.SUCCESS: "all bits of all columns agree",
        ExitCode.FAILED: "the results differ, or a file is unusable",
        ExitCode.REFUSED: "the results cannot be compared",
    },
)


def plot_(
    words: Annotated[
        list[str],
        typer.Argument(
            metavar="RESULT|NAME",
            help="Results, .csv or .parquet; then columns, arrays or patterns. Without names: path, torques or"
            " estimate, error and force of the paper's loop; of other systems a panel for each unit.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="File for the picture, .png, .svg or .pdf; .webp or .gif for the arm in motion.",
            show_default="name of the first result, .png",
        ),
    ] = None,
    dark: Annotated[bool, typer.Option("--dark", help="Draw for a dark page.")] = False,
) -> None:
    """Draw one or several results into a picture."""
    from orchestration.cli.pictures import plot_results

    plot_results(words, out, dark=dark)


def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="A result, .csv or .parquet.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="The result that is measured against it.")],
    json: Json = False,
) -> None:
    """Compare two results, column by column: how far they differ, and from where on."""
    from orchestration.cli.compare import compare_files

    raise typer.Exit(compare_files(first, second, json=json))
