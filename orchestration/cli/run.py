"""Runs a system and prints or writes what it did: ``adaptimp run``."""

import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from orchestration.cli.algorithms import AlgorithmRequest
from orchestration.cli.assumptions import print_assumptions
from orchestration.cli.isolation import isolation_of
from orchestration.cli.output import output, watched, width
from orchestration.cli.outside import OutsideRequest
from orchestration.cli.pictures import PictureRequest
from orchestration.cli.report import RunReport
from orchestration.cli.rows import Destination
from orchestration.cli.settings import listed, numbers, start_value
from orchestration.cli.signals import signal_record, signal_table
from orchestration.cli.systems import SystemRequest
from orchestration.errors import (
    OrchestrationError,
    RecordedRows,
    RunInterrupted,
    SimulationError,
    SystemDescriptionError,
    printable,
)
from orchestration.fmi.codes import NEEDS_TOOL
from orchestration.master.capabilities import check_tolerances
from orchestration.master.options import Crossings
from orchestration.master.progress import RUNNING, ProgressLine
from orchestration.master.simulate import Options, prepare
from orchestration.master.simulation import Simulation
from orchestration.paper.run_numbers import columns_to_read, run_numbers, sentences
from orchestration.results.columns import ENDED
from orchestration.results.result import Result
from orchestration.results.row_hash import row_hash
from orchestration.results.some_columns import read_some_columns
from orchestration.system.system import System

LONG_COMPILATION = 1.0  # s, from which on it is said
MOST_MEASURED = 1_000_000  # rows; the numbers of more rows would take a noticeable part of the run
MOST_NAMED = 20  # components whose order is told whole


@dataclass(frozen=True)
class RunRequest:
    """Options of ``adaptimp run``; times in s."""

    asked: SystemRequest
    algorithm: AlgorithmRequest = field(default_factory=lambda: AlgorithmRequest("gauss-seidel"))
    crossings: Sequence[str] = ()
    ratios: Sequence[str] = ()
    order: Sequence[str] | None = None
    step: float | None = None
    start: float | None = None
    stop: float | None = None
    out: Path | None = None
    record: Sequence[str] | None = None
    every: int = 1
    verdict: bool = True
    strict: bool = False
    assumptions: bool = False
    allow_stale_inputs: bool = False
    allow_nan: bool = False
    fmu_tolerance: float | None = None
    fmu_stop_time: bool = True
    json: bool = False
    hash: bool = False
    isolate: Sequence[str] = ()
    outside: OutsideRequest = field(default_factory=OutsideRequest)
    picture: PictureRequest = field(default_factory=PictureRequest)


def run_system(request: RunRequest) -> None:
    """Run a system as the request says; a run that fails half-way still writes its complete rows."""
    output.data_only = request.json
    report = RunReport(request.asked.name, request.algorithm.name)
    try:
        with watched() as line, _told(report):
            destination = Destination.of(request.out)
            request.picture.require()
            simulation = _prepared(request, report, line)
            if simulation is None:
                return
            destination.make_folder()
            request.picture.make_folder()
            if destination.streamed is not None:
                simulation.stream_to(destination.streamed)
            result = _run(simulation, destination, report, line, judged=request.verdict)
            _evaluate(result, destination, report, request, simulation.system)
    except (OrchestrationError, OSError, KeyboardInterrupt) as error:
        report.ended_by(error)
        if request.json:
            output.data(report.json())
        raise
    if request.json:
        output.data(report.json())
    elif request.out is None and report.extremes is not None:
        output.say(signal_table(signal_record(report.extremes), width()))
    for sentence in sentences(report.numbers):
        output.say(sentence)
    if request.hash:
        output.say(f"SHA-256 of the rows: {report.row_hash}")
    output.say(_duration(report))


def _evaluate(result: Result, destination: Destination, report: RunReport, request: RunRequest, system: System) -> None:
    """Compute the numbers of the run, and draw its picture; rows that were streamed are read from their file."""
    picture = request.picture
    if destination.streamed is not None and (picture.path is not None or request.hash):
        result = Result.read(destination.streamed)
    elif destination.streamed is not None and report.rows <= MOST_MEASURED:
        result = read_some_columns(destination.streamed, columns_to_read())
    if report.rows <= MOST_MEASURED:
        report.numbers = run_numbers(result)
    if request.hash or (request.json and destination.streamed is None):
        report.row_hash = row_hash(result)
    picture.draw({report.system: result}, {report.system: system})


def _prepared(request: RunRequest, report: RunReport, line: ProgressLine) -> Simulation | None:
    """Prepare the run; None if only the assumptions are asked for."""
    if request.step is not None and request.asked.sample_time is not None:
        msg = "--step and --sample-time exclude each other: the latter sets the step too."
        raise SystemDescriptionError(msg)
    system, algorithm = request.asked.system(), request.algorithm.algorithm()
    report.system, report.algorithm = system.name, algorithm.name
    report.notices = [*system.notices, *_tools_needed(system)]
    for notice in report.notices:
        output.remark(f"Notice: {notice}")
    if request.assumptions:
        print_assumptions(system, json=request.json)
        return None
    if request.order is not None:
        system = system.ordered(request.order)
    check_tolerances(system, algorithm)
    report.step, report.order = system.run_step(request.step), [component.name for component in system.components]
    order = _ordered(report.order)
    output.say(printable(f"{system.name}: {algorithm.name}, order {order}, step {report.step:g} s"))
    simulation = prepare(system, request.stop, report.step, algorithm, options=_options(request, system, line))
    report.start_time, report.stop_time = (float(simulation.grid.times[i]) for i in (0, -1))
    return simulation


def _tools_needed(system: System) -> list[str]:
    """A notice on each component whose FMU says that it needs the tool that exported it."""
    needing = [component for component in system.components if component.description.can(NEEDS_TOOL)]
    said = "so it runs only where the tool that exported it is installed."
    return [f"{c.description.path.name} of {c.name} declares {NEEDS_TOOL}, {said}" for c in needing]


def _ordered(names: Sequence[str]) -> str:
    """The order of stepping; of very many components the first and the last."""
    shown = names if len(names) <= MOST_NAMED else [*names[: MOST_NAMED // 2], "...", names[-1]]
    return " > ".join(shown) + (f" ({len(names)} components)" if len(shown) < len(names) else "")


def _options(request: RunRequest, system: System, line: ProgressLine) -> Options:
    return Options(
        record=listed(request.record, system),
        every=request.every,
        start_time=request.start,
        strict=request.strict,
        allow_stale_inputs=request.allow_stale_inputs,
        allow_nan=request.allow_nan,
        fmu_tolerance=request.fmu_tolerance,
        fmu_stop_time=request.fmu_stop_time,
        ratios=numbers("--ratio", request.ratios, int),
        crossings=Crossings(request.crossings),
        progress=line.steps,
        isolate=isolation_of(request.isolate),
        **request.outside.options(lambda text: start_value(text, system)),
    )


def _run(
    simulation: Simulation, destination: Destination, report: RunReport, line: ProgressLine, *, judged: bool
) -> Result:
    """Make the steps, and write the rows before the FMUs are called for the last time: they may crash then.

    Returns the rows; those that were streamed are in their file only.
    """
    saved = False
    try:
        with simulation:
            report.compile_seconds = simulation.compile_seconds
            if judged:
                line.begin("judging the stability of the algorithm")
                _judge(simulation, report)
            result = _stepped(simulation, report, line)
            _tell_messages(result, report)
            if result.status == ENDED:
                report.status, report.message = result.status, result.message
                output.remark(f"Notice: {result.message}")
            line.begin("writing the rows")
            simulation.complete()
            destination.complete(result, report)
            saved = True
    except SimulationError as error:
        _tell_messages(error.result, report)
        if not saved:
            destination.partial(error.result, report, "before the failure")
        raise
    except RunInterrupted as interrupt:
        line.end()
        output.remark("Interrupted: the run was stopped.")
        destination.partial(interrupt.result, report, "before that")
        raise
    return result


def _tell_messages(result: RecordedRows | None, report: RunReport) -> None:
    """Keep in the report what the FMUs logged, and say it if asked for."""
    report.messages = result.messages if isinstance(result, Result) else ()
    for text in report.messages if output.verbose else ():
        output.remark(text)


def _stepped(simulation: Simulation, report: RunReport, line: ProgressLine) -> Result:
    """The rows of all steps; the report says how far the run came, also where it fails."""
    line.begin(RUNNING)
    started = time.perf_counter()
    try:
        simulation.run()
    finally:
        report.stepping_seconds = time.perf_counter() - started
        report.time, report.steps, report.rows = simulation.time, simulation.steps_made, simulation.count
        line.end()
    return simulation.result()


def _judge(simulation: Simulation, report: RunReport) -> None:
    """Warn if the algorithm is unstable at the start; a system that cannot be judged in short time is run anyway."""
    prediction = simulation.predict()
    if prediction.stable is None:
        report.notices.append(prediction.text)
        output.remark(f"Notice: {prediction.text}")
    elif not prediction.stable:
        report.warnings.append(prediction.text)
        output.remark(f"Warning: {prediction.text}")


@contextmanager
def _told(report: RunReport) -> Iterator[None]:
    """Say the warnings of Python as sentences, and keep them in the report."""

    def tell(message: Warning | str, *_: object, **__: object) -> None:
        report.warnings.append(str(message))
        output.remark(f"Warning: {message}")

    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = tell
        yield


def _duration(report: RunReport) -> str:
    seconds = report.stepping_seconds
    said = f"{report.steps} steps in {f'{seconds:.2f}' if seconds >= 1 else f'{seconds:.3g}'} s"
    if report.compile_seconds > LONG_COMPILATION:
        said += f", after {report.compile_seconds:.1f} s of compiling or loading the master's loop"
    return said
