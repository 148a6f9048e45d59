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
MOST_BEATS = 1000  # most periods after which all ticks should coincide again


def fitting_step(system: System, step: float) -> float | None:
    """The longest step, s, that is not above a given one and divides every sampling period; None if there is none."""
    periods = [Fraction(period).limit_denominator(10**9) for period in system.sample_times.values() if period > 0]
    if not periods:
        return step
    common = periods[0]
    for period in periods[1:]:
        common = Fraction(
            math.gcd(common.numerator * period.denominator, period.numerator * common.denominator),
            common.denominator * period.denominator,
        )
    parts = math.ceil(common / Fraction(step) - Fraction(RATIO_TOLERANCE))
    found = float(common / max(1, parts))
    return found if found > step / FINEST else None


def fit_findings(case: Case, fitting: float | None, spell: Spelling) -> Iterator[Finding]:
    """Findings on periods that are no multiples of the step, so that the run is refused."""
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
