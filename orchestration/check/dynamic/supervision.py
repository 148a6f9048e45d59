"""Supervises the child processes that run the experiments of a check, and turns their deaths into findings.

A crash, a hang or an exit of a child process is a finding about the experiment under way. A new process goes on
with the next experiment.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.check.dynamic.experiments import BASE, MANY_LIVES, chosen
from orchestration.check.findings import Finding, Severity, error, shown, warning
from orchestration.check.static.archive_rules import Package
from orchestration.check.static.binary_rules import host_library
from orchestration.errors import ArchiveError
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.fmi.library import needed_to_run
from orchestration.sandbox.archive import unpack
from orchestration.sandbox.process import Ending, work

TIMEOUT = 10.0  # s that an experiment may take
LAST_OF_BASE = list(BASE)[-1]
JOB = "orchestration.check.dynamic.job:run_experiments"
MOST_MEMORY = 8 * 1024**3  # bytes of addresses
MOST_DEATHS = 4  # workers that may die before the rest is given up
USUAL_STEP = 1e-3  # s, where the description proposes none
RULES = {
    "": "8",
    "loading": "8",
    "instantiation": "9",
    "wrong GUID": "9",
    "unknown reference": "10",
    "termination": "10",
    "setting an output": "12",
    "setting a fixed parameter": "12",
    **dict.fromkeys(("repetition", "reset", "rollback", "serialization", "torn state"), "13"),
    **dict.fromkeys(("split steps", "two instances", MANY_LIVES), "14"),
    "derivatives": "16",
}
OTHER_RULE = "11"
# Mistakes of a host: one that makes none never meets the crash. NaN as input comes from a neighbour that diverges.
MISTAKES = (
    "wrong GUID",
    "torn state",
    "unknown reference",
    "negative step",
    "step of NaN",
    "setting an output",
    "setting a fixed parameter",
)


@dataclass
class Outcome:
    """What the experiments with an FMU found, in all their processes.

    Attributes
    ----------
    usable
        Whether the FMU loads, initializes and steps.
    deaths
        Number of processes that died.
    printed
        The beginning of what a process wrote to its standard output.
    """

    findings: list[Finding] = field(default_factory=list)
    facts: list[str] = field(default_factory=list)
    usable: bool = False
    deaths: int = 0
    printed: str = ""


def experiment_on(package: Package, timeout: float = TIMEOUT) -> Outcome:
    """Run every experiment that the FMU's capabilities ask for.

    Experiments that make mistakes on purpose run last and in other processes, because an FMU that a mistake has
    damaged may crash much later, in a call that is right.
    """
    outcome, untried = Outcome(), list[str]()
    names = chosen(package.document.flag)
    with temporary_folder() as folder:
        try:
            unpack(package.path, folder / "fmu", needed_to_run)
        except (ArchiveError, OSError) as failed:
            outcome.findings.append(error("7", f"The archive cannot be unpacked: {shown(failed)}."))
            return outcome
        plan = _plan(package, folder / "fmu") | {"random": False}
        for mistakes in (False, True):
            if outcome.usable or not mistakes:
                left = [name for name in names if (name in MISTAKES) == mistakes]
                untried += _work_off(left, plan, folder, timeout, outcome)
    if untried:
        outcome.facts.append(f"Not tried after {outcome.deaths} dead processes: {', '.join(untried)}.")
    if outcome.printed:
        message = f'The binary writes to standard output: "{outcome.printed}"; there is a logger for that.'
        outcome.findings.append(warning("9", message))
    return outcome


def _work_off(left: list[str], plan: dict[str, Any], folder: Path, timeout: float, outcome: Outcome) -> list[str]:
    """Run experiments, after each death in a new process; returns the experiments that were given up."""
    while left and outcome.deaths < MOST_DEATHS:
        ending = work(JOB, {**plan, "experiments": left}, folder, timeout=timeout, memory=MOST_MEMORY)
        outcome.printed = outcome.printed or shown(ending.printed)
        plan |= _known(ending.lines)
        under_way = _read(ending, outcome)
        outcome.usable = outcome.usable or any(line.get("end") == LAST_OF_BASE for line in ending.lines)
        outcome.deaths += bool(ending.how)
        goes_on = ending.how and outcome.usable and under_way in left
        left = left[left.index(under_way) + 1 :] if goes_on else []
    return left


def step_of(package: Package) -> float:
    """Return a step for experiments, s: the proposed one, a sampling period, or a thousandth of the run."""
    document = package.document
    periods = [v.number for v in document.variables if v.name == SAMPLE_TIME and v.type == "Real"]
    candidates = [document.experiment("stepSize"), *periods]
    return next((step for step in candidates if step is not None and 0 < step < float("inf")), USUAL_STEP)


def _plan(package: Package, folder: Path) -> dict[str, Any]:
    """Return the facts about the FMU that a child process needs."""
    document = package.document
    outputs = document.of_causality("output")
    sampled = bool(outputs) and all(v.variability == "discrete" for v in outputs)
    return {
        "library": str(folder / (host_library(package) or "")),
        "guid": document.guid,
        "resources": (folder / "resources").as_uri(),
        "start_time": document.experiment("startTime") or 0.0,
        "step": step_of(package),
        "sampled": sampled or any(v.name == SAMPLE_TIME for v in document.of_causality("parameter")),
        "exports_known": host_library(package) is not None and str(host_library(package)).endswith(".so"),
        "variables": [
            {
                "name": v.name,
                "reference": v.reference,
                "type": v.type,
                "causality": v.causality,
                "variability": v.variability,
                "start": v.number,
                "limits": v.limits,
            }
            for v in document.variables
        ],
    }


def _known(lines: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Return what earlier experiments left for later ones."""
    known: dict[str, Any] = {}
    for line in lines:
        known |= line.get("known", {})
    return known


def _read(ending: Ending, outcome: Outcome) -> str:
    """Collect what a process wrote; returns the experiment under way at its end, empty if all were done."""
    under_way = ""
    for line in ending.lines:
        under_way = line.get("begin", "" if "end" in line else under_way)
        outcome.findings += _findings(line, under_way)
        outcome.facts += [line["fact"]] if "fact" in line else []
    if ending.how:
        severity = Severity.WARNING if under_way in MISTAKES else Severity.ERROR
        outcome.findings.append(Finding(RULES.get(under_way, OTHER_RULE), severity, _obituary(ending, under_way)))
    return under_way


def _findings(line: Mapping[str, Any], under_way: str) -> Iterator[Finding]:
    if "finding" in line:
        rule, severity, message = line["finding"]
        yield Finding(rule, Severity(severity), message)
    if "refused" in line:
        yield error(RULES.get(under_way, OTHER_RULE), f"{under_way.capitalize()}: {line['refused']}")
    if "missing" in line and under_way != "loading":
        yield error("8", f"{under_way.capitalize()} cannot be tried: the library does not export {line['missing']}.")


def _obituary(ending: Ending, under_way: str) -> str:
    what = shown(ending.function) or "the binary"
    during = f" during the experiment {under_way!r}" if under_way else ""
    return f"{what} {ending.how}{during}."
