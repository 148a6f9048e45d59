"""What Section V and the theory claim, measured.

Each claim has a criterion that was fixed before the measurement. A claim that does not meet it is
reported as not reproduced, with the numbers.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass

import numpy as np

from orchestration.paper import theory
from orchestration.paper.measure import at_ticks, contact, largest_norm
from orchestration.result import Result

HOLDS, NOT_REPRODUCED, NOT_EVALUATED = "holds", "not reproduced", "not evaluated"
ADAPTIVE = "needs the adaptive controllers"


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper and what came out."""

    id: str
    claim: str
    where: str
    criterion: str
    measured: str
    verdict: str


@dataclass(frozen=True)
class Finding:
    """What a measurement says: whether the criterion is met, and the numbers."""

    met: bool
    measured: str


Measurement = Callable[[Mapping[str, Result]], Finding]


@dataclass(frozen=True)
class Question:
    """A claim before it is measured; without a measurement it is not evaluated."""

    id: str
    claim: str
    where: str
    criterion: str
    measurement: Measurement | None = None

    def answer(self, results: Mapping[str, Result]) -> Claim:
        """Measure."""
        if self.measurement is None:
            return Claim(self.id, self.claim, self.where, self.criterion, ADAPTIVE, NOT_EVALUATED)
        finding = self.measurement(results)
        verdict = HOLDS if finding.met else NOT_REPRODUCED
        return Claim(self.id, self.claim, self.where, self.criterion, finding.measured, verdict)


def evaluate(results: Mapping[str, Result]) -> list[Claim]:
    """Measure all claims on the runs of the scenarios, by their names."""
    return [question.answer(results) for question in QUESTIONS]


def as_records(claims: list[Claim]) -> list[dict[str, str]]:
    """Claims as plain records, for JSON."""
    return [asdict(claim) for claim in claims]


def _tirt_follows_virtual(results: Mapping[str, Result]) -> Finding:
    result = results["fig3"]
    distance = np.linalg.norm(at_ticks(result, "controller.x_t") - at_ticks(result, "trajectory.x_v"), axis=1)
    touch = contact(result)
    times = result.tick_times("controller.x_t[1]")
    before, during = distance[times < touch.first].max(), distance[times >= touch.first].max()
    return Finding(
        bool(before <= 1e-5 and during >= 100 * before),
        f"largest |x_t - x_v| {before * 1e3:.2g} mm before contact, {during * 1e3:.3g} mm from then on",
    )


def _true_mass_follows(results: Mapping[str, Result]) -> Finding:
    result = results["fig2"]
    e = largest_norm(at_ticks(result, "controller.e"))
    touch = contact(result)
    end = float(np.linalg.norm(result.vector("plant.x")[-1] - (1.5, 0.0)))
    a, b = theory.wall_points()
    at_a = float(np.linalg.norm(touch.enter - a))
    at_b = float(np.linalg.norm(touch.leave - b))
    slides = touch.share >= 2 / 3 and touch.phases <= 3 and max(at_a, at_b) <= 0.05
    met = e <= 1e-3 and slides and end <= 1e-3
    return Finding(
        met,
        f"largest |e| {e * 1e3:.2g} mm; contact {touch.first:.4f}-{touch.last:.4f} s, {touch.share:.0%} of it"
        f" touching in {touch.phases} phases, from {at_a * 1e3:.1f} mm of a to {at_b * 1e3:.1f} mm of b;"
        f" end {end * 1e3:.2g} mm from (1.5, 0)",
    )


def _wrong_mass_degrades(results: Mapping[str, Result]) -> Finding:
    true, wrong = (largest_norm(at_ticks(results[n], "controller.e")) for n in ("fig2", "fig4"))
    return Finding(
        wrong >= 5e-3 and wrong >= 10 * true,
        f"largest |e| {wrong * 1e3:.3g} mm with m2 = 2.5 kg, {true * 1e3:.2g} mm with m2 = 1 kg",
    )


def _forms_agree(results: Mapping[str, Result]) -> Finding:  # noqa: ARG001 - needs no run
    square, redundant = theory.form_difference(), theory.redundant_residual()
    return Finding(
        square <= 1e-10 and redundant <= 1e-10,
        f"n = 2: relative difference of tau {square:.1e}; n = 3: (5) meets (3) to {redundant:.1e} relative",
    )


def _skew_symmetric(results: Mapping[str, Result]) -> Finding:  # noqa: ARG001 - needs no run
    residual = theory.skew_residual()
    return Finding(residual <= 1e-10, f"symmetric part of dH_x/dt - 2 C_x: {residual:.1e} of its norm")


QUESTIONS = (
    Question(
        "C1",
        "TIRT and virtual trajectory nearly coincide until the wall is hit, then differ",
        "III-B, Fig. 3",
        "|x_t - x_v| <= 0.01 mm before the first contact and 100 times more after it",
        _tirt_follows_virtual,
    ),
    Question(
        "C2",
        "With true parameters and a perfect sensor the tip follows its TIRT, slides from a to b in contact"
        " and returns",
        "V, Fig. 2",
        "|e| <= 1 mm; from 50 mm of a to 50 mm of b, with at most two bounces, touching at least 2/3 of the"
        " time (the wall is elastic); ends within 1 mm of (1.5, 0)",
        _true_mass_follows,
    ),
    Question(
        "C3",
        "With m2 = 2.5 kg conventional control degrades unacceptably",
        "V, Fig. 4",
        "|e| >= 10 times that of Fig. 2, and >= 5 mm: half the depth of the segment, so half the force",
        _wrong_mass_degrades,
    ),
    Question("C4", "m2_hat quickly approaches 1 kg during the first free motion", "V, Figs. 5-7", ""),
    Question("C5", "During contact m2_hat deviates less than 20 %", "V, Figs. 5-7", ""),
    Question("C6", "m2_hat recovers as soon as the tip leaves the wall at b", "V, Figs. 5-7", ""),
    Question(
        "C7",
        "Saturation at 75 %: larger tracking and force errors, performance acceptable, errors bounded",
        "V, Fig. 6, (28)",
        "",
    ),
    Question(
        "C8",
        "Algorithm 2 needs considerably less torque; 75 % of algorithm 1's maximum never saturates it",
        "V, Fig. 7",
        "",
    ),
    Question("C9", "Algorithm 2: tracking error very small in free motion", "V, Fig. 7", ""),
    Question(
        "C10",
        "Algorithm 2: errors in contact slightly larger than algorithm 1 unsaturated",
        "V, Fig. 7",
        "",
    ),
    Question("C11", "Algorithm 2 is less sensitive to Psi and Gamma than algorithm 1", "V", ""),
    Question("C12", "Algorithm 2 costs less; p_hat may be updated at a lower rate without harm", "IV-B", ""),
    Question("C13", "The TIRT need only be integrated during contact", "III-B", ""),
    Question("C14", "V_c decreases with F_c; s is bounded by delta / k_d", "(20)-(25), (35)", ""),
    Question(
        "C15",
        "The forms (4), (5), (6)-(7) agree for a square J; (5) serves a redundant arm",
        "II-B",
        "relative differences <= 1e-10 at 1000 random states",
        _forms_agree,
    ),
    Question("C16", "The variant with a fixed inverse does the same task", "III-C, remark 2", ""),
    Question("C17", "gamma* of (26) bounds the needed gamma", "(26)", ""),
    Question(
        "C18",
        "dH_x/dt - 2 C_x is skew-symmetric",
        "IV-A",
        "symmetric part <= 1e-10 of the norm at 1000 random states",
        _skew_symmetric,
    ),
)
