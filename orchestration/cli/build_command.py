"""Defines the command ``adaptimp build``: its options and the end of its help."""

from pathlib import Path
from typing import Annotated

import typer

from orchestration.cli.program import closing

EPILOG = closing("adaptimp build -o fmus_built", "adaptimp build mine.py -o built --verbose")


def build(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="FILE.py",
            help="Python files that declare models, or names of shipped models and their variants.",
            show_default="every model",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FOLDER",
            help="Folder for the .fmu files.",
            show_default="build/fmus; build/reals with --reals",
        ),
    ] = None,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Platform of the binaries, repeatable; 'all' for every one.",
            show_default="this machine",
        ),
    ] = None,
    reals: Annotated[
        bool,
        typer.Option(
            "--reals",
            help="Make Booleans Reals of 0 and 1, and Integers Reals of whole numbers, for tools that know Reals only;"
            " the files have the same names.",
        ),
    ] = False,
) -> None:
    """Build the FMUs of the catalog or of your own models; binaries that exist already come from the cache."""
    from orchestration.cli.commands import build_fmus

    build_fmus(files or [], out or Path("build/reals" if reals else "build/fmus"), platform or [], reals=reals)
