"""The terms of (27) and (28) against values by hand, and along made-up runs whose answer is known."""

import math

import numpy as np
import pytest

from orchestration.paper.claims import criteria
from orchestration.paper.claims.claim import HOLDS, NOT_REPRODUCED, Finding, Question
from orchestration.paper.claims.saturation import CRITERIA, cause, described, judge
from orchestration.paper.evidence import Evidence
from orchestration.paper.laboratory import Laboratory
from orchestration.paper.saturation import Along, Region, mobility_norm, region, tip_force

RIGHT_ANGLE = np.array([[0.0, math.pi / 2]])  # link 1 along x1, link 2 along x2: J = [[-1, -1], [1, 0]]


def test_the_tip_force_of_an_elbow_at_a_right_angle() -> None:
    """J' F = (-F1 + F2, -F1), so F = (-tau_2, tau_1 - tau_2)."""
    assert tip_force(RIGHT_ANGLE, np.array([[5.0, 3.0]])) == pytest.approx(np.array([[-3.0, 2.0]]), abs=1e-14)


def test_each_instant_has_its_own_jacobian() -> None:
    """Turned by a right angle as a whole, the arm pushes in turned directions."""
    q = np.vstack([RIGHT_ANGLE, RIGHT_ANGLE + np.array([math.pi / 2, 0.0])])
    forces = tip_force(q, np.array([[5.0, 3.0], [5.0, 3.0]]))
    assert forces == pytest.approx(np.array([[-3.0, 2.0], [-2.0, -3.0]]), abs=1e-14)


def test_the_mobility_of_an_elbow_at_a_right_angle() -> None:
    """Along x1 the tip moves mass 2 alone; along x2 it lifts both: H_x = diag(m2, m1 + m2)."""
    assert mobility_norm(RIGHT_ANGLE, np.array([[2.0, 0.5]])) == pytest.approx([2.0])
    assert mobility_norm(RIGHT_ANGLE, np.array([[2.0, 4.0]])) == pytest.approx([0.25])


def test_the_region_of_gains_that_are_one() -> None:
    """With alpha = 2 e^2 + 2 de^2, beta = |e + de|: disks of radius 1/2 about +-(1, 1)/sqrt(8)."""
    found = region(0.5 * math.sqrt(2), psi=1.0, stiffness=1.0, damping=2.0)
    assert found.e == pytest.approx(0.25 * math.sqrt(2) + 0.5)
    assert found.de == pytest.approx(found.e)


@pytest.mark.parametrize("psi", [20.0, 100.0, 160.0])
def test_the_region_reaches_as_far_as_a_search_finds(psi: float) -> None:
    """Over directions in the plane of (e, de), and with both axes at once, no point of the set lies beyond."""
    k, b, acceleration = 2000.0, 170.0, 300.0
    found = region(acceleration, psi, k, b)
    angles = np.linspace(0, 2 * math.pi, 200_001)
    e, de = np.cos(angles) * found.e, np.sin(angles) * found.de
    # Along a direction alpha grows with the square of the distance and beta with the distance.
    reach = 2 * acceleration * np.abs(de + psi * e) / (2 * psi * k * e**2 + 2 * (b - psi) * de**2)
    assert np.abs(reach * e).max() == pytest.approx(found.e, rel=1e-8)
    assert np.abs(reach * de).max() == pytest.approx(found.de, rel=1e-8)

    random = np.random.default_rng(7)
    e, de = random.normal(size=(2, 2, 100_000)) * np.array([found.e, found.de])[:, None, None]
    alpha = (2 * psi * k * e**2 + 2 * (b - psi) * de**2).sum(axis=0)
    reach = 2 * acceleration * np.linalg.norm(de + psi * e, axis=0) / alpha
    assert (reach * np.linalg.norm(e, axis=0)).max() <= found.e * (1 + 1e-12)
    assert (reach * np.linalg.norm(de, axis=0)).max() <= found.de * (1 + 1e-12)


def run(V: list[float], bound: list[float], missing: list[float]) -> Along:
    """A run of one tick per second."""
    n = len(V)
    values, still = np.array(V), np.zeros(n)
    return Along(
        time=np.arange(n, dtype=float),
        missing=np.array(missing),
        h_star=2.0,
        beta=np.ones(n),
        gamma=still,
        sharp=np.array(bound),
        bound=np.array(bound),
        V=values,
        rate=np.append(np.diff(values), 0.0),
        e=still,
        de=still,
        region=Region(1.0, 1.0),
    )


def test_only_what_exceeds_the_bound_while_saturated_counts() -> None:
    """V rises by 3, 1 and 1 under bounds of 1; at the last of these ticks nothing is saturated."""
    assert run([10, 13, 14, 15], [1, 1, 0.5, 1], [5, 5, 0, 0]).excess() == pytest.approx(0.2)
    assert run([10, 13, 14, 15], [1, 1, 0.5, 1], [5, 5, 5, 0]).excess() == pytest.approx(0.25)
    assert run([10, 9, 8, 7], [1, 1, 1, 1], [5, 5, 5, 5]).excess() == 0.0


def test_outside_is_judged_at_the_largest_missing_force() -> None:
    """At the force of 5 N the right sides are those given, at 3 N greater by 2 h* 2 N beta = 8."""
    assert run([1, 1, 1], [-1, -9, -7], [5, 3, 3]).outside.tolist() == [True, True, False]


def verdict(run: Along) -> str:
    question = Question("C0", "It does", "nowhere", CRITERIA, lambda _: Finding(judge(run), described(run)))
    never_read = Evidence(Laboratory({}), {})
    return question.answer(never_read).verdict


def test_a_run_that_keeps_the_bound_holds() -> None:
    assert verdict(run([1, 0.5, 0.6, 0.001], [0, 1, -0.5, 0], [0, 5, 5, 0])) == HOLDS


@pytest.mark.parametrize(
    ("V", "bound", "missing", "broken"),
    [
        ([1, 0.5, 0.6, 0.001], [0, 0.05, -0.5, 0], [0, 5, 5, 0], criteria.SATURATION_BOUND),
        ([1, 0.5, 0.505, 0.001], [0, -0.001, -0.5, 0], [0, 5, 5, 0], criteria.RISES_OUTSIDE),
        ([1, 0.5, 1.1, 0.001], [0, 1, -0.5, 0], [0, 5, 5, 0], criteria.SATURATED_ENERGY),
        ([1, 0.5, 0.6, 0.02], [0, 1, -0.5, 0], [0, 5, 5, 0], criteria.ENERGY_AT_END),
    ],
)
def test_each_criterion_of_c20_can_fail(
    V: list[float], bound: list[float], missing: list[float], broken: criteria.Criterion
) -> None:
    made = run(V, bound, missing)
    values = judge(made)
    assert [criterion for criterion in CRITERIA if not criterion.met(values[criterion])] == [broken]
    assert verdict(made) == NOT_REPRODUCED


def test_a_run_without_saturated_ticks_outside_of_the_region_says_nothing_of_it() -> None:
    made = run([1, 0.5, 0.6, 0.001], [0, 1, 0.5, 0], [0, 5, 5, 0])
    values = judge(made)
    assert [criterion for criterion in CRITERIA if not criterion.met(values[criterion])] == [criteria.RISES_OUTSIDE]
    assert verdict(made) == NOT_REPRODUCED
    assert "none of them lies outside" in described(made)


def test_the_excess_is_told_beside_v_at_the_first_saturated_tick() -> None:
    """Beyond (28) by 0.05 at one of two saturated ticks, where V is half of V(0)."""
    made = run([1, 0.5, 0.6, 0.001], [0, 0.05, -0.5, 0], [0, 5, 5, 0])
    assert (
        "beyond (28) at 50.0% of them; in all V_c rises beyond (28) by 5.0e-02 of V_c(0), which is 0.1 times V_c"
        in (described(made))
    )


def test_sampling_is_blamed_only_if_a_shorter_period_comes_nearer_to_the_bound() -> None:
    half = run([1, 0.5, 0.6, 0.001], [0, 0.05, -0.5, 0], [0, 5, 5, 0])
    kept = run([1, 0.5, 0.6, 0.001], [0, 1, -0.5, 0], [0, 5, 5, 0])
    unsaturated = run([1, 0.5], [1, 1], [0, 0])
    assert "at least a part of the cause" in cause(half, kept)
    assert "do not show that sampling is the cause" in cause(half, half)
    assert "Without a saturated tick at the shorter period" in cause(half, unsaturated)
    assert cause(unsaturated, kept) == "So nothing is known of what a shorter period changes"
    assert cause(kept, half) == "dV_c/dt keeps (28) at all saturated ticks of fig6"


def test_a_run_without_saturation_says_nothing() -> None:
    assert verdict(run([1, 0.5], [1, 1], [0, 0])) == NOT_REPRODUCED
