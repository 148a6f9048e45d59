"""Tells which claims hold at one setting of the open values, from what was measured there."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from orchestration.paper.calibrations import Setting
from orchestration.paper.claims import cost, judged, saturation, sensor_failure
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.laboratory import Runner
from orchestration.paper.measure import Summary
from orchestration.paper.studies import measured
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.studies.runs_at import FIXED_MASS, FREE, TORQUE_LIMITS, row_at
from orchestration.paper.studies.summary_measure import summary_of
from orchestration.paper.troubles import TROUBLES, Errors

SCENARIOS = ("fig5", "fig6", "fig7", "spong-ortega")
RUNS = (*SCENARIOS, FREE)
CLEARLY = limits.CLEARLY_LARGER.limit  # ratio from which an error is called clearly larger
Values = Mapping[Criterion, float | Sequence[float] | np.ndarray]


@dataclass(frozen=True)
class Evidence:
    """What was measured at a setting over some seeds of the noise.

    Attributes
    ----------
    rows
        The row of each seed.
    """

    rows: Sequence[Row]

    @cached_property
    def noise(self) -> Mapping[str, Sequence[Summary]]:
        """Summaries over the seeds by run; a run that failed with any seed is missing."""
        return {
            name: [summary_of(row.numbers, f"{name}.") for row in self.rows]
            for name in RUNS
            if not any(np.isnan(row.numbers.get(f"{name}.e_max", np.nan)) for row in self.rows)
        }

    @property
    def torque_limits(self) -> np.ndarray:
        """Limits of Fig. 6, N.m, shape (2,)."""
        return np.array([self.number(name) for name in TORQUE_LIMITS])

    def number(self, name: str) -> float:
        """A number with the first seed; NaN if its run failed or was not made."""
        return self.rows[0].numbers.get(name, np.nan)


def evidence_at(laboratory: Runner, setting: Setting, seeds: Sequence[int]) -> Evidence:
    """Make the runs of a setting for some seeds of the noise; the limits of torque come from the first seed."""
    first = row_at(laboratory, setting, seeds[0])
    given = [first.numbers.get(name, np.nan) for name in TORQUE_LIMITS]
    allowed = None if np.isnan(given).any() else {f"actuator.tau_max[{i}]": given[i - 1] for i in (1, 2)}
    return Evidence([first, *(row_at(laboratory, setting, seed, allowed) for seed in seeds[1:])])


def _tirt(found: Evidence) -> Values:
    before, later = (found.number(f"fig2.x_t_{when}") for when in ("before", "later"))
    return {limits.TIRT_BEFORE_CONTACT: before, limits.TIRT_GROWTH: later / before}


def _true_mass(found: Evidence) -> Values:
    return {
        limits.TRUE_MASS_ERROR: found.number("fig2.e_max"),
        limits.SLIDE_ENDS: [found.number("fig2.at_a"), found.number("fig2.at_b")],
        limits.BOUNCES: found.number("fig2.phases") - 1,
        limits.SLIDE_SHARE: found.number("fig2.touching"),
        limits.END: found.number("fig2.end"),
    }


def _wrong_mass(found: Evidence) -> Values:
    true, wrong = found.number("fig2.e_max"), found.number("fig4.e_max")
    return {limits.WRONG_MASS_ERROR: wrong, limits.WRONG_MASS_GROWTH: wrong / true}


def _wrong_mass_force(found: Evidence) -> Values:
    ratios = [found.number(f"fig4.force_{name}") / found.number(f"fig2.force_{name}") for name in ("peak", "steady")]
    return {limits.WRONG_MASS_FORCE: np.max(ratios)}


def _reference(found: Evidence) -> Values:
    return {
        limits.TIRT_BEFORE_CONTACT: found.number("fig5.x_t_before"),
        limits.TIRT_AT_END: found.number("fig5.x_t_end"),
    }


def _deviation(found: Evidence) -> Values:
    return {**judged.deviation(found.noise), **judged.fluctuation(found.noise)}


def _free_motion(found: Evidence) -> Values:
    largest = judged.spread(found.noise["fig7"], lambda s: s.e_start)[1]
    ratio = largest / found.number(f"{FIXED_MASS}.e_start")
    return {**judged.free_motion(found.noise), limits.FIXED_MASS_RATIO: ratio}


def _stable(found: Evidence, run: str) -> Values:
    runs = found.noise[run]
    return {limits.BOUNDED_ERROR: [s.e_max for s in runs], limits.END: [s.end for s in runs]}


def _accurate(found: Evidence, run: str) -> Values:
    runs = found.noise[run]
    return {
        limits.ACCURATE_FREE: [s.e_free for s in runs],
        limits.ACCURATE_CONTACT: [s.e_contact for s in runs],
        limits.M2_IN_CONTACT: [s.m2_in_contact for s in runs],
    }


def _slower(found: Evidence) -> Values:
    """Errors at lower rates beyond twice those at the full rate."""
    more = [
        found.number(f"{measured.at_divisor(name, divisor)}.e_contact") - 2 * found.number(f"{name}.e_contact")
        for name in ("fig5", "fig7")
        for divisor in measured.DIVISORS
    ]
    return {limits.SLOW_UPDATE_ERROR: more}


def _sliding(found: Evidence) -> Values:
    def numbers(name: str) -> list[float]:
        return [
            found.number(f"{measured.at_gain(start, gain)}.{name}")
            for start in ("wrong", "true")
            for gain in measured.K_D_GRID
        ]

    return {
        limits.RISE: numbers("rise"),
        limits.RMS: numbers("rms_ratio"),
        limits.ERROR_BOUND: numbers("e_ratio"),
    }


def _stiffer(found: Evidence, start: str) -> Values:
    """The largest |s| over that at the next smaller K_d."""
    sizes = [found.number(f"{measured.at_gain(start, gain)}.largest") for gain in measured.K_D_GRID]
    return {limits.FALLS_WITH_GAIN: [larger / smaller for smaller, larger in pairwise(sizes)]}


def _switching(found: Evidence) -> Values:
    return {limits.CASE_C: found.number("fig5.case_c"), limits.GAMMA: found.number("fig5.gamma_ratio")}


def _clearly_larger(found: Evidence, name: str) -> Values:
    """Medians of both errors in contact over those of Fig. 5."""
    ratios = [
        judged.spread(found.noise[name], error)[0] / judged.spread(found.noise["fig5"], error)[0]
        for error in (lambda s: s.e_contact, lambda s: s.force_error)
    ]
    return {limits.CLEARLY_LARGER: ratios}


def _without_coriolis(found: Evidence) -> Values:
    numbers = {name: found.number(name) for name in measured.UNITS if name.startswith(f"{measured.NO_CORIOLIS}.")}
    without = summary_of(numbers, f"{measured.NO_CORIOLIS}.")
    return cost.judge_without_coriolis(found.noise["fig7"][:1], [without]).values


def _in_trouble(found: Evidence, algorithm: int) -> Values:
    runs = {trouble: measured.in_trouble(algorithm, trouble) for trouble in TROUBLES}
    return sensor_failure.judge(
        {name: [Errors(found.number(f"{run}.e_later"), found.number(f"{run}.e_last"))] for name, run in runs.items()}
    ).values


def _saturated(found: Evidence) -> Values:
    return dict(zip(saturation.CRITERIA, (found.number(f"fig6.{name}") for name in measured.GROWTH), strict=True))


@dataclass(frozen=True)
class _Asked:
    """A question at a setting.

    Attributes
    ----------
    runs
        Runs with noise that it needs.
    values
        What its criteria are asked of; NaN does not meet a criterion.
    also
        Questions that have to be answered with yes as well.
    costly
        Whether it needs runs that are made at few settings only.
    """

    runs: tuple[str, ...]
    values: Callable[[Evidence], Values]
    also: tuple[str, ...] = ()
    costly: bool = False


FIGS, PAIR = judged.FIGURES, ("fig5", "fig7")
_ASKED: Mapping[str, _Asked] = {
    "C1": _Asked((), _tirt),
    "C2": _Asked((), _true_mass),
    "C3a": _Asked((), _wrong_mass),
    "C3b": _Asked((), _wrong_mass_force),
    "C4": _Asked(FIGS, lambda found: judged.approach(found.noise)),
    "C5": _Asked(FIGS, _deviation),
    "C6": _Asked(FIGS, lambda found: judged.recovery(found.noise)),
    "C7": _Asked(("fig5", "fig6"), lambda found: judged.saturation(found.noise)),
    "C8": _Asked(PAIR, lambda found: judged.torque(found.noise, found.torque_limits)),
    "C9": _Asked(("fig7",), _free_motion),
    "C10": _Asked(PAIR, lambda found: judged.contact_errors(found.noise)),
    "C12b": _Asked(PAIR, _slower, costly=True),
    "C12c": _Asked(("fig7",), _without_coriolis, costly=True),
    "C13": _Asked(("fig5",), _reference),
    "C14a": _Asked(("fig5",), lambda found: {limits.CRAIG_GROWTH: found.number("fig5.V_growth")}),
    "C14b": _Asked((), _sliding, costly=True),
    "C14c": _Asked((), lambda found: _stiffer(found, "wrong"), costly=True),
    "C16": _Asked(("spong-ortega",), lambda found: judged.fixed_inverse(found.noise)),
    "C17": _Asked(("fig5",), _switching),
    "C19a": _Asked((), lambda found: _in_trouble(found, 2), costly=True),
    "C19b": _Asked((), lambda found: _in_trouble(found, 1), costly=True),
    "C20": _Asked(("fig6",), _saturated, costly=True),
    "C7 clearly": _Asked(("fig5", "fig6"), lambda found: _clearly_larger(found, "fig6"), ("C7",)),
    "C10 clearly": _Asked(PAIR, lambda found: _clearly_larger(found, "fig7"), ("C10",)),
    "C14c true": _Asked((), lambda found: _stiffer(found, "true"), costly=True),
    "C14c proportional": _Asked((), lambda found: _stiffer(found, measured.PROPORTIONAL), costly=True),
    "stable 1": _Asked(("fig5",), lambda found: _stable(found, "fig5")),
    "stable 2": _Asked((FREE,), lambda found: _stable(found, FREE)),
    "accurate 1": _Asked(("fig5",), lambda found: _accurate(found, "fig5")),
    "accurate 2": _Asked((FREE,), lambda found: _accurate(found, FREE)),
}
QUESTIONS = tuple(_ASKED)
"""What is asked at each setting: claims, whether errors are clearly larger (C7, C10), whether a larger K_d gives a
smaller s from the true mass and with a Gamma that grows in proportion (C14c), and whether an algorithm without limits
is stable, and stable and accurate (C11)."""
COSTLY = tuple(name for name, asked in _ASKED.items() if asked.costly)
"""Questions that need runs that are made at few settings only."""


def verdicts(found: Evidence, *, costly: bool = False) -> dict[str, bool]:
    """Answer `QUESTIONS` at a setting, those of `COSTLY` if asked for.

    What needs a run that failed is answered with no.
    """
    with np.errstate(all="ignore"):
        answers = {
            name: all(run in found.noise for run in asked.runs) and judged.met(asked.values(found))
            for name, asked in _ASKED.items()
            if costly or not asked.costly
        }
    for name in answers:
        answers[name] &= all(answers[other] for other in _ASKED[name].also)
    return answers
