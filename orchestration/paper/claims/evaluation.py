"""Measures all claims of section V and of the theory.

Each claim has criteria that were fixed before the measurement. A claim that does not meet them is
reported as not reproduced, with the numbers.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from string import ascii_lowercase

import numpy as np

from orchestration.paper.calibrations import FIRST
from orchestration.paper.claims import adaptive, cost, judged, motion, saturation, sensitivity, sensor_failure, theory
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import HOLDS, NOT_REPRODUCED, Claim
from orchestration.paper.evidence import Evidence
from orchestration.paper.saturation import along

QUESTIONS = sorted(
    (
        *motion.QUESTIONS,
        *adaptive.QUESTIONS,
        *theory.QUESTIONS,
        *cost.QUESTIONS,
        *sensitivity.QUESTIONS,
        *saturation.QUESTIONS,
        *sensor_failure.QUESTIONS,
    ),
    key=lambda question: (int(question.id[1:].rstrip(ascii_lowercase)), question.id),
)

IN_SPACE = "C1 C2 C3a C3b C4 C5 C6 C7 C8 C9 C10 C13 C14a C14b C14c C15 C16 C17 C18".split()
"""Claims that are asked of an arm in space, too."""


def evaluate(evidence: Evidence) -> list[Claim]:
    """Measure all claims at the chosen calibration, and judge those of Figs. 5 to 7 at the earlier one as well."""
    first = at_first(evidence)
    claims = [question.answer(evidence) for question in QUESTIONS]
    return [replace(claim, first=first.get(claim.id, "")) for claim in claims]


def evaluate_in_space(evidence: Evidence) -> list[Claim]:
    """Measure the claims that are asked of an arm in space: those of `IN_SPACE`."""
    return [question.answer(evidence) for question in QUESTIONS if question.id in IN_SPACE]


def at_first(evidence: Evidence) -> Mapping[str, str]:
    """Verdicts at the earlier calibration, over the same seeds, by claim."""
    noise = evidence.noise_at_first
    fixed = evidence.start_without_adaptation(f"-{FIRST.name}")
    started = judged.spread(noise["fig7"], lambda s: s.e_start)[1]
    asked: Mapping[str, Callable[[], judged.Values]] = {
        "C4": lambda: judged.approach(noise),
        "C5": lambda: {**judged.deviation(noise), **judged.fluctuation(noise)},
        "C6": lambda: judged.recovery(noise),
        "C7": lambda: judged.saturation(noise),
        "C8": lambda: judged.torque(noise, np.array(FIRST.torque_limits)),
        "C9": lambda: {**judged.free_motion(noise), limits.FIXED_MASS_RATIO: started / fixed},
        "C10": lambda: judged.contact_errors(noise),
        "C16": lambda: judged.fixed_inverse(noise),
        "C20": lambda: saturation.judge(along(evidence.saturated_at_first, saturation.gains_of(FIRST))),
    }
    return {claim: HOLDS if judged.met(values()) else NOT_REPRODUCED for claim, values in asked.items()}
