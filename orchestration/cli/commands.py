"""What the commands do."""

import re
import tempfile
import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Column, Table
from rich.text import Text

from orchestration.errors import OrchestrationError, SimulationError, SystemDescriptionError
from orchestration.master import Options, simulate
from orchestration.master import Progress as Report
from orchestration.result import Result
from orchestration.system import System

PROGRESS_AFTER = 1.0  # s
IMAGES = ("png", "svg")
INTERRUPTED = 130  # exit code, as shells have it
_SETTING = re.compile(r"([^=\s]+)=(.*)", re.DOTALL)

console = Console(markup=False, highlight=False)  # names such as x[i] are no markup
errors = Console(stderr=True, markup=False, highlight=False)


@dataclass(frozen=True)
class RunRequest:
    """Options of ``adaptimp run``; times in s."""

    system: str
    controller: Path | None
    settings: Sequence[str]
    algorithm: str
    order: Sequence[str] | None
    step: float | None
    sample_time: float | None
    stop: float | None
    out: Path | None
    record: Sequence[str] | None
    strict: bool
    allow_stale_inputs: bool


def build_fmus(out: Path, platforms: Sequence[str]) -> None:
    """Build every unit into a folder."""
    from adaptimp_fmu import PLATFORMS
    from fmus.catalog import UNITS
    from orchestration.paper.provide import built

    for name in platforms:
        if name not in PLATFORMS and name != "all":
            msg = f"There is no platform {name}; there are {', '.join(PLATFORMS)} and all."
            raise SystemDescriptionError(msg)
    chosen = list(PLATFORMS.values()) if "all" in platforms else [PLATFORMS[n] for n in platforms]
    _require_folder(out)
    for identifier in UNITS:
        path = built(identifier, out, chosen)
        typer.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


def reproduce_paper(out: Path, image: str, *, fresh: bool) -> None:
    """Run, draw, measure; print the table of claims."""
    from orchestration.paper.report import reproduce

    if image not in IMAGES:
        msg = f"There is no image format {image}; there are {', '.join(IMAGES)}."
        raise SystemDescriptionError(msg)
    _require_folder(out)
    report = reproduce(out, lambda sentence: typer.echo(f"{sentence} ..."), image, fresh=fresh)
    table = Table("id", "claim", "measured", "verdict", title="Claims of the paper")
    colours = {"holds": "green", "not reproduced": "red"}
    for claim in report.claims:
        colour = colours.get(claim.verdict, "dim")
        table.add_row(claim.id, claim.claim, claim.measured, Text(claim.verdict, colour))
    console.print(table)
    if report.kept:
        typer.echo("The claims were measured by an earlier run on the same FMUs, numbers and code; --fresh repeats it.")
    for path in (*report.figures, report.claims_file):
        typer.echo(f"wrote {path}")


def run_system(request: RunRequest) -> None:
    """Run a system as asked; a run that fails half-way still writes the rows it made."""
    system = _system(request)
    for notice in system.notices:
        typer.echo(f"Notice: {notice}", err=True)
    order = request.order or [component.name for component in system.components]
    step = system.step if request.step is None else request.step
    typer.echo(f"{system.name}: {request.algorithm}, order {' > '.join(order)}, step {step:g} s")
    if request.out is not None:
        _require_folder(request.out.parent)
    with _progress() as report, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        options = Options(
            record=request.record,
            strict=request.strict,
            allow_stale_inputs=request.allow_stale_inputs,
            progress=report,
        )
        started = time.perf_counter()
        try:
            result = simulate(
                system, request.stop, request.step, request.algorithm, order=request.order, options=options
            )
        except SimulationError as error:
            _keep_partial(error, request.out)
            raise
        except KeyboardInterrupt:
            typer.echo("Interrupted: the run was stopped and nothing is written.", err=True)
            raise typer.Exit(INTERRUPTED) from None
        elapsed = time.perf_counter() - started
    for warning in caught:
        typer.echo(f"Warning: {warning.message}", err=True)
    if request.out is None:
        _print_summary(result)
    else:
        result.write_csv(request.out)
        typer.echo(f"wrote {request.out}: {len(result.time)} rows, {len(result.names)} columns")
    typer.echo(f"{len(result.time) - 1} steps in {elapsed:.2f} s")


def _require_folder(folder: Path) -> None:
    """Make a folder, and refuse one that cannot be written to before the work is done."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        msg = f"--out: nothing can be written to {folder}: {error.strerror}; choose another place."
        raise OrchestrationError(msg) from error


def _system(request: RunRequest) -> System:
    if request.out is not None and request.out.suffix != ".csv":
        msg = f"{request.out}: results are written as .csv."
        raise SystemDescriptionError(msg)
    if request.out is not None and request.out.is_dir():
        msg = f"{request.out} is a folder; a file for the result is needed."
        raise SystemDescriptionError(msg)
    if request.step is not None and request.sample_time is not None:
        msg = "--step and --sample-time exclude each other: the latter sets the step too."
        raise SystemDescriptionError(msg)
    if request.system.endswith(".ssp"):
        system = System.read(request.system)
    else:
        from orchestration.paper.provide import fmus, scenario

        chosen = scenario(request.system)
        system = chosen.system(fmus(chosen.units.values()))
    if request.controller is not None:
        system = system.replace("controller", request.controller)
    system = system.set(dict(_setting(text) for text in request.settings))
    if request.sample_time is not None:
        system = system.with_sample_time(request.sample_time)
    return system


def _setting(text: str) -> tuple[str, str]:
    match = _SETTING.fullmatch(text)
    if match is None:
        msg = f"--set {text}: COMPONENT.VARIABLE=VALUE is needed, such as controller.K[1]=4000."
        raise SystemDescriptionError(msg)
    return match[1], match[2]


@contextmanager
def _progress() -> Iterator[Report]:
    """A progress bar that appears on a terminal when a run takes longer than a second."""
    bar = Progress(TextColumn("running"), BarColumn(), TimeRemainingColumn(), console=errors, transient=True)
    started = time.perf_counter()
    task = bar.add_task("run")

    def report(done: int, total: int) -> None:
        if errors.is_terminal and time.perf_counter() - started > PROGRESS_AFTER:
            bar.start()
            bar.update(task, completed=done, total=total)

    try:
        yield report
    finally:
        if bar.live.is_started:  # else it would print an empty line
            bar.stop()


def _keep_partial(error: SimulationError, out: Path | None) -> None:
    if out is not None and error.result is not None:
        partial = out.with_name(f"{out.stem}.partial.csv")
        error.result.write_csv(partial)
        typer.echo(f"wrote {partial}: the {len(error.result.time)} rows before the failure", err=True)


def _print_summary(result: Result) -> None:
    widest = max((len(name) for name in result.names), default=0)
    table = Table(Column("signal", min_width=widest), "unit", "min", "max", "final", show_edge=False)
    for name in result.names:
        column = result[name]
        numbers = (f"{value:.6g}" for value in (column.min(), column.max(), column[-1]))
        table.add_row(name, result.units.get(name, ""), *numbers)
    console.print(table)
