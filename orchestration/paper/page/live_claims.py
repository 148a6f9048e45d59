"""What the live page needs to judge claims C1 to C10: the questions, and each criterion as data.

The page measures one seed of the noise. What it measures stands in ``measures.js``; the limits come from
`orchestration.paper.claims.criteria`.
"""

from typing import Any

from orchestration.paper.claims import criteria
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.claims.evaluation import QUESTIONS
from orchestration.paper.evidence import GAIN
from orchestration.paper.measure import RECOVERED, SETTLED
from orchestration.paper.numbers import SEMI_AXIS, TIP_START
from orchestration.paper.scenarios import UNSATURATED

JUDGED = ("C1", "C2", "C3a", "C3b", "C4", "C5", "C6", "C7", "C8", "C9", "C10")
"""Claims that the page answers."""
NAMES = {one: name for name, one in vars(criteria).items() if isinstance(one, Criterion)}
"""Names of the criteria, such as ``TRUE_MASS_ERROR``."""


def live_claims() -> dict[str, Any]:
    """The claims in their order, the criteria by name, and the numbers that measures need."""
    questions = [question for question in QUESTIONS if question.id in JUDGED]
    asked = [criterion for question in questions for criterion in question.criteria]
    return {
        "claims": [
            {
                "id": question.id,
                "claim": question.claim,
                "where": question.where,
                "criteria": [NAMES[criterion] for criterion in question.criteria],
            }
            for question in questions
        ],
        "criteria": {NAMES[one]: _criterion(one) for one in asked},
        "numbers": {"settled": SETTLED, "recovered": RECOVERED, "start": TIP_START, "semiAxis": SEMI_AXIS},
        "fixedMass": {"figure": "fig7", "values": {GAIN: 0.0, **UNSATURATED}},
    }


def _criterion(one: Criterion) -> dict[str, Any]:
    return {"comparison": one.comparison, "limit": one.limit, "unit": one.unit, "text": str(one)}
