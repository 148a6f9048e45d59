"""A claim of the paper: the question with its criteria, the measurement, and the answer."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from orchestration.paper.claims.criteria import Criterion

if TYPE_CHECKING:
    from orchestration.paper.evidence import Evidence

HOLDS, NOT_REPRODUCED, NOT_EVALUATED = "holds", "not reproduced", "not evaluated"
NO_RUNS = "none: equations"


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper and what its measurement gave.

    Attributes
    ----------
    runs
        Scenarios and seeds that were measured.
    first
        The verdict at the earlier calibration, ``first``; empty if it was not asked for.
    margins
        For each criterion the worst measured value beside the limit, in a phrase.
    """

    id: str
    claim: str
    where: str
    criterion: str
    measured: str
    verdict: str
    runs: str
    first: str = ""
    margins: Sequence[str] = ()


@dataclass(frozen=True)
class Finding:
    """What a measurement says.

    Attributes
    ----------
    values
        What was measured, by criterion, in SI units: a number, or one per run, joint or tick.
    measured
        The numbers in a sentence.
    """

    values: Mapping[Criterion, float | Sequence[float] | np.ndarray]
    measured: str


@dataclass(frozen=True)
class Question:
    """A claim before it is measured.

    Attributes
    ----------
    criteria
        Limits that were fixed before the measurement; the claim holds if all are met.
    scope
        What the criteria are asked of, such as all seeds.
    """

    id: str
    claim: str
    where: str
    criteria: tuple[Criterion, ...]
    measurement: "Callable[[Evidence], Finding]"
    runs: str = NO_RUNS
    scope: str = ""

    @property
    def criterion(self) -> str:
        """The criteria as prose."""
        return "; ".join([*map(str, self.criteria), *([self.scope] if self.scope else [])])

    def answer(self, evidence: "Evidence") -> Claim:
        """Measure the claim and judge it.

        Raises
        ------
        KeyError
            If the measurement leaves a criterion out.
        """
        finding = self.measurement(evidence)
        scale = evidence.case.scale
        asked = [(one.scaled(scale), finding.values[one]) for one in self.criteria]
        met = all([criterion.met(values) for criterion, values in asked])
        verdict = HOLDS if met else NOT_REPRODUCED
        margins = tuple(criterion.margin(values) for criterion, values in asked)
        criterion = self.criterion if scale == 1 else "; ".join(str(one) for one, _ in asked)
        about = (self.id, self.claim, self.where, criterion)
        return Claim(*about, finding.measured, verdict, self.runs, margins=margins)
