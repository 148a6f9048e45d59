"""Examines a co-simulation and prints what was found: ``adaptimp doctor``.

Exit codes: 0 nothing worse than notes, 1 warnings or errors were found, 2 the system cannot be examined.
"""

import json
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from textwrap import wrap

from orchestration.analysis.doctor.case import Case
from orchestration.analysis.doctor.diagnose import BUDGET, diagnose
from orchestration.analysis.doctor.diagnosis import Diagnosis
from orchestration.analysis.doctor.finding import Finding
from orchestration.analysis.doctor.study import Kind
from orchestration.cli.algorithms import AlgorithmRequest
from orchestration.cli.codes import ExitCode, exit_code_of
from orchestration.cli.isolation import EVERY, ISOLATE, isolation_of
from orchestration.cli.output import output, watched, width
from orchestration.cli.systems import SystemRequest
from orchestration.cli.tables import table
from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.master.algorithm import ALGORITHMS, Algorithm
from orchestration.system.system import System

MOST_SIGNALS = 6  # rows of the table of errors
INDENT = "    "


@dataclass(frozen=True)
class DoctorRequest:
    """Options of ``adaptimp doctor``; times in s."""

    asked: SystemRequest
    algorithm: AlgorithmRequest = field(default_factory=lambda: AlgorithmRequest("gauss-seidel"))
    order: Sequence[str] | None = None
    step: float | None = None
    stop: float | None = None
    budget: float = BUDGET
    isolate: Sequence[str] = ()
    json: bool = False


def run_doctor(request: DoctorRequest) -> int:
    """Examine a system as the request says, and print the findings; returns the exit code."""
    output.data_only = request.json
    try:
        if request.step is not None and request.asked.sample_time is not None:
            msg = "--step and --sample-time exclude each other: the latter sets the step too."
            raise SystemDescriptionError(msg)
        with watched():
            system = request.asked.system()
            found = diagnose(
                system,
                request.stop,
                request.step,
                request.algorithm.algorithm(),
                order=request.order,
                budget=request.budget,
                isolate=isolation_of(request.isolate),
                spell=_Shell(request, system).command,
            )
    except (OrchestrationError, OSError) as error:
        if request.json:
            output.data(_json({"system": request.asked.name, "error": str(error)}, exit_code_of(error)))
        raise
    code = ExitCode.SUCCESS if found.healthy else ExitCode.FAILED
    if request.json:
        output.data(_json(found.as_dict(), code))
    else:
        _print(found)
    return code


def _json(content: dict[str, object], code: ExitCode) -> str:
    about = {"version": version("adaptimp")}
    return json.dumps({**about, **content, "exit_code": int(code)}, indent=2, allow_nan=False)


def _print(found: Diagnosis) -> None:
    columns = width()
    for finding in found.findings:
        output.say("\n".join(_lines(finding, columns)) + "\n")
    errors = [signal for signal in found.signals if signal.kind is not Kind.EXACT][:MOST_SIGNALS]
    if errors:
        rows = [
            (s.name, "none" if s.order is None else f"{s.order:.1f}", f"{s.error:.2g}", s.unit, f"{s.relative:.1e}")
            for s in errors
        ]
        head = ("signal", "order", "error", "unit", "of range")
        output.say(table(head, rows, columns, numbers=("order", "error", "of range")) + "\n")
    what = f"{found.system}, {found.algorithm}, step {found.step:g} s, until {found.stop_time:g} s"
    output.say("\n".join(_folded(f"{what}: {found.counts}", columns, "", INDENT)))


def _lines(finding: Finding, columns: int) -> list[str]:
    """A finding as lines: what it is about, what was found, what to do; a command is never folded."""
    lines = _folded(f"{finding.severity.upper()} {finding.id}: {finding.subject}", columns, "", INDENT)
    lines += _folded(finding.sentence, columns, INDENT, INDENT)
    if finding.advice:
        lines += _folded(finding.advice, columns, f"{INDENT}> ", f"{INDENT}  ")
    return [*lines, f"{INDENT}$ {finding.command}"] if finding.command else lines


def _folded(text: str, columns: int, first: str, later: str) -> list[str]:
    return wrap(
        text,
        columns,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )


@dataclass(frozen=True)
class _Shell:
    """Spells a changed case as a command of the shell.

    Attributes
    ----------
    system
        System that the request names, before any change.
    """

    request: DoctorRequest
    system: System

    def command(self, case: Case) -> str:
        """The command that runs a case."""
        asked = self.request.asked
        words = ["adaptimp", "run", asked.name]
        if asked.variant is not None:
            words += ["--variant", asked.variant]
        if asked.controller is not None:
            words += ["--controller", asked.controller]
        words += [word for text in asked.mapping for word in ("--map", text)]
        values = [*asked.settings, *(f"{path}={value:.12g}" for path, value in case.values.items())]
        period = asked.sample_time if case.sample_time is None else case.sample_time
        if period is not None and case.step != period:
            values += [f"{name}.{SAMPLE_TIME}={period:.12g}" for name in self.system.sample_times]
        words += [word for text in values for word in ("--set", text)]
        words += self._algorithm(case.algorithm)
        order = self.request.order if case.order is None else case.order
        if order is not None:
            words += ["--order", ",".join(order)]
        if period is not None and case.step == period:
            words += ["--sample-time", f"{period:.12g}"]
        elif case.step != self.system.step:
            words += ["--step", f"{case.step:.12g}"]
        if case.stop_time != self.system.stop_time:
            words += ["--stop", f"{case.stop_time:.12g}"]
        for names in self.request.isolate:
            words += [ISOLATE] if names == EVERY else [ISOLATE, names]
        return shlex.join(words)

    def _algorithm(self, algorithm: Algorithm) -> list[str]:
        """Options that ask for an algorithm."""
        asked = self.request.algorithm
        if algorithm == asked.algorithm():
            wanted = {"algorithm": asked.name, "exchange": asked.exchange, "input-order": asked.order}
        else:
            known = ALGORITHMS[algorithm.name]
            wanted = {
                "algorithm": algorithm.name,
                "exchange": algorithm.exchange if algorithm.exchange != known.exchange else None,
                "input-order": algorithm.order if algorithm.order != known.order else None,
            }
        given = [(name, value) for name, value in wanted.items() if value not in (None, "gauss-seidel")]
        return [word for name, value in given for word in (f"--{name}", str(value))]
