"""Defines the command ``adaptimp new``: its options and the end of its help."""

from pathlib import Path
from typing import Annotated

import typer

from orchestration.cli import completion
from orchestration.cli.program import closing

EPILOG = closing("adaptimp new controller Mine", "adaptimp new controller Softer \\\n    --from craig -o softer")


def new(
    kind: Annotated[
        str,
        typer.Argument(metavar="KIND", help="What to begin: 'controller'.", autocompletion=completion.kinds),
    ],
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of the model and of its file; an identifier such as Mine.")
    ],
    source: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="LAW",
            help="Law to begin with: craig, hogan, slotine-li or spong-ortega.",
            show_default="a spring and a damper",
            autocompletion=completion.laws,
        ),
    ] = None,
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FOLDER", help="Folder for the two files.")] = Path("."),
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there already.")] = False,
) -> None:
    """Begin a controller of your own: a short model in Python, and a test that passes."""
    from orchestration.cli.new_controller import create

    create(kind, name, source, out, force=force)
