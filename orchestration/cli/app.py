"""Defines the commands of ``adaptimp`` and their options; a command imports the modules it needs when it runs.

Exit codes: 0 success, 1 a run failed, 2 the request cannot be carried out as it stands.
"""

import sys
import warnings
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from orchestration.cli.codes import INTERRUPTED


class Interruptible(TyperGroup):
    """A group of commands that print a sentence when Ctrl-C ends them."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command.

        Raises
        ------
        typer.Exit
            For a KeyboardInterrupt.
        """
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            typer.echo("Interrupted.", err=True)
            raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    cls=Interruptible,
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"adaptimp {version('adaptimp')}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Adaptive impedance control (Lu & Meng 1991) as interchangeable FMUs (FMI 2.0, co-simulation)."""


@app.command()
def build(
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FILE.py", help="Python files that declare models.", show_default="every model"),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the .fmu files.")] = Path("build/fmus"),
    platform: Annotated[
        list[str] | None,
        typer.Option(
            help="Platform of the binaries, may be repeated; 'all' for every one.",
            show_default="this machine",
        ),
    ] = None,
) -> None:
    """Build the FMUs of the catalog or of your own models; binaries that exist already come from the cache."""
    from orchestration.cli.commands import build_fmus

    build_fmus(files or [], out, platform or [])


@app.command()
def paper(
    out: Annotated[Path, typer.Option(help="Folder for the figures and claims.json.")] = Path("out"),
    image: Annotated[str, typer.Option("--format", help="Format of the figures: png or svg.")] = "png",
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure the claims even if they are in the cache.")] = False,
) -> None:
    """Reproduce the paper's figures and claims from real FMUs."""
    from orchestration.cli.commands import reproduce_paper

    reproduce_paper(out, image, fresh=fresh)


@app.command()
def run(
    system: Annotated[
        str, typer.Argument(help="A scenario (fig2, ..., fig7, ideal, spong-ortega), an .ssp file or one .fmu file.")
    ],
    controller: Annotated[
        str | None,
        typer.Option(help="FMU in the place of the component 'controller': a file, or HoganImpedance and the like."),
    ] = None,
    map_: Annotated[
        list[str] | None,
        typer.Option(
            "--map",
            metavar="OURS=THEIRS",
            help="A name in the system and in the FMU; may be repeated.",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="COMP.VAR=VALUE",
            help="Start value; of an array one for all, or [A,B,...]; may be repeated.",
        ),
    ] = None,
    algorithm: Annotated[
        str, typer.Option(help="gauss-seidel, jacobi, iterative, newton or adaptive.")
    ] = "gauss-seidel",
    exchange: Annotated[
        str | None, typer.Option(help="sequential or parallel; by default that of the algorithm.")
    ] = None,
    input_order: Annotated[int | None, typer.Option(help="Degree, 0 to 2, of continuous inputs over a step.")] = None,
    tolerance: Annotated[
        float | None, typer.Option(help="Relative tolerance of iterative, newton or adaptive.")
    ] = None,
    absolute: Annotated[
        list[str] | None,
        typer.Option("--absolute", metavar="UNIT=VALUE", help="Absolute tolerance of a physical unit; repeatable."),
    ] = None,
    crossing: Annotated[
        list[str] | None,
        typer.Option("--crossing", metavar="COMP.VAR", help="Locate sign changes of this output; may be repeated."),
    ] = None,
    ratio: Annotated[
        list[str] | None,
        typer.Option("--ratio", metavar="COMP=N", help="This component makes steps of N steps; may be repeated."),
    ] = None,
    order: Annotated[str | None, typer.Option(help="Components in the order of stepping: A,B,...")] = None,
    step: Annotated[float | None, typer.Option(help="Communication step, s.")] = None,
    sample_time: Annotated[float | None, typer.Option(help="Communication step and every sample_time, s.")] = None,
    stop: Annotated[float | None, typer.Option(help="Stop time, s.")] = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="File for the result, .csv or .parquet.")] = None,
    record: Annotated[
        list[str] | None,
        typer.Option(metavar="COMP.VAR,...", help="Outputs, arrays or patterns to record; may be repeated."),
    ] = None,
    every: Annotated[int, typer.Option(help="Record every n-th step.")] = 1,
    verdict: Annotated[
        bool, typer.Option("--verdict/--no-verdict", help="Warn before the run if the algorithm is unstable.")
    ] = True,
    strict: Annotated[bool, typer.Option("--strict", help="Unconnected inputs are an error.")] = False,
    assumptions: Annotated[
        bool, typer.Option("--assumptions", help="Print which values are assumed, and why, instead of running.")
    ] = False,
    allow_stale_inputs: Annotated[
        bool,
        typer.Option("--allow-stale-inputs", help="Let a step hold several ticks, on the inputs of its start."),
    ] = False,
) -> None:
    """Run a system and print what it did."""
    from orchestration.cli.run import AlgorithmRequest, RunRequest, recorded, run_system

    run_system(
        RunRequest(
            system=system,
            controller=controller,
            mapping=tuple(map_ or ()),
            settings=tuple(set_ or ()),
            algorithm=AlgorithmRequest(algorithm, exchange, input_order, tolerance, tuple(absolute or ())),
            ratios=tuple(ratio or ()),
            crossings=tuple(crossing or ()),
            every=every,
            verdict=verdict,
            order=order.split(",") if order else None,
            step=step,
            sample_time=sample_time,
            stop=stop,
            out=out,
            record=recorded(record),
            strict=strict,
            assumptions=assumptions,
            allow_stale_inputs=allow_stale_inputs,
        )
    )


@app.command()
def export(
    name: Annotated[str, typer.Argument(help="A scenario: fig2, fig3, ..., fig7.")],
    out: Annotated[Path, typer.Option(help="The .ssp file to write.")],
) -> None:
    """Write a scenario as an SSP package, for this and for other tools."""
    from orchestration.cli.commands import export_scenario

    export_scenario(name, out)


@app.command()
def check(
    fmu: Annotated[Path, typer.Argument(help="The FMU to examine, from any tool.")],
    role: Annotated[
        str | None,
        typer.Option(help="controller, plant, sensor, actuator or trajectory; guessed from the outputs by default."),
    ] = None,
    map_: Annotated[
        list[str] | None,
        typer.Option("--map", metavar="OURS=THEIRS", help="A name in the role and in the FMU; may be repeated."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Examine an FMU: description, contract, interface, and for a controller a closed loop."""
    from orchestration.cli.check import run_check

    raise typer.Exit(run_check(fmu, role, json, tuple(map_ or ())))


def main() -> None:
    """Run the command line; an error of this package prints a sentence on standard error, not a traceback."""
    from orchestration.errors import InitializationError, OrchestrationError, SimulationError

    try:
        with warnings.catch_warnings():
            warnings.showwarning = _say
            app()
    except InitializationError as error:  # start values are part of the request
        _stop(error, 2)
    except SimulationError as error:
        _stop(error, 1)
    except OrchestrationError as error:
        _stop(error, 2)
    except OSError as error:  # a full disk, a cache that cannot be written
        _stop(error, 1)


def _say(message: Warning | str, *_: object) -> None:
    """Print a warning as a sentence, without the place in the code that it came from."""
    typer.echo(f"Warning: {message}", err=True)


def _stop(error: Exception, code: int) -> None:
    typer.echo(f"Error: {error}", err=True)
    sys.exit(code)
