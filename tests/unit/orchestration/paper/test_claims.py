"""Criteria are data: what a verdict compares, a reader reads, and a calibration divides by are one number."""

import math

import pytest

from adaptimp_fmu import SampledModel
from fmus.catalog import MODELS
from orchestration.paper.claims import criteria
from orchestration.paper.claims.claim import HOLDS, NOT_REPRODUCED, Finding, Question
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.claims.evaluation import QUESTIONS
from orchestration.paper.claims.operations import Operations, operations
from orchestration.paper.evidence import Evidence
from orchestration.paper.laboratory import Laboratory
from orchestration.paper.scenarios import CRAIG, SLOTINE_LI

NEVER_READ = Evidence(Laboratory({}), {})


@pytest.mark.parametrize(
    ("comparison", "kept", "broken"),
    [("<", 1.9, 2.0), ("<=", 2.0, 2.1), (">", 2.1, 2.0), (">=", 2.0, 1.9)],
)
def test_every_value_must_keep_the_limit(comparison: str, kept: float, broken: float) -> None:
    criterion = Criterion("what", comparison, 2.0)
    assert criterion.met(kept)
    assert criterion.met([kept, kept])
    assert not criterion.met(broken)
    assert not criterion.met([kept, broken])
    assert not criterion.met([kept, math.nan])
    assert not criterion.met([]), "nothing was measured"


def test_a_criterion_reads_as_a_phrase() -> None:
    assert str(Criterion("|e|", "<=", 5e-3, "mm")) == "|e| <= 5 mm"
    assert str(Criterion("share", ">=", 0.75, "%", why="three quarters")) == "share >= 75 % (three quarters)"
    assert str(Criterion("force", ">", 0.0, "N", "that of Fig. 5")) == "force > that of Fig. 5"
    assert str(Criterion("force", "<=", 30.0, "N", "that of Fig. 5")) == "force <= that of Fig. 5 + 30 N"
    assert Criterion("|e|", "<=", 5e-3, "mm").share([1e-3, 4e-3]) == 0.8


def question(*measured: float) -> Question:
    """A claim with two criteria, of which the second may stay without a measurement."""
    asked = (Criterion("first", "<=", 1.0), Criterion("second", ">=", 1.0))
    found = Finding(dict(zip(asked, measured, strict=False)), "as given")
    return Question("C0", "It does", "nowhere", asked, lambda _: found, scope="all seeds")


def test_a_claim_holds_if_all_its_criteria_are_met() -> None:
    assert question(1.0, 1.0).answer(NEVER_READ).verdict == HOLDS
    assert question(2.0, 1.0).answer(NEVER_READ).verdict == NOT_REPRODUCED
    assert question(1.0, 0.0).answer(NEVER_READ).verdict == NOT_REPRODUCED
    assert question(1.0, 1.0).answer(NEVER_READ).criterion == "first <= 1; second >= 1; all seeds"
    with pytest.raises(KeyError):
        question(1.0).answer(NEVER_READ)


def test_every_criterion_is_asked_for() -> None:
    """No limit stands there that no claim reads."""
    asked = {criterion for question in QUESTIONS for criterion in question.criteria} | set(criteria.ACCURATE)
    asked.add(criteria.CLEARLY_LARGER)  # of the words beside C7 and C10
    assert asked == {value for value in vars(criteria).values() if isinstance(value, Criterion)}


def test_operations_are_counted_by_kind() -> None:
    """A product, a sum and a difference are simple; a sine and a quotient are costly."""
    import casadi as ca

    model = SampledModel("Counted", "A model for tests")
    a = model.input("a", 1.0, description="One")
    b = model.input("b", 2.0, description="Other")
    model.output("y", ca.sin(a) * b + a, description="Two simple operations, one costly")
    model.output("z", b / a - b, description="One of each")
    assert operations(model)["tick"] == Operations(simple=3, costly=2)


def test_algorithm_2_computes_less_on_every_machine() -> None:
    """The counts are those of the paper's table, in which nothing hangs on a clock."""
    one, two = (operations(MODELS[name]())["tick_update"] for name in (CRAIG, SLOTINE_LI))
    assert criteria.FEWER_SIMPLE.met(two.simple - one.simple)
    assert criteria.FEWER_COSTLY.met(two.costly - one.costly)
    assert operations(MODELS[CRAIG]())["tick_update"] == one
