"""Findings on stability: how much deviations grow over the run, and whether the run bears that out."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from orchestration.analysis.doctor.case import Case, Spelling
from orchestration.analysis.doctor.finding import Finding, Severity, listed, percent
from orchestration.analysis.doctor.study import Kind, Study
from orchestration.analysis.stability.step_limit import FLOOR
from orchestration.analysis.stability.verdict import Alternative, Verdict

SHARES = (2, 5, 10, 20, 50, 100)  # of the step that are proposed
LITTLE, MUCH = 0.1, 10.0  # growth over a run that is a note, and from which on it is an error
CERTAIN = 1e16  # growth after which rounding errors would be as large as the signals
TELLING = 1e3  # growth from which on a run shows whether it takes place: errors that add up grow by less
SMALL = 0.01  # error, as a share of the range, with which a run is accepted


@dataclass(frozen=True)
class Ways:
    """How a proposed change is tried, and how a user makes it.

    Attributes
    ----------
    trial
        Function that says why a case fails; empty if it does not.
    spell
        Function that says how a user runs a case.
    """

    trial: Callable[[Case], str]
    spell: Spelling

    def that_run(self, proposals: Iterable[tuple[str, Case]]) -> Iterator[tuple[str, str]]:
        """Proposals that do not fail, as sentences with commands."""
        return ((said, self.spell(case)) for said, case in proposals if not self.trial(case))


def stability_finding(case: Case, verdict: Verdict, study: Study, ways: Ways) -> Finding:
    """Finding from the predicted stability and from the runs that were made.

    A growth of less than a tenth over the run is a note, one of more than ten times an error. A prediction is an
    approximation near one instant, so the runs have the last word.
    """
    growth = _growth(verdict, case.duration)
    culprit = verdict.blame[0][0] if verdict.blame else None
    figures = {
        "radius": verdict.radius,
        "growth_rate": verdict.growth_rate,
        "growth": growth,
        "largest_stable_step": _number(verdict.largest_stable_step),
        "culprit": str(culprit) if culprit else None,
        "hidden": list(verdict.hidden),
    }
    subject = f"{culprit.source}.{culprit.output}" if culprit else case.system.name
    severity, said = _graded(case, verdict, study, growth)
    advice = ("", "")
    if severity is not Severity.NOTE:
        said += f" The signal that matters most is {culprit}." if culprit else ""
        advice = next(ways.that_run(_proposals(case, verdict)), (verdict.advice[0], ""))
    return Finding("stability", severity, subject, said, figures, *advice)


def _graded(case: Case, verdict: Verdict, study: Study, growth: float) -> tuple[Severity, str]:
    """How bad a prediction is, and what it says."""
    at = f"{verdict.algorithm} with a step of {case.step:g} s"
    if verdict.stable:
        where = " at the start" if study.failure else ""
        if verdict.largest_stable_step is None:
            return (
                Severity.NOTE,
                f"{at} is stable{where} as far as can be seen, but no other step that was examined is.",
            )
        return Severity.NOTE, f"{at} is stable{where}. {verdict.advice[0]}"
    over = f"a small deviation grows {_words(growth)} over {case.duration:g} s"
    if growth < LITTLE:
        return Severity.NOTE, f"{at} adds a little: {over}. {verdict.advice[0]}"
    if contradicted(growth, study):
        said = (
            f"Taken as linear near t = 0, {at} would let deviations grow by {verdict.growth_rate:.3g} 1/s."
            f" The run does not bear that out: runs with half the step stay together. {_why(verdict)}"
        )
        return Severity.NOTE, said
    bad = study.failure or (growth >= MUCH and not accepted(study, case))
    return Severity.ERROR if bad else Severity.WARNING, f"{at} is unstable: {over}."


def _why(verdict: Verdict) -> str:
    """Why a prediction may be wrong."""
    if not verdict.hidden:
        return "The prediction holds near one instant, and the system moves on."
    moving = listed(verdict.hidden)
    return (
        f"{moving} moves so fast at that instant that its motion hides some of its states, so the prediction is rough."
    )


def _growth(verdict: Verdict, duration: float) -> float:
    """Share by which a deviation grows over a run: 0.003 stands for 0.3 %."""
    exponent = verdict.growth_rate * duration
    return math.expm1(exponent) if exponent < 700 else math.inf


def _words(growth: float) -> str:
    if growth < 1:
        return f"by {percent(growth)}"
    return f"{growth + 1:.3g} times" if growth < CERTAIN else "without bound"


def _number(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def contradicted(growth: float, study: Study) -> bool:
    """Whether the runs show that a predicted growth does not take place.

    Each step makes a small error, and such a growth would make the early ones dominate: the difference between two
    runs would be larger at the end than at first by about that factor. Instead it grows far less, and smaller steps
    bring the runs together.
    """
    if growth < TELLING or study.failure or not study.signals:
        return False
    together = all(signal.kind in (Kind.ORDER, Kind.EXACT) for signal in study.signals)
    return together and study.spread < math.sqrt(growth)


def accepted(study: Study, case: Case) -> bool:
    """Whether the runs with halved steps agree until the stop time."""
    complete = study.until > (1 - 1e-9) * case.stop_time and not study.failure and bool(study.signals)
    return complete and all(signal.relative < SMALL for signal in study.signals)


def failed_run(case: Case, study: Study, ways: Ways | None) -> Finding:
    """Finding on a run that fails; with ways, it proposes a shorter step with which the run does not fail."""
    advice = next(ways.that_run(shorter_steps(case)), ("", "")) if ways is not None else ("", "")
    said = f"The run fails: {study.failure}"
    return Finding("run", Severity.ERROR, case.system.name, said, {"until": study.until}, *advice)


def _proposals(case: Case, verdict: Verdict) -> Iterator[tuple[str, Case]]:
    """Changes that a verdict proposes, and then shorter steps."""
    for better in verdict.better:
        growth = _grown(better.radius, case)
        if growth < LITTLE:
            said = f"{_named(better)} is stable" if growth <= 0 else f"{_named(better)} grows by {percent(growth)}"
            yield f"At this step {said}.", case.but(algorithm=better.algorithm, order=better.order)
    yield from shorter_steps(case, _number(verdict.largest_stable_step))


def shorter_steps(case: Case, largest: float | None = None) -> Iterator[tuple[str, Case]]:
    """Cases with shorter steps, which are sampling periods too, with a sentence each; `largest` is a bound, s."""
    for part in (1, *SHARES):
        step = case.step / part if part > 1 or largest is None else _round_down(largest)
        if step < case.step and (largest is None or step <= largest):
            changed = case.but(step=step, sample_time=step if case.system.sample_times else None)
            yield f"Use a step of {step:.3g} s.", changed


def _grown(radius: float, case: Case) -> float:
    """Share by which a deviation grows over the run with a radius per step; 0 where none is to be seen."""
    exponent = max(0.0, math.log(max(radius, 1e-300))) * case.n
    return 0.0 if radius <= 1 + FLOOR else math.expm1(min(exponent, 700.0))


def _named(better: Alternative) -> str:
    """An alternative in words."""
    if better.order is not None:
        return f"the order {', '.join(better.order)}"
    order = better.algorithm.order
    return f"{better.algorithm.name} with inputs of order {order}" if order else better.algorithm.name


def _round_down(step: float) -> float:
    """A step with one digit, below a given one, s."""
    decade = 10.0 ** math.floor(math.log10(step))
    return float(f"{math.floor(step / decade * (1 + 1e-9)) * decade:.0e}")
