"""Options and arguments that several commands of ``adaptimp`` have, and the sections of the help."""

from typing import Annotated

import typer

from orchestration.cli import completion
from orchestration.cli.program import MESSAGES

SYSTEM, TIME, ALGORITHM, ROWS, CARE = "System", "Time", "Algorithm", "Rows", "Care"
OUTSIDE = "From outside"
"""Sections of the help of ``adaptimp run``."""

SystemName = Annotated[
    str,
    typer.Argument(
        metavar="SYSTEM",
        help="A scenario ('adaptimp list' names them), an .ssp file or one .fmu file.",
        autocompletion=completion.systems,
    ),
]
Controller = Annotated[
    str | None,
    typer.Option(
        metavar="FMU",
        help="FMU in the place of the component 'controller': a file, or HoganImpedance and the like.",
        rich_help_panel=SYSTEM,
        autocompletion=completion.controllers,
    ),
]
Mapping = Annotated[
    list[str] | None,
    typer.Option(
        "--map",
        metavar="OURS=THEIRS",
        help="A name in the system, and the controller's name for the same; repeatable.",
        rich_help_panel=SYSTEM,
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="COMP.VAR=VALUE",
        help="Start value; of an array one for all, or [A,B,...]; repeatable.",
        rich_help_panel=SYSTEM,
        autocompletion=completion.settable,
    ),
]
SampleTime = Annotated[
    float | None,
    typer.Option(metavar="H", help="Communication step and every sample_time, s.", rich_help_panel=TIME),
]
StaleInputs = Annotated[
    bool,
    typer.Option(
        "--allow-stale-inputs",
        help="Let a step hold several ticks, on the inputs of its start.",
        rich_help_panel=CARE,
    ),
]
Isolate = Annotated[
    list[str] | None,
    typer.Option(
        "--isolate",
        metavar="[COMP,...]",
        help="Run the FMUs of these components, or of all, in processes of their own; repeatable.",
        rich_help_panel=CARE,
    ),
]
Json = Annotated[
    bool,
    typer.Option(
        "--json", help="Print one JSON object, and nothing else on standard output.", rich_help_panel=MESSAGES
    ),
]
