"""What the live page needs to judge claims C1 to C10: the questions, the criteria, and what is measured, as data.

The page measures one seed of the noise, by formulas of `orchestration.paper.page.live_formulas`; the limits come from
`orchestration.paper.claims.criteria`.
"""

from collections.abc import Collection, Mapping, Sequence
from functools import reduce
from typing import Any

from orchestration.paper.claims import criteria
from orchestration.paper.claims.claim import Question
from orchestration.paper.claims.criteria import SHOWN_PER_SI, Criterion
from orchestration.paper.claims.evaluation import QUESTIONS
from orchestration.paper.claims.judged import FIGURES as ADAPTIVE
from orchestration.paper.evidence import GAIN
from orchestration.paper.figures.overlay import FORCE
from orchestration.paper.numbers import SEMI_AXIS
from orchestration.paper.page.live_formulas import IDEAL, SAMPLED, SATURATED, SHOWN, TOUCHING, Formulas
from orchestration.paper.scenarios import UNSATURATED

FIXED = "fixed"
"""Name of the run of fig7 without adaptation."""
RUNS: Mapping[str, tuple[str, Mapping[str, float]]] = {
    **{name: (name, {}) for name in ("fig2", "fig4", *ADAPTIVE, IDEAL)},
    FIXED: ("fig7", {GAIN: 0.0, **UNSATURATED}),
}
"""Runs that the claims need: the scenario, and start values besides those of the form."""
_SIDE = "fig2.plant.wall_offset"
_HEIGHT = f"{SEMI_AXIS[1]} * sqrt(1 - {_SIDE} / {SEMI_AXIS[0]} * ({_SIDE} / {SEMI_AXIS[0]}))"


def _each(measure: str) -> tuple[str, ...]:
    """A measure of Figs. 5 to 7."""
    return tuple(f"{name}.{measure}" for name in ADAPTIVE)


def _larger(one: str, two: str) -> str:
    """The larger of two numbers."""
    return f"({one}) * ({one} >= {two}) + ({two}) * ({one} < {two})"


ASKED: Mapping[str, Mapping[str, Sequence[str]]] = {
    "C1": {
        "TIRT_BEFORE_CONTACT": ["fig2.apart_before"],  # Figs. 2 and 3 show one run
        "TIRT_GROWTH": ["fig2.apart_later / fig2.apart_before"],
    },
    "C2": {
        "TRUE_MASS_ERROR": ["fig2.e_max"],
        "SLIDE_ENDS": [
            f"norm(fig2.enter_1 + {_SIDE}, fig2.enter_2 - {_HEIGHT})",
            f"norm(fig2.leave_1 + {_SIDE}, fig2.leave_2 + {_HEIGHT})",
        ],
        "BOUNCES": ["fig2.bounces"],
        "SLIDE_SHARE": ["fig2.touching"],
        "END": ["fig2.end"],
    },
    "C3a": {"WRONG_MASS_GROWTH": ["fig4.e_max / fig2.e_max"], "WRONG_MASS_ERROR": ["fig4.e_max"]},
    "C3b": {
        "WRONG_MASS_FORCE": [
            _larger("fig4.peak_force / fig2.peak_force", "fig4.steady_force / fig2.steady_force"),
        ],
    },
    "C4": {"M2_SETTLED": _each("m2_settled"), "M2_AT_CONTACT": _each("m2_at_contact")},
    "C5": {"M2_IN_CONTACT": _each("m2_in_contact"), "M2_FLUCTUATION": _each("m2_fluctuation")},
    "C6": {"M2_RECOVERY": _each("m2_recovery")},
    "C7": {
        "SATURATED_ERROR": ["fig6.e_contact / fig5.e_contact"],
        "SATURATED_FORCE": ["fig6.force_error / fig5.force_error"],
        "BOUNDED_ERROR": ["fig6.e_max"],
        "END": ["fig6.end"],
    },
    "C8": {
        "TORQUE_RATIO": [f"fig7.torque_{i} / fig5.torque_{i}" for i in (1, 2)],
        "TORQUE_WITHIN": [f"fig7.torque_{i} - fig6.actuator.tau_max[{i}]" for i in (1, 2)],
    },
    "C9": {
        "START_ERROR": ["fig7.e_start"],
        "FIXED_MASS_RATIO": [f"fig7.e_start / {FIXED}.e_start"],
        "FREE_ERROR": ["fig7.e_free"],
    },
    "C10": {
        "LARGER_ERROR": ["fig7.e_contact / fig5.e_contact"],
        "SLIGHTLY_LARGER_ERROR": ["fig7.e_contact - fig5.e_contact"],
        "LARGER_FORCE": ["fig7.force_error / fig5.force_error"],
        "SLIGHTLY_LARGER_FORCE": ["fig7.force_error - fig5.force_error"],
    },
}
"""What each claim measures, by the name of the criterion; of several formulas each must meet it."""
JUDGED = tuple(ASKED)
"""Claims that the page answers."""
NAMES = {one: name for name, one in vars(criteria).items() if isinstance(one, Criterion)}
"""Names of the criteria, such as ``TRUE_MASS_ERROR``."""
NUMBERS = (
    ("e_start", "Largest |e| in free motion until the contact", 1e3, "mm"),
    ("first", "Contact from", 1.0, "s"),
    ("last", "Contact until", 1.0, "s"),
    ("peak_force", "Peak force", 1.0, "N"),
    ("e_contact", "Largest |e| in contact", 1e3, "mm"),
    ("m2_end", "Estimate of m2 at the end", 1.0, "kg"),
    ("share_saturated", "Ticks with a saturated actuator", 100.0, "%"),
)
"""The numbers of a run that are looked at first: measure, name, how many of the shown unit are one, and the unit."""


DRAWN = [
    f"{name}[{i}]"
    for name in ("plant.q", "plant.x", "controller.x_t", "controller.tau_cmd", "trajectory.x_v", "actuator.tau")
    for i in (1, 2)
]
"""Columns that arm and plots show besides those of the numbers."""


def live_claims(outputs: Collection[str]) -> dict[str, Any]:
    """The claims in their order, the criteria by name, and the formulas of all that is measured.

    Parameters
    ----------
    outputs
        Names of the columns of every run.
    """
    formulas = Formulas((*RUNS, SHOWN), outputs)
    questions = [question for question in QUESTIONS if question.id in JUDGED]
    asked = [criterion for question in questions for criterion in question.criteria]
    record = {
        "claims": [_claim(question, formulas) for question in questions],
        "criteria": {NAMES[one]: _criterion(one) for one in asked},
        "numbers": [
            {"value": formulas.place(measure), "label": label, "factor": factor, "unit": unit}
            for measure, label, factor, unit in NUMBERS
        ],
        "norms": {f"{FORCE} (norm)": formulas.place(f"norm({FORCE})")},
        "phases": {"in contact": formulas.place(TOUCHING), "saturated": formulas.place(SATURATED)},
    }
    runs = {name: {"figure": figure, "values": {**values}} for name, (figure, values) in RUNS.items()}
    drawn = [*dict.fromkeys([*formulas.columns[SHOWN], *DRAWN])]
    return {
        **record,
        "nodes": formulas.nodes,
        "columns": formulas.columns,
        "runs": runs,
        "drawn": drawn,
        "held": SAMPLED,
    }


def _claim(question: Question, formulas: Formulas) -> dict[str, Any]:
    """A claim: its texts, the places of what it measures, of whether it holds, and of the contacts that it needs."""
    places = {name: [formulas.place(text) for text in texts] for name, texts in ASKED[question.id].items()}
    met = [
        formulas.compared(place, criterion.comparison, formulas.number(criterion.limit))
        for criterion in question.criteria
        for place in places[NAMES[criterion]]
    ]
    runs = {run for found in places.values() for place in found for run in formulas.runs_of(place)} - {IDEAL, FIXED}
    return {
        "id": question.id,
        "claim": question.claim,
        "where": question.where,
        "measured": {NAMES[criterion]: places[NAMES[criterion]] for criterion in question.criteria},
        "holds": reduce(formulas.both, met),
        "touches": [formulas.place(f"{run}.first") for run in sorted(runs)],
    }


def _criterion(one: Criterion) -> dict[str, Any]:
    return {"unit": one.unit, "text": str(one), "factor": SHOWN_PER_SI.get(one.unit, 1.0)}
