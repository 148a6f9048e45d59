"""Supervises the child processes that run the experiments of a check, and turns their deaths into findings.

A crash, a hang or an exit of a child process is a finding about the experiment under way. A new process goes on
with the next experiment. An FMU that can be instantiated only once per process gets a process for each experiment.
"""

import os
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.check.dynamic.experiments import BASE, MANY_LIVES, ONLY_ONCE, chosen
from orchestration.check.findings import Finding, Severity, error, listed, note, shown, warning
from orchestration.check.static.archive_rules import LONGEST_MESSAGE, Package
from orchestration.check.static.binary_rules import host_library
from orchestration.errors import ArchiveError
from orchestration.fmi.description import only_discrete, sampling_period
from orchestration.fmi.library import needed_to_run, require_whole
from orchestration.sandbox.archive import unpack
from orchestration.sandbox.leftovers import empty
from orchestration.sandbox.meaning_of_calls import meaning
from orchestration.sandbox.native_library import LibraryError
from orchestration.sandbox.process import Ending, work

TIMEOUT = 30.0  # s that a call may take
TOTAL = 600.0  # s that all experiments may take
LAST_OF_BASE = list(BASE)[-1]
JOB = "orchestration.check.dynamic.job:run_experiments"
MOST_MEMORY, LEAST_MEMORY = 8 * 1024**3, 2 * 1024**3  # bytes of addresses
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
    **dict.fromkeys(("repetition", "first run", "second run", "reset", "rollback", "serialization"), "13"),
    **dict.fromkeys(("early restoring", "torn state"), "13"),
    **dict.fromkeys(("split steps", "two instances", MANY_LIVES), "14"),
    "derivatives": "16",
}
OTHER_RULE = "11"
REACHING_OUT = "18"
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
    out_of_time
        Whether the time of all experiments is over.
    confinement
        Measures that confined the processes; see `orchestration.sandbox.confinement`.
    """

    findings: list[Finding] = field(default_factory=list)
    facts: list[str] = field(default_factory=list)
    usable: bool = False
    deaths: int = 0
    printed: str = ""
    out_of_time: bool = False
    confinement: Sequence[str] = ()


def experiment_on(package: Package, timeout: float = TIMEOUT, total: float = TOTAL) -> Outcome:
    """Run every experiment that the FMU's capabilities ask for.

    Parameters
    ----------
    timeout
        Longest time of a call, s.
    total
        Longest time of all experiments, s.

    Notes
    -----
    Experiments that make mistakes on purpose run last and in other processes, because an FMU that a mistake has
    damaged may crash much later, in a call that is right.
    """
    outcome, untried = Outcome(), list[str]()
    names = chosen(package.document.flag)
    end = time.monotonic() + total
    with temporary_folder() as folder:
        try:
            unpack(package.path, folder / "fmu", needed_to_run)
        except (ArchiveError, OSError) as failed:
            said = str(failed).replace(str(package.path), package.path.name)
            outcome.findings.append(error("7", shown(f"The archive cannot be unpacked: {said}", LONGEST_MESSAGE)))
            return outcome
        try:
            require_whole(folder / "fmu", host_library(package) or "")
        except LibraryError as failed:
            outcome.findings.append(error("8", f"Loading: {shown(failed, LONGEST_MESSAGE)}"))
            return outcome
        plan = _plan(package, folder / "fmu") | {"random": False, "told": []}
        for mistakes in (False, True):
            if outcome.usable or not mistakes:
                left = [name for name in names if (name in MISTAKES) == mistakes]
                untried += _work_off(left, plan, folder, _Patience(timeout, end), outcome)
        empty(folder / "fmu")
    if untried:
        why = f"within {total:g} s" if outcome.out_of_time else f"after {outcome.deaths} dead processes"
        outcome.facts.append(f"Not tried {why}: {', '.join(untried)}.")
    if outcome.printed:
        message = f'The binary writes to standard output: "{outcome.printed}"; there is a logger for that.'
        outcome.findings.append(warning("9", message))
    return outcome


@dataclass(frozen=True)
class _Patience:
    """How long a call may take, s, and when all must be over, on the clock of `time.monotonic`."""

    call: float
    end: float

    @property
    def left(self) -> float:
        """Time that is left, s."""
        return max(0.0, self.end - time.monotonic())


def _work_off(left: list[str], plan: dict[str, Any], folder: Path, patience: _Patience, outcome: Outcome) -> list[str]:
    """Run experiments, after each death in a new process; returns the experiments that were given up."""
    while left and outcome.deaths < MOST_DEATHS:
        if not patience.left:
            outcome.out_of_time = True
            break
        now = left[:1] if plan["once"] else left
        ending = work(
            JOB,
            {**plan, "experiments": now},
            folder,
            timeout=patience.call,
            total=patience.left,
            memory=most_memory(),
            writable=[folder / "fmu"],
        )
        outcome.printed = outcome.printed or shown(ending.printed)
        outcome.out_of_time = outcome.out_of_time or ending.out_of_time
        outcome.confinement = ending.measures or outcome.confinement
        plan |= _known(ending.lines)
        under_way = _read(ending, outcome)
        last = "stepping" if plan["once"] else LAST_OF_BASE
        outcome.usable = outcome.usable or any(line.get("end") == last for line in ending.lines)
        outcome.deaths += bool(ending.how)
        if ending.out_of_time:
            return left[left.index(under_way) :] if under_way in left else left
        left = _further(left, now, ending, under_way, outcome.usable)
    return left


def _further(left: list[str], now: list[str], ending: Ending, under_way: str, usable: bool) -> list[str]:
    """Return the experiments that come next: after a death, or one by one, as long as the base holds."""
    ended = [line["end"] for line in ending.lines if "end" in line]
    if ending.how:
        return left[left.index(under_way) + 1 :] if usable and under_way in left else []
    if now == left or (now[0] in BASE and now[0] not in ended):
        return []
    return left[1:]


def most_memory() -> int:
    """Return how many bytes of addresses a process may take: half of this machine's memory within limits."""
    try:
        half = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2
    except (AttributeError, ValueError, OSError):  # Windows, and systems that do not say it
        return MOST_MEMORY
    return max(LEAST_MEMORY, min(MOST_MEMORY, half))


def step_of(package: Package) -> float:
    """Return a step for experiments, s: the proposed one, a sampling period, or a usual one."""
    return next(_proposed_steps(package), USUAL_STEP)


def _proposed_steps(package: Package) -> Iterator[float]:
    """Yield the steps that a description proposes, s."""
    document = package.document
    period = sampling_period(document.variables)
    for step in (document.experiment("stepSize"), period.number if period else None):
        if step is not None and 0 < step < float("inf"):
            yield step


def _plan(package: Package, folder: Path) -> dict[str, Any]:
    """Return the facts about the FMU that a child process needs."""
    document = package.document
    outputs = document.of_causality("output")
    sampled = (bool(outputs) and only_discrete(outputs)) or sampling_period(document.variables) is not None
    return {
        "library": str(folder / (host_library(package) or "")),
        "guid": document.guid,
        "resources": (folder / "resources").as_uri(),
        "start_time": document.experiment("startTime") or 0.0,
        "step": step_of(package),
        "step_proposed": next(_proposed_steps(package), None) is not None,
        "once": document.flag(ONLY_ONCE),
        "sampled": sampled,
        "exports_known": host_library(package) is not None and str(host_library(package)).endswith(".so"),
        "variables": [
            {
                "name": v.name,
                "reference": v.reference,
                "type": v.type,
                "stands_for": v.stands_for,
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
    outcome.findings += reaching_out(ending)
    if ending.how and not ending.out_of_time:
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


def reaching_out(ending: Ending) -> Iterator[Finding]:
    """Report what a binary did besides computing: calls that were denied, files, lines in the channel of the check.

    Parameters
    ----------
    ending
        Ending of the child process that called the binary.
    """
    asked: dict[str, list[str]] = {}
    for call, function in ending.denied.items():
        who = function if function.startswith("fmi2") else "The binary"
        what = f"{shown(who)} asks the system for {meaning(call)}"
        asked.setdefault(what, []).append(call)
    for what, calls in asked.items():
        yield warning(REACHING_OUT, f"{what} ({', '.join(sorted(calls))}); a check denies it.")
    if ending.foreign:
        yield error(REACHING_OUT, "The binary writes to descriptors that it did not open: to the check's own report.")
    if ending.files:
        yield note(REACHING_OUT, f"The binary leaves files in its working directory: {listed(ending.files)}.")


def _obituary(ending: Ending, under_way: str) -> str:
    what = shown(ending.function) or "the binary"
    during = f" during the experiment {under_way!r}" if under_way else ""
    return f"{what} {ending.how}{during}."
