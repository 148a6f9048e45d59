"""How sampling periods fit the communication step and each other."""

import itertools
import math
from collections.abc import Iterator
from fractions import Fraction

from orchestration.analysis.doctor.case import Case, Spelling
from orchestration.analysis.doctor.finding import Finding, Severity
from orchestration.errors import SystemDescriptionError
from orchestration.system.component import Component
from orchestration.system.sampling import RATIO_TOLERANCE, steps_per_tick
from orchestration.system.system import System

FINEST = 1000  # by how many times a step may have to be shorter than the given one
DIGITS = 10**9  # largest denominator of a sampling period as a fraction of a second
MOST_BEATS = 1000  # most periods after which all ticks should coincide again


def fitting_step(system: System, step: float, duration: float) -> float | None:
    """The longest round step, s, of at most a given one that divides every sampling period and the run.

    A step is round if it has at most two digits. None if there is no such step within a thousandth of the given one.
    """
    common = Fraction(0)
    for period in system.sample_times.values():
        common = _common_divisor(common, Fraction(period).limit_denominator(DIGITS))
    if not common:
        return step
    least = math.ceil(common / Fraction(step) - Fraction(RATIO_TOLERANCE))
    parts = range(max(1, least), FINEST * max(1, least))
    whole = [n for n in parts if _is_whole(duration * n / float(common))]
    chosen = next((n for n in whole if _is_round(float(common / n))), next(iter(whole), None))
    return None if chosen is None or float(common / chosen) < step / FINEST else float(common / chosen)


def _common_divisor(a: Fraction, b: Fraction) -> Fraction:
    """Largest number that divides both."""
    return Fraction(math.gcd(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator)


def _is_whole(ratio: float) -> bool:
    return abs(ratio - round(ratio)) <= RATIO_TOLERANCE * ratio


def _is_round(value: float) -> bool:
    return math.isclose(float(f"{value:.1e}"), value, rel_tol=RATIO_TOLERANCE)


def fit_findings(case: Case, fitting: float | None, spell: Spelling) -> Iterator[Finding]:
    """Findings on periods that are not multiples of the step, so that the run is refused."""
    for component in case.system.components:
        if _fits(component, case.step):
            continue
        period = component.sample_time
        advice, command = "", ""
        if fitting is not None:
            advice = f"Use a step of {fitting:.6g} s, which divides every sampling period."
            command = spell(case.but(step=fitting))
        yield Finding(
            "sampling-period",
            Severity.ERROR,
            f"{component.name}.sample_time",
            f"The sampling period of {component.name}, {period:g} s, is not a multiple of the step {case.step:g} s,"
            " so the run is refused.",
            {"period": period, "step": case.step, "fitting_step": fitting},
            advice,
            command,
        )


def _fits(component: Component, step: float) -> bool:
    """Whether the sampling period of a component, if it has one, is a multiple of the step."""
    try:
        steps_per_tick([component], step)
    except SystemDescriptionError:
        return False
    return True


def period_findings(case: Case) -> Iterator[Finding]:
    """Findings on periods that do not divide each other."""
    periods = case.system.sample_times
    ordered = sorted(periods.items(), key=lambda item: item[1])
    for (fast, short), (slow, long) in itertools.pairwise(ordered):
        ratio = long / short
        if abs(ratio - round(ratio)) <= RATIO_TOLERANCE * ratio:
            continue
        nearest = Fraction(ratio).limit_denominator(MOST_BEATS)
        yield Finding(
            "sampling-beat",
            Severity.NOTE,
            f"{slow}.sample_time",
            f"The sampling periods of {fast}, {short:g} s, and {slow}, {long:g} s, do not divide each other: their"
            f" ticks coincide every {nearest.denominator * long:.6g} s, and the age of what one reads from the"
            " other changes from tick to tick.",
            {"periods": {fast: short, slow: long}, "beat": nearest.denominator * long},
        )
