"""What a claim is, and how it is answered."""

from collections.abc import Callable
from dataclasses import dataclass

from orchestration.paper.evidence import Evidence

HOLDS, NOT_REPRODUCED, NOT_EVALUATED = "holds", "not reproduced", "not evaluated"


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper and what came out.

    Attributes
    ----------
    runs
        Scenarios and seeds that were measured.
    """

    id: str
    claim: str
    where: str
    criterion: str
    measured: str
    verdict: str
    runs: str


@dataclass(frozen=True)
class Finding:
    """What a measurement says: whether the criterion is met, and the numbers."""

    met: bool
    measured: str


@dataclass(frozen=True)
class Question:
    """A claim before it is measured.

    Attributes
    ----------
    criterion
        Fixed before the measurement.
    """

    id: str
    claim: str
    where: str
    criterion: str
    measurement: Callable[[Evidence], Finding]
    runs: str = "none: equations"

    def answer(self, evidence: Evidence) -> Claim:
        """Measure."""
        finding = self.measurement(evidence)
        verdict = HOLDS if finding.met else NOT_REPRODUCED
        return Claim(self.id, self.claim, self.where, self.criterion, finding.measured, verdict, self.runs)
