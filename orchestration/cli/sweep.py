"""Runs a study and prints what came out, and where: ``adaptimp sweep``."""

import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestration.analysis.doctor.finding import counted
from orchestration.campaigns.execution.progress import Goal, ProgressBar, Tally
from orchestration.campaigns.table import MISSING
from orchestration.cli.codes import ExitCode
from orchestration.cli.isolation import EVERY
from orchestration.cli.listing import list_ready
from orchestration.cli.output import output, watched, width
from orchestration.cli.places import require_folder, written
from orchestration.cli.sweep_options import sweep_request
from orchestration.cli.sweep_pictures import draw
from orchestration.cli.sweep_plan import tell_plan
from orchestration.cli.sweep_report import SweepReport
from orchestration.cli.sweep_request import SweepRequest
from orchestration.cli.sweep_table import frame_of, require_file, write_table
from orchestration.errors import OrchestrationError, StudyInterrupted
from orchestration.results.places import partial_path

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from rich.console import Console

    from orchestration.campaigns.study import Study
    from orchestration.master.progress import ProgressLine


def run_sweep(system: str | None, given: Mapping[str, Any]) -> int:
    """Make the runs that a command asks for, and print what came out; returns the exit code.

    Parameters
    ----------
    system, given
        As of `sweep_request`.
    """
    output.data_only = bool(given["json"])
    if given["ready"] == EVERY:
        list_ready(json=output.data_only)
        return ExitCode.SUCCESS
    report = SweepReport(system or "", given["algorithm"] or "")
    try:
        request = sweep_request(system, given)
        report.system, report.algorithm = request.name, request.algorithm
        request.require_sense()
        require_file(request.out)
        with watched() as line:
            _run(request, report, line)
    except (OrchestrationError, OSError, KeyboardInterrupt) as error:
        report.ended_by(error)
        if output.data_only:
            output.data(report.json())
        raise
    if output.data_only:
        output.data(report.json())
    return report.exit_code


def _run(request: SweepRequest, report: SweepReport, line: "ProgressLine") -> None:
    """Make the study and its runs, and write the table and the pictures."""
    goal = None if request.best is None else Goal.of(request.best)
    study = request.study()
    for notice in (notice for system in study.systems.values() for notice in system.notices):
        output.remark(f"Notice: {notice}")
    report.algorithm, report.store = study.algorithm, request.store
    if goal is not None:
        goal.place(tuple(study.units))
    if request.dry_run:
        tell_plan(study, report, request.workers)
        return
    for folder in _folders(request):
        require_folder(folder)
    existed = request.out is not None and request.out.exists()
    line.begin("preparing the runs")
    table = _table(study, request, report, Tally(goal) if output.quiet else RunBar(goal, line))
    line.end()
    report.take(frame_of(table), tuple(study.points.columns), study.units)
    _tell(report)
    if request.out is not None:
        write_table(table, request.out)
        report.file = request.out
        output.say(f"{written(request.out, existed=existed)}: {counted(report.runs, 'row')}")
    if request.plot is not None:
        line.begin("drawing pictures")
        report.pictures = draw(table, request.plot)
        line.end()
        output.say(f"{counted(len(report.pictures), 'file')} with pictures in {request.plot}")


class RunBar(ProgressBar):
    """Shows the count of runs in the place of what was shown before.

    Parameters
    ----------
    goal, console
        As of `ProgressBar`.
    line
        What shows other things; it is hidden while runs are counted on a terminal.
    """

    def __init__(self, goal: Goal | None, line: "ProgressLine", console: "Console | None" = None) -> None:
        super().__init__(goal, console)
        self._line = line

    def show(self) -> bool:
        """Show the count from now on, if there is a terminal."""
        self._line.end()
        self._line.hidden = super().show()
        return self._line.hidden

    def end(self) -> None:
        """Clear the count."""
        super().end()
        self._line.hidden = False


def _folders(request: SweepRequest) -> Iterator[Path]:
    """Folders that files are written to."""
    if request.out is not None:
        yield request.out.parent
    if request.plot is not None:
        yield request.plot


def _table(study: "Study", request: SweepRequest, report: SweepReport, tally: Tally) -> "xr.Dataset | pd.DataFrame":
    """Make the runs; if that is interrupted, say how to go on."""
    try:
        return study.run(
            workers=request.workers,
            store=request.store,
            cluster=request.cluster,
            progress=tally,
            retry_failed=request.retry_failed,
        )
    except StudyInterrupted as interrupt:
        output.remark(f"Interrupted: {_goes_on(tally, request)}")
        if request.out is not None and request.store is None:
            _rescue(interrupt.table, request.out, report)
        raise
    finally:
        report.from_store, report.seconds, report.rate = tally.kept, tally.seconds, tally.rate
        report.runs, report.failed, report.complete = tally.total, tally.failed, tally.done - tally.failed


def _goes_on(tally: Tally, request: SweepRequest) -> str:
    """How far an interrupted campaign came, and how to go on."""
    done = f"{tally.done} of {counted(tally.total, 'run')}"
    if request.store is None:
        return f"{done} were made, and no store keeps them; --store FOLDER does."
    again = shlex.join(["adaptimp", "sweep", "--resume", str(request.store)])
    return f"{done} are in {request.store}; go on with: {again}"


def _rescue(table: "xr.Dataset | pd.DataFrame", out: Path, report: SweepReport) -> None:
    """Write the rows of a campaign that was interrupted beside the file for the whole table."""
    frame, file = frame_of(table), partial_path(out)
    existed = file.exists()
    made = frame.query(f"status != '{MISSING}'")
    write_table(made, file)
    report.file = file
    output.remark(f"{written(file, existed=existed)}: the {len(made)} rows before that")


def _tell(report: SweepReport) -> None:
    """Say what came out: counts and extremes as results, failures as remarks."""
    counts, *failures = report.sentences()
    output.say(f"{report.system}: {counts}")
    for sentence in failures:
        output.remark(sentence)
    if not output.data_only:
        output.say(report.table(width()))
