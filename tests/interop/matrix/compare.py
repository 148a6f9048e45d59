"""Compares the record of a tool with the rows of this project, with one of seven verdicts."""

import math
from dataclasses import dataclass

import numpy as np

from tests.interop.matrix.protocol import Job, Record
from tests.interop.matrix.runner import Answer

AGREEMENT = 1e-9  # of a column's largest absolute value; what the reference data of fmus/reference ask of importers
PASSES, BITWISE, CLOSE, ROUNDED = "passes", "bitwise", "close", "rounded"
STEPS_AGREE, DIFFERS, FAILS = "steps agree", "differs", "fails"


@dataclass(frozen=True)
class Verdict:
    """What came of a job in a tool.

    Attributes
    ----------
    kind
        `PASSES`: a check found nothing; `BITWISE`; `CLOSE`: within `AGREEMENT`; `ROUNDED`: equal to all the
        digits that the tool writes; `STEPS_AGREE`: within `AGREEMENT` but for the row before the first step;
        `DIFFERS`; `FAILS`.
    distance
        Largest difference over its column's largest absolute value, rounded up to one digit.
    detail
        Where it differs, or why it fails.
    steps
        Steps compared.
    """

    kind: str
    distance: float = 0.0
    detail: str = ""
    steps: int = 0


def judge(job: Job, answer: Answer, ours: np.ndarray) -> Verdict:
    """Compare all rows and columns that a tool shows with ours, shape (n_steps + 1, len(job.columns))."""
    record = answer.record
    if record is None:
        return Verdict(FAILS, detail=answer.failure)
    if record.values.size == 0:
        return Verdict(PASSES)
    shown = [job.columns.index(name) for name in record.columns]
    expected = ours[record.first :, shown]
    if record.values.shape != expected.shape:
        detail = f"{len(record.values)} rows where {len(expected)} are expected"
        return Verdict(DIFFERS, math.inf, detail, job.n_steps)
    verdict = _judged(job, record, expected)
    if len(shown) < len(job.columns):
        missing = f"only {len(shown)} of {len(job.columns)} outputs can be seen"
        verdict = Verdict(
            verdict.kind, verdict.distance, "; ".join(filter(None, [verdict.detail, missing])), job.n_steps
        )
    return verdict


def _judged(job: Job, record: Record, expected: np.ndarray) -> Verdict:
    values = record.values
    if values.tobytes() == expected.tobytes():
        return Verdict(BITWISE, steps=job.n_steps)
    distances = relative(values, expected)
    largest = rounded_up(float(distances.max()))
    allowed = record.resolution + 4 * np.spacing(np.abs(expected))  # decimal digits of a number are off by less
    if record.resolution and (np.abs(values - expected) <= allowed).all():
        return Verdict(ROUNDED, largest, steps=job.n_steps)
    if largest <= AGREEMENT:
        return Verdict(CLOSE, largest, steps=job.n_steps)
    where, rest = _where(record, expected, distances), rounded_up(float(distances[1:].max()))
    if record.first == 0 and rest <= AGREEMENT:
        return Verdict(STEPS_AGREE, rest, f"{where}; that is before the first step", job.n_steps)
    return Verdict(DIFFERS, largest, where, job.n_steps)


def relative(values: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Differences over the largest absolute value of each column; infinite where ours is all zeros or not finite."""
    size = np.abs(expected).max(axis=0)
    difference = np.abs(values - expected)
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = np.where(difference == 0, 0.0, difference / size)
    return np.where(np.isnan(distances), np.inf, distances)


def rounded_up(distance: float) -> float:
    """To one digit, so that last bits do not show in a document."""
    if distance == 0 or not math.isfinite(distance):
        return distance
    digits = 10.0 ** math.floor(math.log10(distance))
    return float(f"{math.ceil(distance / digits - 1e-9) * digits:.0e}")


def _where(record: Record, expected: np.ndarray, distances: np.ndarray) -> str:
    """The largest difference."""
    k, j = np.unravel_index(np.argmax(distances), distances.shape)
    values = f"{record.values[k, j]:.6g}, ours {expected[k, j]:.6g}"
    return f"{record.columns[j]} at step {int(k) + record.first} is {values}"
