"""Measures the claims about conventional control and the target-impedance reference trajectory: C1 to C3, C13."""

import numpy as np

from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims import judged
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import Evidence
from orchestration.paper.measure import at_ticks, contact, distance_from_start, largest_length, steady_force
from orchestration.paper.numbers import TRUE_M2, WRONG_M2

LATER = 0.1  # s after contact


def _tirt_follows_virtual(evidence: Evidence) -> Finding:
    result = evidence.results["fig3"]
    times, distance = judged.reference_distance(result)
    touch = contact(result)
    before, later = distance[times < touch.first].max(), distance[times >= touch.first].max()
    return Finding(
        {limits.TIRT_BEFORE_CONTACT: before, limits.TIRT_GROWTH: later / before},
        f"largest |x_t - x_v| {before * 1e3:.2g} mm before contact, {later * 1e3:.3g} mm from then on",
    )


def _true_mass_follows(evidence: Evidence) -> Finding:
    result = evidence.results["fig2"]
    e = largest_length(at_ticks(result, "controller.e"))
    touch = contact(result)
    end = distance_from_start(result)
    a, b = evidence.case.ends
    at_a = float(np.linalg.norm(touch.enter - a))
    at_b = float(np.linalg.norm(touch.leave - b))
    return Finding(
        {
            limits.TRUE_MASS_ERROR: e,
            limits.SLIDE_ENDS: (at_a, at_b),
            limits.BOUNCES: touch.phases - 1,
            limits.SLIDE_SHARE: touch.share,
            limits.END: end,
        },
        f"largest |e| {e * 1e3:.2g} mm; contact {touch.first:.4f}-{touch.last:.4f} s, {touch.share:.0%} of it"
        f" touching in {touch.phases} phases, from {at_a * 1e3:.1f} mm of a to {at_b * 1e3:.1f} mm of b;"
        f" end {end * 1e3:.2g} mm from {evidence.case.place}",
    )


def _wrong_mass_degrades(evidence: Evidence) -> Finding:
    true, wrong = (largest_length(at_ticks(evidence.results[n], "controller.e")) for n in ("fig2", "fig4"))
    return Finding(
        {limits.WRONG_MASS_ERROR: wrong, limits.WRONG_MASS_GROWTH: wrong / true},
        f"largest |e| {wrong * 1e3:.3g} mm with m2 = {WRONG_M2:g} kg, {true * 1e3:.2g} mm with m2 = {TRUE_M2:g} kg",
    )


def _wrong_mass_force(evidence: Evidence) -> Finding:
    true, wrong = evidence.results["fig2"], evidence.results["fig4"]
    peaks = contact(true).peak, contact(wrong).peak
    steady = steady_force(true), steady_force(wrong)
    return Finding(
        {limits.WRONG_MASS_FORCE: max(peaks[1] / peaks[0], steady[1] / steady[0])},
        f"peak force {peaks[1]:.0f} N with m2 = {WRONG_M2:g} kg and {peaks[0]:.0f} N with {TRUE_M2:g} kg, mean force"
        f" after the impact {steady[1]:.1f} and {steady[0]:.1f} N{pressed(peaks, steady)}",
    )


def pressed(peaks: tuple[float, float], steady: tuple[float, float]) -> str:
    """What peak and steady forces with the true and with the wrong mass say, as the end of a sentence."""
    harder = [name for name, (true, wrong) in (("peak", peaks), ("mean", steady)) if wrong > true]
    if harder:
        verb = "is" if len(harder) == 1 else "are"
        return f": with the heavier model the {' and the '.join(harder)} force {verb} larger"
    return ": a heavier model presses no harder, so what degrades is the tracking"


def _tirt_only_in_contact(evidence: Evidence) -> Finding:
    result = evidence.results["fig5"]
    values = judged.reference_in_contact(result)
    before, at_end = values[limits.TIRT_BEFORE_CONTACT], values[limits.TIRT_AT_END]
    times, distance = judged.reference_distance(result)
    later = distance[times >= contact(result).last + LATER][0]
    return Finding(
        values,
        f"|x_t - x_v| {before * 1e3:.2g} mm at most before contact; {at_end * 1e3:.2g} mm when contact ends,"
        f" {later * 1e3:.2g} mm {LATER:g} s later: {replaceable(before)}; if the integration stops when contact ends,"
        f" the reference jumps by {at_end * 1e3:.2g} mm",
    )


def replaceable(before: float) -> str:
    """Whether x_v may take the place of x_t before the contact, from the largest |x_t - x_v| there, m, in words."""
    may = "may" if limits.TIRT_BEFORE_CONTACT.met(before) else "may not"
    return f"x_t {may} be replaced by x_v before the first contact"


QUESTIONS = (
    Question(
        "C1",
        "TIRT and virtual trajectory nearly coincide until the wall is hit, then differ",
        "III-B, Fig. 3",
        (limits.TIRT_BEFORE_CONTACT, limits.TIRT_GROWTH),
        _tirt_follows_virtual,
        "fig3",
    ),
    Question(
        "C2",
        "With true parameters and a perfect sensor the tip follows its TIRT, slides from a to b in contact and returns",
        "V, Fig. 2",
        (limits.TRUE_MASS_ERROR, limits.SLIDE_ENDS, limits.BOUNCES, limits.SLIDE_SHARE, limits.END),
        _true_mass_follows,
        "fig2",
    ),
    Question(
        "C3a",
        "With m2 = 2.5 kg conventional control tracks unacceptably worse",
        "V, Fig. 4",
        (limits.WRONG_MASS_GROWTH, limits.WRONG_MASS_ERROR),
        _wrong_mass_degrades,
        "fig2, fig4",
    ),
    Question(
        "C3b",
        "With m2 = 2.5 kg the contact force of conventional control degrades, too",
        "V, Fig. 4",
        (limits.WRONG_MASS_FORCE,),
        _wrong_mass_force,
        "fig2, fig4",
    ),
    Question(
        "C13",
        "The TIRT need only be integrated during contact",
        "III-B",
        (limits.TIRT_BEFORE_CONTACT, limits.TIRT_AT_END),
        _tirt_only_in_contact,
        "fig5 (seed 1)",
        "so far the reference moves if x_v replaces x_t out of contact",
    ),
)
