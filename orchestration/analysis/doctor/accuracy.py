"""Findings on the error that the communication step makes, from runs with halved steps."""

import math
from collections.abc import Iterator
from dataclasses import replace

from orchestration.analysis.doctor.case import Case, Spelling
from orchestration.analysis.doctor.finding import Finding, Severity, counted, listed, percent
from orchestration.analysis.doctor.study import Kind, SignalError, Study

SMALL, LARGE = 0.01, 0.1  # error as a share of the range: above them a warning, an error
SCATTERED = 0.2  # difference of runs whose error has no order, as a share of the range, above which it is a warning
UNCLEAR = (Kind.JUMPS, Kind.NONE)
SEEN = 1e-4  # largest difference as a share of the range, below which it does not matter whether there is an order
APART = 1.0  # difference of runs, as a share of the range, beyond which they have nothing in common
MOST_COUNTED = 200  # most steps by which a step is divided in advice


def accuracy_findings(case: Case, study: Study, spell: Spelling) -> Iterator[Finding]:
    """Findings on a study that is not complete, on signals whose error has an order, and on signals without one."""
    if study.failure:
        return
    if study.cause:
        made = len(study.steps)
        said = f"{made} of 3 runs with halved steps {'was' if made == 1 else 'were'} made: {_sentence(study.cause)}"
        yield Finding("study", Severity.NOTE, case.system.name, said, {"steps": list(study.steps)})
    elif study.until < (1 - 1e-9) * case.stop_time:
        said = f"The study of the step covers the first {study.until:.4g} s of {case.stop_time:g} s, within its budget."
        yield Finding("study", Severity.NOTE, case.system.name, said, {"until": study.until})
    if study.signals and study.signals[0].relative > APART:
        yield _apart(case, study.signals[0])
        return
    yield from _with_order(case, [s for s in study.signals if s.kind is Kind.ORDER], spell)
    yield from _without_order(case, [s for s in study.signals if s.kind in UNCLEAR and s.relative_largest > SEEN])
    if study.signals and all(signal.kind is Kind.EXACT for signal in study.signals):
        said = "Halving the step changes no signal: the coupling makes no error beyond rounding."
        yield Finding("accuracy", Severity.NOTE, case.system.name, said)


def _apart(case: Case, worst: SignalError) -> Finding:
    """Finding on runs that have nothing in common."""
    said = (
        f"Runs with the steps {case.step:g} s and {case.step / 2:g} s have nothing in common: {worst.name} differs by"
        f" {worst.relative:.3g} times its range (root mean square)."
    )
    return Finding("accuracy", Severity.ERROR, worst.name, said, _figures(worst))


def _with_order(case: Case, signals: list[SignalError], spell: Spelling) -> Iterator[Finding]:
    if not signals:
        return
    worst = signals[0]
    order = worst.order or 1.0
    severity = _graded(worst.relative)
    others = [signal.name for signal in signals[1:] if signal.relative > SMALL]
    more = (
        f" So {'is' if len(others) == 1 else 'are'} {listed(others)}."
        if others and severity is not Severity.NOTE
        else ""
    )
    said = (
        f"{worst.name} is off by {percent(worst.relative)} of its range (root mean square; at most"
        f" {percent(worst.relative_largest)}), an error of order {order:.1f} in the step.{more}"
    )
    advice, command = "", ""
    if severity is not Severity.NOTE:
        parts = math.ceil((worst.relative / SMALL) ** (1 / order))
        parts = next((n for n in (2, 5, 10, 20, 50, 100, MOST_COUNTED) if n >= parts), MOST_COUNTED)
        advice = f"A step of {case.step / parts:.3g} s would bring that to about 1 % or less."
        command = spell(replace(case, step=case.step / parts))
    yield Finding("accuracy", severity, worst.name, said, _figures(worst), advice, command)


def _without_order(case: Case, signals: list[SignalError]) -> Iterator[Finding]:
    if not signals:
        return
    worst = signals[0]
    sampled = [s for s in signals if not case.system.component(s.name.partition(".")[0]).continuous]
    reason = "noise, switching or chatter decides them, or they jump at instants that depend on the step"
    said = (
        f"Smaller steps do not bring {counted(len(signals), 'signal')} together: {listed([s.name for s in signals])}."
        f" Between the steps {case.step:g} s and {case.step / 2:g} s {worst.name} differs by"
        f" {percent(worst.relative)} of its range (root mean square). No order is to be seen there: {reason}. Trust"
        " averages, and not single values."
    )
    figures = {**_figures(worst), "signals": [s.name for s in signals], "sampled": len(sampled)}
    severity = Severity.WARNING if worst.relative > SCATTERED else Severity.NOTE
    yield Finding("no-order", severity, worst.name, said, figures)


def _graded(share: float) -> Severity:
    if share > LARGE:
        return Severity.ERROR
    return Severity.WARNING if share > SMALL else Severity.NOTE


def _figures(signal: SignalError) -> dict[str, float | str | None]:
    return {
        "order": signal.order,
        "error": signal.error,
        "largest": signal.largest,
        "relative": signal.relative,
        "relative_largest": signal.relative_largest,
        "unit": signal.unit,
    }


def _sentence(text: str) -> str:
    return text if text.endswith(".") else f"{text}."
