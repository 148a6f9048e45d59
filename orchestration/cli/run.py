"""Runs a system and prints or writes what it did: ``adaptimp run``."""

import re
import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Column, Table

from orchestration.cli.assumptions import print_assumptions
from orchestration.cli.codes import INTERRUPTED
from orchestration.cli.commands import console, errors, require_folder, setting_of
from orchestration.cli.outside import OutsideRequest
from orchestration.errors import (
    OrchestrationError,
    RecordedRows,
    RunInterrupted,
    SimulationError,
    SystemDescriptionError,
)
from orchestration.master.algorithm import Algorithm, Tolerance, find_algorithm
from orchestration.master.capabilities import check_tolerances
from orchestration.master.options import Crossings
from orchestration.master.options import Progress as Report
from orchestration.master.simulate import Options, prepare
from orchestration.results.result import Result
from orchestration.system.system import System

PROGRESS_AFTER = 1.0  # s
FORMATS = (".csv", ".parquet")
T = TypeVar("T", int, float)
_SETTING = re.compile(r"([^=\s]+)=(.*)", re.DOTALL)
_COMMA = re.compile(r",(?![^\[]*\])")  # a comma within brackets is part of a name


@dataclass(frozen=True)
class AlgorithmRequest:
    """A co-simulation algorithm by name, with options that replace its own."""

    name: str
    exchange: str | None = None
    order: int | None = None
    tolerance: float | None = None
    absolute: Sequence[str] = ()

    def algorithm(self) -> Algorithm:
        """Make the requested algorithm.

        Raises
        ------
        SystemDescriptionError
            If there is no such choice, or the algorithm has no tolerance.
        """
        found = find_algorithm(self.name)
        changes = {"exchange": self.exchange, "order": self.order}
        found = replace(found, **{name: value for name, value in changes.items() if value is not None})
        if self.tolerance is None and not self.absolute:
            return found
        given = found.control or found.correction
        if given is None:
            msg = f"Algorithm {self.name} has no tolerance; iterative, newton and adaptive have."
            raise SystemDescriptionError(msg)
        absolute = {
            unit: _number("--absolute", text, float) for unit, text in map(setting_of("--absolute"), self.absolute)
        }
        tolerance = Tolerance(given.tolerance.relative if self.tolerance is None else self.tolerance, absolute)
        changed = replace(given, tolerance=tolerance)
        return replace(found, control=changed) if found.control else replace(found, correction=changed)


@dataclass(frozen=True)
class RunRequest:
    """Options of ``adaptimp run``; times in s."""

    system: str
    controller: str | None
    mapping: Sequence[str]
    settings: Sequence[str]
    algorithm: AlgorithmRequest
    crossings: Sequence[str]
    ratios: Sequence[str]
    order: Sequence[str] | None
    step: float | None
    sample_time: float | None
    stop: float | None
    out: Path | None
    record: Sequence[str] | None
    every: int
    verdict: bool
    strict: bool
    assumptions: bool
    allow_stale_inputs: bool
    outside: OutsideRequest


def run_system(request: RunRequest) -> None:
    """Run a system as the request says; a run that fails half-way still writes its complete rows."""
    _check_output(request.out)
    system, algorithm = _system(request), request.algorithm.algorithm()
    for notice in system.notices:
        typer.echo(f"Notice: {notice}", err=True)
    if request.assumptions:
        print_assumptions(system)
        return
    if request.order is not None:
        system = system.ordered(request.order)
    check_tolerances(system, algorithm)
    step = system.run_step(request.step)
    order = " > ".join(component.name for component in system.components)
    typer.echo(f"{system.name}: {algorithm.name}, order {order}, step {step:g} s")
    if request.out is not None:
        require_folder(request.out.parent)
    with _progress() as report, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        simulation = prepare(system, request.stop, step, algorithm, options=_options(request, report))
        if request.verdict:
            _warn(system.set(simulation.first_inputs), step, algorithm)
        streamed = request.out if request.out is not None and request.out.suffix == ".parquet" else None
        if streamed is not None:
            simulation.stream_to(streamed)
        started = time.perf_counter()
        try:
            with simulation:
                simulation.run()
                result = simulation.result()
        except SimulationError as error:
            _keep_partial(error.result, request.out, "before the failure")
            raise
        except RunInterrupted as interrupt:
            typer.echo("Interrupted: the run was stopped.", err=True)
            _keep_partial(interrupt.result, request.out, "before that")
            raise typer.Exit(INTERRUPTED) from None
        elapsed = time.perf_counter() - started
    for warning in caught:
        typer.echo(f"Warning: {warning.message}", err=True)
    if request.out is None:
        _print_summary(result)
    else:
        if streamed is None:
            result.write(request.out)
        typer.echo(f"wrote {request.out}: {simulation.count} rows, {len(result.names)} columns")
    typer.echo(f"{simulation.steps_made} steps in {elapsed:.2f} s")


def _options(request: RunRequest, report: Report) -> Options:
    ratios = {name: _number("--ratio", text, int) for name, text in map(setting_of("--ratio"), request.ratios)}
    return Options(
        record=request.record,
        every=request.every,
        strict=request.strict,
        allow_stale_inputs=request.allow_stale_inputs,
        ratios=ratios,
        crossings=Crossings(request.crossings),
        progress=report,
        **request.outside.options(_setting),
    )


def _check_output(out: Path | None) -> None:
    if out is not None and out.suffix not in FORMATS:
        msg = f"{out}: results are written as {' or '.join(FORMATS)}."
        raise SystemDescriptionError(msg)
    if out is not None and out.is_dir():
        msg = f"{out} is a folder; a file for the result is needed."
        raise SystemDescriptionError(msg)


def _warn(system: System, step: float, algorithm: Algorithm) -> None:
    """Print a warning if the algorithm is unstable at the start; a system that cannot be judged is run anyway."""
    from orchestration.analysis.stability.verdict import is_stable, stability

    try:
        if not is_stable(system, step, algorithm):
            typer.echo(f"Warning: {stability(system, step, algorithm)}", err=True)
    except OrchestrationError as error:
        typer.echo(f"Notice: no verdict on stability: {error}", err=True)


def _system(request: RunRequest) -> System:
    if request.step is not None and request.sample_time is not None:
        msg = "--step and --sample-time exclude each other: the latter sets the step too."
        raise SystemDescriptionError(msg)
    system = _named(request.system)
    if request.controller is not None:
        mapping = dict(map(setting_of("--map"), request.mapping))
        system = system.replace("controller", _controller(request.controller), mapping)
    elif request.mapping:
        msg = "--map says what --controller calls our variables; give one."
        raise SystemDescriptionError(msg)
    system = system.set(dict(_setting(text) for text in request.settings))
    if request.sample_time is not None:
        system = system.with_sample_time(request.sample_time)
    return system


def _named(name: str) -> System:
    """The system of a file, or a scenario by name."""
    path = Path(name)
    if path.suffix.lower() == ".fmu":
        component = path.stem.replace(".", "_")
        return System.of({component: path}, component)
    if path.suffix.lower() == ".ssp":
        return System.read(path)
    from orchestration.paper.ready import scenario

    return scenario(name)


def _controller(name: str) -> Path:
    """The FMU of a file, or a shipped one by its model identifier."""
    from fmus.catalog import MODELS
    from orchestration.paper.built_fmus import built

    return built(name) if name in MODELS and not Path(name).exists() else Path(name)


def recorded(texts: Sequence[str] | None) -> list[str] | None:
    """Names and patterns of ``--record``, which may be given several times with several names each."""
    if not texts:
        return None
    return [name.strip() for text in texts for name in _COMMA.split(text) if name.strip()]


def _setting(text: str) -> tuple[str, str | list[str]]:
    """Name and value of ``--set``; a value in brackets is a list."""
    match = _SETTING.fullmatch(text)
    if match is None:
        msg = f"--set {text}: COMPONENT.VARIABLE=VALUE is needed, such as controller.K[1]=4000."
        raise SystemDescriptionError(msg)
    value = match[2].strip()
    if value.startswith("[") and value.endswith("]"):
        return match[1], [element.strip() for element in value[1:-1].split(",")]
    return match[1], match[2]


def _number(option: str, text: str, kind: type[T]) -> T:
    try:
        return kind(text)
    except ValueError:
        msg = f"{option}: {text!r} is not {'an integer' if kind is int else 'a number'}."
        raise SystemDescriptionError(msg) from None


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


def _keep_partial(result: RecordedRows | None, out: Path | None, when: str) -> None:
    """Write the complete rows of a run that ended early; rows in a Parquet file are already written."""
    if out is None or result is None:
        return
    partial = out.with_name(f"{out.stem}.partial{out.suffix}")
    if out.suffix == ".csv":
        result.write(partial)
        typer.echo(f"wrote {partial}: the {len(result.time)} rows {when}", err=True)
    elif partial.is_file():
        typer.echo(f"wrote {partial}: the rows {when}", err=True)


def _print_summary(result: Result) -> None:
    widest = max((len(name) for name in result.names), default=0)
    table = Table(Column("signal", min_width=widest), "unit", "min", "max", "final", show_edge=False)
    for name in result.names:
        column = result[name]
        numbers = (f"{value:.6g}" for value in (column.min(), column.max(), column[-1]))
        table.add_row(name, result.units.get(name, ""), *numbers)
    console.print(table)
