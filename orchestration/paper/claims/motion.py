"""Claims about conventional control and the TIRT: C1 to C3 and C13."""

import numpy as np

from orchestration.paper import theory
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import Evidence
from orchestration.paper.measure import at_ticks, contact, distance_from_start, largest_norm, norms


def _tirt_follows_virtual(evidence: Evidence) -> Finding:
    result = evidence.results["fig3"]
    distance = norms(at_ticks(result, "controller.x_t") - at_ticks(result, "trajectory.x_v"))
    touch = contact(result)
    times = result.tick_times("controller.x_t[1]")
    before, later = distance[times < touch.first].max(), distance[times >= touch.first].max()
    return Finding(
        bool(before <= 1e-5 and later >= 100 * before),
        f"largest |x_t - x_v| {before * 1e3:.2g} mm before contact, {later * 1e3:.3g} mm from then on",
    )


def _true_mass_follows(evidence: Evidence) -> Finding:
    result = evidence.results["fig2"]
    e = largest_norm(at_ticks(result, "controller.e"))
    touch = contact(result)
    end = distance_from_start(result)
    a, b = theory.wall_points()
    at_a = float(np.linalg.norm(touch.enter - a))
    at_b = float(np.linalg.norm(touch.leave - b))
    slides = touch.share >= 2 / 3 and touch.phases <= 3 and max(at_a, at_b) <= 0.05
    return Finding(
        e <= 1e-3 and slides and end <= 1e-3,
        f"largest |e| {e * 1e3:.2g} mm; contact {touch.first:.4f}-{touch.last:.4f} s, {touch.share:.0%} of it"
        f" touching in {touch.phases} phases, from {at_a * 1e3:.1f} mm of a to {at_b * 1e3:.1f} mm of b;"
        f" end {end * 1e3:.2g} mm from (1.5, 0)",
    )


def _wrong_mass_degrades(evidence: Evidence) -> Finding:
    true, wrong = (largest_norm(at_ticks(evidence.results[n], "controller.e")) for n in ("fig2", "fig4"))
    return Finding(
        wrong >= 5e-3 and wrong >= 10 * true,
        f"largest |e| {wrong * 1e3:.3g} mm with m2 = 2.5 kg, {true * 1e3:.2g} mm with m2 = 1 kg",
    )


def _tirt_only_in_contact(evidence: Evidence) -> Finding:
    result = evidence.results["fig5"]
    distance = norms(at_ticks(result, "controller.x_t") - at_ticks(result, "trajectory.x_v"))
    times = result.tick_times("controller.x_t[1]")
    touch = contact(result)
    before = distance[times < touch.first].max()
    at_end = distance[times >= touch.last][0]
    later = distance[times >= touch.last + 0.1][0]
    return Finding(
        bool(before <= 1e-5 and at_end <= 1e-3),
        f"|x_t - x_v| {before * 1e3:.2g} mm at most before contact; {at_end * 1e3:.2g} mm when contact ends,"
        f" {later * 1e3:.2g} mm 0.1 s later: x_t may be replaced by x_v before the first contact; stopping at"
        " loss of contact makes the reference jump by that much",
    )


QUESTIONS = (
    Question(
        "C1",
        "TIRT and virtual trajectory nearly coincide until the wall is hit, then differ",
        "III-B, Fig. 3",
        "|x_t - x_v| <= 0.01 mm before the first contact and 100 times more after it",
        _tirt_follows_virtual,
        "fig3",
    ),
    Question(
        "C2",
        "With true parameters and a perfect sensor the tip follows its TIRT, slides from a to b in contact and returns",
        "V, Fig. 2",
        "|e| <= 1 mm; from 50 mm of a to 50 mm of b, with at most two bounces, touching at least 2/3 of the"
        " time (the wall is elastic); ends within 1 mm of (1.5, 0)",
        _true_mass_follows,
        "fig2",
    ),
    Question(
        "C3",
        "With m2 = 2.5 kg conventional control degrades unacceptably",
        "V, Fig. 4",
        "|e| >= 10 times that of Fig. 2, and >= 5 mm: half the depth of the segment, so half the force",
        _wrong_mass_degrades,
        "fig2, fig4",
    ),
    Question(
        "C13",
        "The TIRT need only be integrated during contact",
        "III-B",
        "replacing x_t by x_v out of contact changes the reference by at most 0.01 mm before the first"
        " contact and by at most 1 mm (a tenth of the depth) when contact ends",
        _tirt_only_in_contact,
        "fig5 (seed 1)",
    ),
)
