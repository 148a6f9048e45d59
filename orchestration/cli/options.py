"""Options and arguments that several commands of ``adaptimp`` have, and the sections of the help."""

from pathlib import Path
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
        help="A scenario ('adaptimp list' names them), an .ssp or .ssd file, a folder with one, or one .fmu file.",
        autocompletion=completion.systems,
    ),
]
Variant = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Take another .ssd file of the package; 'adaptimp info' lists them.",
        rich_help_panel=SYSTEM,
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
Isolate = Annotated[
    list[str] | None,
    typer.Option(
        "--isolate",
        metavar="[COMP,...]",
        help="Run the FMUs of these components, or of all, in processes of their own, so that a crash or a hang is an "
        "error; repeatable.",
        rich_help_panel=CARE,
    ),
]
Step = Annotated[float | None, typer.Option(metavar="H", help="Communication step, s.", rich_help_panel=TIME)]
Stop = Annotated[
    float | None,
    typer.Option(metavar="T", help="Stop time, s; by default that of the system.", rich_help_panel=TIME),
]
AlgorithmName = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="gauss-seidel, jacobi, iterative, newton or adaptive.",
        rich_help_panel=ALGORITHM,
        autocompletion=completion.algorithms,
    ),
]
FormName = Annotated[
    str | None,
    typer.Option(
        "--as",
        metavar="FORM",
        help="What to write: ssp for a package; fmu, wasm or c for one program. Default: as PATH ends.",
    ),
]
ProgramAlgorithm = Annotated[
    str | None,
    typer.Option(
        "--algorithm",
        metavar="NAME",
        help="How one program steps: gauss-seidel (default) or jacobi.",
        rich_help_panel=ALGORITHM,
        autocompletion=completion.algorithms,
    ),
]
ProgramPlatform = Annotated[
    list[str] | None,
    typer.Option("--platform", metavar="NAME", help="Platform of an FMU's binaries, repeatable; 'all' for every one."),
]
Exchange = Annotated[
    str | None,
    typer.Option(
        metavar="WHEN",
        help="sequential or parallel; by default that of the algorithm.",
        rich_help_panel=ALGORITHM,
    ),
]
InputOrder = Annotated[
    int | None,
    typer.Option(metavar="N", help="Degree, 0 to 2, of continuous inputs over a step.", rich_help_panel=ALGORITHM),
]
Order = Annotated[
    str | None,
    typer.Option(metavar="A,B,...", help="Components in the order of stepping.", rich_help_panel=ALGORITHM),
]
Input = Annotated[
    list[str] | None,
    typer.Option(
        "--input",
        metavar="FILE[:held|:linear]",
        help="Time series for inputs, .csv or .parquet with columns COMP.VAR; repeatable.",
        rich_help_panel=OUTSIDE,
    ),
]
At = Annotated[
    list[str] | None,
    typer.Option(
        "--at",
        metavar="T COMP.VAR=VALUE",
        help="Set a tunable parameter or a free input at T s; repeatable.",
        rich_help_panel=OUTSIDE,
    ),
]
Pace = Annotated[
    float | None,
    typer.Option(
        metavar="RATE",
        help="Simulated seconds per second: 1 keeps step with the clock.",
        rich_help_panel=OUTSIDE,
    ),
]
Json = Annotated[
    bool,
    typer.Option(
        "--json", help="Print one JSON object, and nothing else on standard output.", rich_help_panel=MESSAGES
    ),
]
Plot = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Draw the run into this file, .png, .svg or .pdf, the arm in motion, .webp or .gif, or write a page about"
        " it, .html ('adaptimp plot' and 'adaptimp report' take recorded rows).",
        rich_help_panel=ROWS,
    ),
]
Dark = Annotated[bool, typer.Option("--dark", help="Draw for a dark page.", rich_help_panel=ROWS)]
RowHash = Annotated[
    bool,
    typer.Option("--hash", help="Say the SHA-256 of all rows, to compare with other machines.", rich_help_panel=ROWS),
]
Strict = Annotated[
    bool,
    typer.Option(
        "--strict", help="Treat unconnected inputs, and FMUs that break rules of form, as errors.", rich_help_panel=CARE
    ),
]
StaleInputs = Annotated[
    bool,
    typer.Option(
        "--allow-stale-inputs",
        help="Let a step hold several ticks, which use the inputs of its start.",
        rich_help_panel=CARE,
    ),
]
AllowNan = Annotated[
    bool,
    typer.Option(
        "--allow-nan", help="Go on when a recorded value is NaN or infinite, and keep it.", rich_help_panel=CARE
    ),
]
FmuTolerance = Annotated[
    float | None,
    typer.Option(
        metavar="R",
        help="Relative tolerance that each FMU is told; by default that of its own default experiment.",
        rich_help_panel=TIME,
    ),
]
FmuStopTime = Annotated[
    bool,
    typer.Option(
        "--fmu-stop-time/--no-fmu-stop-time", help="Tell FMUs the stop time of the run.", rich_help_panel=TIME
    ),
]
Start = Annotated[
    float | None,
    typer.Option(metavar="T", help="Start time, s; by default that of the system.", rich_help_panel=TIME),
]
