"""Defines the command ``adaptimp cache``: its options and the end of its help."""

from typing import Annotated

import typer

from orchestration.cli import completion
from orchestration.cli.options import Json
from orchestration.cli.program import closing

EPILOG = closing("adaptimp cache", "adaptimp cache clear ssp native")


def cache(
    action: Annotated[
        str | None,
        typer.Argument(
            metavar="ACTION",
            help="What to do: 'clear' removes without a question.",
            show_default="list what is kept",
            autocompletion=completion.cache_actions,
        ),
    ] = None,
    which: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="WHICH",
            help="Kinds to remove, as 'adaptimp cache' names them.",
            show_default="all but robustness",
            autocompletion=completion.cache_kinds,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """List what is kept between runs, or remove it; what living processes work with stays."""
    from orchestration.cli.cache import clear_caches, list_caches, require_action

    require_action(action)
    if action is None:
        list_caches(json=json)
    else:
        clear_caches(which or [], json=json)
