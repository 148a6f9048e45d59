"""What the rows on cost compare: pairs of runs with and without C_x s."""

import casadi as ca
import numpy as np
import pytest

from orchestration.paper.claims import criteria
from orchestration.paper.claims.cost import judge_without_coriolis
from orchestration.paper.claims.operations import Operations, counted, without_update
from orchestration.paper.measure import Summary


def summary(**changes: float) -> Summary:
    """A run without errors but for those given."""
    values: dict = dict.fromkeys(Summary.__dataclass_fields__, 0.0) | {"torque": np.zeros(2)}
    return Summary(**{**values, **changes})


WHOLE = [summary(e_contact=1e-4, force_error=10.0), summary(e_contact=3e-4, force_error=20.0)]


@pytest.mark.parametrize(
    ("without", "broken"),
    [
        ([summary(e_contact=2.9e-4, force_error=40.0), summary(e_contact=6.9e-4, force_error=49.0)], []),
        ([summary(e_contact=3.1e-4), summary(e_contact=1e-4)], [criteria.NO_CORIOLIS_ERROR]),
        ([summary(force_error=40.0), summary(force_error=60.0)], [criteria.NO_CORIOLIS_FORCE]),
        ([summary(), summary(m2_in_contact=0.2)], [criteria.M2_IN_CONTACT]),
    ],
)
def test_runs_without_the_term_are_compared_seed_by_seed(
    without: list[Summary], broken: list[criteria.Criterion]
) -> None:
    """|e| may be twice that of the same seed and 0.1 mm more, the median of the force error 30 N larger."""
    values = judge_without_coriolis(WHOLE, without).values
    assert [criterion for criterion, value in values.items() if not criterion.met(value)] == broken


def test_the_first_result_is_counted_alone() -> None:
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [ca.sin(x) * x, ca.cos(x) + x])
    assert counted(function) == Operations(simple=2, costly=2)
    assert without_update(function) == Operations(simple=1, costly=1)
    assert str(counted(function)) == "4 (2)"


def test_every_function_is_costly() -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    functions = [ca.expm1(x), ca.log1p(x), ca.hypot(x, y), ca.remainder(x, y), ca.erf(x), ca.exp(x), ca.atan2(x, y)]
    assert counted(ca.Function("f", [x, y], functions)) == Operations(simple=0, costly=len(functions))
