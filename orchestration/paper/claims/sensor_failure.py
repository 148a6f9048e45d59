"""Measures what becomes of a run in which the force sensor fails, or the torques are far too small: C19a and C19b.

Section IV-A ends with a sentence on algorithm 2: when a large external force or a sensor failure saturates the
controller, the error will likely increase and remain bounded. It rests on the analysis of algorithm 1 in III-D, so the
same is asked of algorithm 1. A run that ends with an error counts as one whose error is not bounded.
"""

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import Evidence
from orchestration.paper.laboratory import SEEDS, Laboratory
from orchestration.paper.numbers import TORQUE_LIMITS
from orchestration.paper.troubles import HEALTHY, WEAK, Errors, errors_of, troubled_jobs

FAILURE_SEEDS = SEEDS[:3]
P_MIN = 0.1  # kg, bound of the projection that the row of algorithm 1 shows beside


def errors_by_trouble(
    laboratory: Laboratory, algorithm: int, changes: Mapping[str, float]
) -> Mapping[str, list[Errors]]:
    """Errors of the runs of an algorithm with each trouble, one for each seed, by its name.

    Parameters
    ----------
    algorithm
        1 or 2.
    changes
        Start values that all runs have besides.
    """
    jobs = troubled_jobs(algorithm, changes, TORQUE_LIMITS, FAILURE_SEEDS)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = {name: pool.map(lambda job: errors_of(laboratory, job), some) for name, some in jobs.items()}
        return {name: list(errors) for name, errors in found.items()}


def judge(errors: Mapping[str, list[Errors]]) -> Finding:
    """What runs with and without troubles say about C19."""
    healthy = errors[HEALTHY]
    troubled = [some for name, some in errors.items() if name != HEALTHY]
    grown = [one.largest > before.largest for some in troubled for one, before in zip(some, healthy, strict=True)]
    values = {
        limits.FAILURE_GROWTH: np.mean(grown),
        limits.FAILURE_ERROR: [one.largest for some in troubled for one in some],
        limits.FAILURE_END: [one.end for some in troubled for one in some],
    }
    return Finding(values, f"largest |e| from the contact on: {_in_words(errors)}")


def _in_words(errors: Mapping[str, list[Errors]]) -> str:
    """The largest error and the smallest estimate with each trouble, in a sentence."""
    parts = []
    for name, some in errors.items():
        whole = [one for one in some if one.finished]
        told = []
        if whole:
            told.append(f"{1e3 * max(one.largest for one in whole):.3g} mm")
            told.append(f"{1e3 * max(one.end for one in whole):.2g} mm at the end")
            least = min(one.least for one in whole)
            told.append(f"m2_hat {'>=' if least >= 0 else 'falls to the negative mass of'} {least:.2g} kg")
        if len(whole) < len(some):
            told.append(f"{len(some) - len(whole)} of {len(some)} runs end with an error")
        parts.append(f"{name} {', '.join(told)}")
    return "; ".join(parts)


def _of_algorithm_2(evidence: Evidence) -> Finding:
    return judge(errors_by_trouble(evidence.laboratory, 2, {}))


def _of_algorithm_1(evidence: Evidence) -> Finding:
    found = judge(errors_by_trouble(evidence.laboratory, 1, {}))
    projected = {"controller.projection": 1.0, "controller.p_min[2]": P_MIN}
    beside = judge(errors_by_trouble(evidence.laboratory, 1, projected))
    text = f"{found.measured}. With m2_hat kept above {P_MIN:g} kg, {beside.measured}"
    return Finding(found.values, text)


_CRITERIA = (limits.FAILURE_GROWTH, limits.FAILURE_ERROR, limits.FAILURE_END)
_SEEDS_TEXT = f"seeds {FAILURE_SEEDS[0]}-{FAILURE_SEEDS[-1]}"
_SCOPE = f"dropout, stuck and spike in the midst of the contact, and torques limited to {WEAK:.0%} of Fig. 6's limits"

QUESTIONS = (
    Question(
        "C19a",
        "Algorithm 2 under a large force, or with a sensor that fails: the error likely grows, and stays bounded",
        "IV-A",
        _CRITERIA,
        _of_algorithm_2,
        f"sensor-dropout, sensor-stuck, sensor-spike, {_SEEDS_TEXT}",
        _SCOPE,
    ),
    Question(
        "C19b",
        "The same of algorithm 1, whose analysis IV-A refers to",
        "III-D, IV-A",
        _CRITERIA,
        _of_algorithm_1,
        f"sensor-dropout-craig, sensor-stuck-craig, sensor-spike-craig, {_SEEDS_TEXT}",
        _SCOPE,
    ),
)
