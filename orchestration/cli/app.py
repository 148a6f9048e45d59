"""Defines the commands of ``adaptimp``; a command imports the modules it needs when it runs.

The exit codes are those of `orchestration.cli.codes`.
"""

import sys
import traceback
import warnings
from pathlib import Path
from typing import Annotated

import typer

from adaptimp_fmu.files.parts import missing_part
from orchestration.cli import completion
from orchestration.cli.build_command import EPILOG as BUILD_EPILOG
from orchestration.cli.build_command import build
from orchestration.cli.cache_command import EPILOG as CACHE_EPILOG
from orchestration.cli.cache_command import cache
from orchestration.cli.codes import ExitCode, exit_code_of
from orchestration.cli.doctor_command import EPILOG, doctor
from orchestration.cli.isolation import IsolatingCommand
from orchestration.cli.new_command import EPILOG as NEW_EPILOG
from orchestration.cli.new_command import new
from orchestration.cli.options import (
    ALGORITHM,
    CARE,
    ROWS,
    AlgorithmName,
    AllowNan,
    At,
    Controller,
    Dark,
    Exchange,
    FmuStopTime,
    FmuTolerance,
    FormName,
    Input,
    InputOrder,
    Isolate,
    Json,
    Mapping,
    Order,
    Pace,
    Plot,
    ProgramAlgorithm,
    ProgramPlatform,
    RowHash,
    SampleTime,
    Settings,
    StaleInputs,
    Start,
    Step,
    Stop,
    Strict,
    SystemName,
    Variant,
)
from orchestration.cli.output import never_fail_on_characters, output, require_streams
from orchestration.cli.outside import RunCommand
from orchestration.cli.program import (
    SETTINGS,
    Command,
    Debug,
    Program,
    Quiet,
    Verbose,
    Version,
    closing,
    with_messages,
)
from orchestration.cli.report_command import EPILOG as REPORT_EPILOG
from orchestration.cli.report_command import report
from orchestration.cli.results_commands import COMPARE_EPILOG, PLOT_EPILOG, compare, plot_
from orchestration.cli.sweep_command import EPILOG as SWEEP_EPILOG
from orchestration.cli.sweep_command import SweepCommand, sweep

app = typer.Typer(
    cls=Program,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings=SETTINGS,
)


@app.callback(epilog=closing("adaptimp run fig5", "adaptimp run --help"))
def common(
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
    version: Version = False,  # noqa: ARG001 - its callback prints it
) -> None:
    """Adaptive impedance control (Lu & Meng 1991) as interchangeable FMUs (FMI 2.0, co-simulation)."""
    output.choose(quiet=quiet, verbose=verbose, debug=debug)


@app.command("list", cls=Command, epilog=closing("adaptimp list", "adaptimp list --json"))
@with_messages
def list_(json: Json = False) -> None:
    """List the scenarios, the shipped FMUs and the algorithms, each with what it is."""
    from orchestration.cli.listing import list_all

    list_all(json=json)


@app.command(cls=Command, epilog=closing("adaptimp info fig5", "adaptimp info HoganImpedance --json"))
@with_messages
def info(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="An .fmu, .ssp or .ssd file, a folder, a result (.csv or .parquet), a scenario or a shipped FMU.",
            autocompletion=completion.subjects,
        ),
    ],
    variant: Variant = None,
    json: Json = False,
) -> None:
    """Show what is in an FMU, a system or a result: variables, connections, columns."""
    from orchestration.cli.info import print_info

    print_info(name, variant, json=json)


@app.command(
    cls=RunCommand,
    epilog=closing(
        "adaptimp run fig4 --set plant.mu=0.2 -o fig4.csv",
        "adaptimp run fig2 --algorithm adaptive --tolerance 1e-6 \\\n    --record plant.x -o x.parquet",
    ),
)
@with_messages
def run(
    system: SystemName,
    variant: Variant = None,
    controller: Controller = None,
    map_: Mapping = None,
    set_: Settings = None,
    algorithm: AlgorithmName = "gauss-seidel",
    exchange: Exchange = None,
    input_order: InputOrder = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="R", help="Relative tolerance of iterative, newton or adaptive.", rich_help_panel=ALGORITHM
        ),
    ] = None,
    absolute: Annotated[
        list[str] | None,
        typer.Option(
            "--absolute",
            metavar="UNIT=VALUE",
            help="Absolute tolerance of a physical unit; repeatable.",
            rich_help_panel=ALGORITHM,
        ),
    ] = None,
    crossing: Annotated[
        list[str] | None,
        typer.Option(
            "--crossing",
            metavar="COMP.VAR",
            help="Locate sign changes of this output; repeatable.",
            rich_help_panel=ALGORITHM,
            autocompletion=completion.recordable,
        ),
    ] = None,
    ratio: Annotated[
        list[str] | None,
        typer.Option(
            "--ratio",
            metavar="COMP=N",
            help="This component makes steps of N steps; repeatable.",
            rich_help_panel=ALGORITHM,
        ),
    ] = None,
    order: Order = None,
    step: Step = None,
    sample_time: SampleTime = None,
    start: Start = None,
    stop: Stop = None,
    fmu_tolerance: FmuTolerance = None,
    fmu_stop_time: FmuStopTime = True,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="File for the rows, .csv or .parquet.", rich_help_panel=ROWS),
    ] = None,
    record: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COMP.VAR,...",
            help="Variables, arrays, patterns of outputs; repeatable.",
            rich_help_panel=ROWS,
            autocompletion=completion.recordable,
        ),
    ] = None,
    every: Annotated[int, typer.Option(metavar="N", help="Record every n-th step.", rich_help_panel=ROWS)] = 1,
    hash_: RowHash = False,
    plot: Plot = None,
    dark: Dark = False,
    input_: Input = None,
    at: At = None,
    pace: Pace = None,
    verdict: Annotated[
        bool,
        typer.Option(
            "--verdict/--no-verdict", help="Warn before the run if the algorithm is unstable.", rich_help_panel=CARE
        ),
    ] = True,
    strict: Strict = False,
    assumptions: Annotated[
        bool,
        typer.Option(
            "--assumptions",
            help="Print which values are assumed, and why, instead of running.",
            rich_help_panel=CARE,
        ),
    ] = False,
    allow_stale_inputs: StaleInputs = False,
    isolate: Isolate = None,
    allow_nan: AllowNan = False,
    json: Json = False,
) -> None:
    """Run a system, and print or write what it did."""
    from orchestration.cli.algorithms import AlgorithmRequest
    from orchestration.cli.outside import OutsideRequest
    from orchestration.cli.pictures import PictureRequest
    from orchestration.cli.run import RunRequest, run_system
    from orchestration.cli.systems import SystemRequest

    run_system(
        RunRequest(
            asked=SystemRequest(system, controller, tuple(map_ or ()), tuple(set_ or ()), sample_time, variant),
            algorithm=AlgorithmRequest(algorithm, exchange, input_order, tolerance, tuple(absolute or ())),
            ratios=tuple(ratio or ()),
            crossings=tuple(crossing or ()),
            every=every,
            verdict=verdict,
            order=order.split(",") if order else None,
            step=step,
            start=start,
            stop=stop,
            out=out,
            record=record,
            strict=strict,
            assumptions=assumptions,
            allow_stale_inputs=allow_stale_inputs,
            isolate=tuple(isolate or ()),
            allow_nan=allow_nan,
            fmu_tolerance=fmu_tolerance,
            fmu_stop_time=fmu_stop_time,
            json=json,
            hash=hash_,
            outside=OutsideRequest(tuple(input_ or ()), tuple(at or ()), pace),
            picture=PictureRequest(plot, dark, option="--plot", page=True),
        )
    )


@app.command(
    cls=Command,
    epilog=closing(
        "adaptimp export fig5 --set controller.K=[4000,2000] \\\n"
        "    --controller SlotineLiAdaptiveImpedance -o other.ssp",
        "adaptimp export fig5 --as c -o fig5_in_c",
    ),
)
@with_messages
def export(
    system: SystemName,
    out: Annotated[Path, typer.Option("--out", "-o", metavar="PATH", help="File to write; with --as c a folder.")],
    form: FormName = None,
    variant: Variant = None,
    controller: Controller = None,
    map_: Mapping = None,
    set_: Settings = None,
    algorithm: ProgramAlgorithm = None,
    order: Order = None,
    step: Step = None,
    sample_time: SampleTime = None,
    platform: ProgramPlatform = None,
    reals: Annotated[
        bool,
        typer.Option("--reals", help="Make a scenario of FMUs with Reals only, as 'build --reals' makes them."),
    ] = False,
) -> None:
    """Write a system as an SSP package, or as one program, for this and for other tools."""
    from orchestration.cli.export import ExportRequest, export_system
    from orchestration.cli.systems import SystemRequest

    asked = SystemRequest(system, controller, tuple(map_ or ()), tuple(set_ or ()), sample_time, variant, reals)
    export_system(ExportRequest(asked, out, form, step, order, algorithm, tuple(platform or ())))


app.command(cls=Command, epilog=BUILD_EPILOG)(with_messages(build))
app.command(cls=Command, epilog=NEW_EPILOG)(with_messages(new))
app.command(cls=Command, epilog=CACHE_EPILOG)(with_messages(cache))


@app.command(
    cls=Command,
    epilog=closing(
        "adaptimp check mine.fmu",
        "adaptimp check mine.fmu --role controller \\\n    --map tau_cmd=Torque --map q=JointAngle",
        codes={ExitCode.FAILED: "errors were found in the FMU", ExitCode.REFUSED: "the file cannot be examined"},
    ),
)
@with_messages
def check(
    fmu: Annotated[Path, typer.Argument(metavar="FILE.fmu", help="The FMU to examine, from any tool.")],
    role: Annotated[
        str | None,
        typer.Option(
            metavar="ROLE",
            help="controller, plant, sensor, actuator or trajectory; guessed from the outputs by default.",
        ),
    ] = None,
    map_: Annotated[
        list[str] | None,
        typer.Option("--map", metavar="OURS=THEIRS", help="A name in the role, and the FMU's name; repeatable."),
    ] = None,
    json: Json = False,
) -> None:
    """Examine an FMU in a confined process: description, contract, interface, and for a controller a closed loop."""
    from orchestration.cli.check import run_check

    raise typer.Exit(run_check(fmu, role, json, tuple(map_ or ())))


app.command(cls=IsolatingCommand, epilog=EPILOG)(with_messages(doctor))
app.command("plot", cls=Command, epilog=PLOT_EPILOG)(with_messages(plot_))
app.command(cls=Command, epilog=COMPARE_EPILOG)(with_messages(compare))
app.command(cls=Command, epilog=REPORT_EPILOG)(with_messages(report))
app.command(cls=SweepCommand, epilog=SWEEP_EPILOG)(with_messages(sweep))


@app.command(
    cls=Command,
    epilog=closing("adaptimp paper -o figures --format svg", "adaptimp paper --robot puma"),
)
@with_messages
def paper(
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FOLDER", help="Folder for the figures and the claims.")
    ] = Path("out"),
    image: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="Format of the figures: png or svg.")
    ] = "png",
    robot: Annotated[
        str, typer.Option("--robot", metavar="ARM", help="Arm: planar, the paper's, or puma, the PUMA 560.")
    ] = "planar",
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure the claims even if they are in the cache.")] = False,
) -> None:
    """Reproduce the paper's figures and claims from real FMUs."""
    from orchestration.cli.commands import reproduce_paper

    reproduce_paper(out, image, robot, fresh=fresh)


def main() -> None:
    """Run the command line; an error of this package prints a sentence on standard error, not a traceback."""
    from orchestration.errors import OrchestrationError

    output.reset()
    try:
        require_streams()
        never_fail_on_characters()
        with warnings.catch_warnings():
            warnings.showwarning = output.warn
            app()
    except (OrchestrationError, OSError) as error:
        if output.debug:
            traceback.print_exception(error)
        output.error(f"Error: {_said(error)}")
        sys.exit(exit_code_of(error))
    except Exception as error:
        missing = missing_part(error) if isinstance(error, ImportError) else None
        if missing is not None:
            if output.debug:
                traceback.print_exception(error)
            output.error(f"Error: {missing}")
            sys.exit(exit_code_of(missing))
        traceback.print_exc()
        output.error("Error: this is a fault of adaptimp; please report it with the lines above.")
        sys.exit(ExitCode.FAULT)


def _said(error: Exception) -> str:
    """The text of an error; an error of the operating system without its number."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}." if error.filename else f"{error.strerror}."
    return str(error)
