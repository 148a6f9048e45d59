"""Tests of predicted stability, against maps that are derived by hand.

A radius is compared within 1e-9 unless a comment gives another tolerance. The models of these linear components have
errors of 1e-12. Their eigenvalues are simple, with condition numbers below 1e2 for q >= 1e-4.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from orchestration import System, SystemDescriptionError, simulate
from orchestration.analysis.stability.verdict import Verdict, stability
from orchestration.master.algorithm import NEWTON, PARALLEL, Algorithm, Correction
from tests.reference.problems import PROBLEMS, damper_pair, force_displacement, wall
from tests.unit.orchestration.small_models import H, system

M_WALL, K_WALL = 1.0, 100.0
ACCURACY = 1e-9


def radius(M: np.ndarray) -> float:
    return float(np.abs(np.linalg.eigvals(M)).max())


def at_wall(h: float) -> System:
    return wall.system(h, 1.0, m=M_WALL, k=K_WALL)


@pytest.mark.parametrize("q", [1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize(("algorithm", "share"), [("gauss-seidel", 0.25), ("jacobi", 0.75)])
def test_a_wall_grows_as_theory_says(algorithm: str, share: float, q: float) -> None:
    h = np.sqrt(q * M_WALL / K_WALL)
    verdict = stability(at_wall(h), algorithm=algorithm)
    assert not verdict.stable
    assert verdict.radius == pytest.approx(wall.growth(algorithm, h, M_WALL, K_WALL), abs=ACCURACY)
    assert verdict.radius - 1 == pytest.approx(share * q, rel=0.02)
    assert verdict.growth_rate == pytest.approx(share * q / h, rel=0.02)
    assert verdict.largest_stable_step is None
    assert "no step is stable" in verdict.advice[0]


@pytest.mark.parametrize(
    "algorithm",
    [
        Algorithm("held"),
        Algorithm("line", order=1),
        Algorithm("old parabola", PARALLEL, 2),
        Algorithm("implicit parabola", PARALLEL, 2, Correction(NEWTON)),
        Algorithm("two sweeps", PARALLEL, correction=Correction(sweeps=2)),
    ],
    ids=lambda algorithm: algorithm.name,
)
def test_the_verdict_is_what_a_run_shows(algorithm: Algorithm) -> None:
    h, n = 2e-2, 1500
    verdict = stability(at_wall(h), algorithm=algorithm)
    run = simulate(at_wall(h), stop_time=n * h, algorithm=algorithm)
    energy = wall.energy(run, m=M_WALL, k=K_WALL)
    # The energy oscillates within a period. The largest value of ten periods is the peak within 1 %, and log E changes
    # by at least 0.1.
    window = round(10 * 2 * np.pi / 10 / h)
    measured = np.log(energy[-window:].max() / energy[:window].max()) / (2 * (n + 1 - window))
    assert measured == pytest.approx(np.log(verdict.radius), rel=0.02)


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("h", [1e-3, 1e-2, 0.1])
def test_two_masses_match_their_exact_map(algorithm: str, h: float) -> None:
    verdict = stability(force_displacement.system(h, 1.0), algorithm=algorithm)
    expected = radius(force_displacement.step_map(algorithm, h))
    assert verdict.radius == pytest.approx(expected, abs=ACCURACY)
    assert verdict.threshold < 1e-8


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_a_stiff_damper_limits_the_step(algorithm: str) -> None:
    m1, d_c, ratio = 1.0, 1e3, 10.0

    def excess(q: float) -> float:
        E = np.exp(-q / ratio)
        M = np.array([[(1 - q) * E]]) if algorithm == "gauss-seidel" else np.array([[E, -q], [E, 0]])
        return radius(M) - 1

    root = brentq(excess, 0.5, 5.0)
    assert isinstance(root, float)
    limit = root * m1 / d_c
    made = damper_pair.system(1e-3, 1.0, k1=0.0)
    for step in (0.3e-3, 5e-3):
        verdict = stability(made, step, algorithm)
        assert verdict.stable == (step < limit)
        assert verdict.largest_stable_step == pytest.approx(limit, rel=0.011)  # found within 1 %


def test_a_stable_step_above_an_unstable_step_is_reported() -> None:
    verdict = stability(damper_pair.system(4e-2, 1.0))
    assert verdict.stable  # q = 40 > 35.6: the docstring of the problem calls this stable and wrong
    assert verdict.largest_stable_step == pytest.approx(2.25e-3, rel=0.02)
    assert "too long to see" in verdict.advice[0]


@pytest.mark.parametrize(("algorithm", "power"), [("gauss-seidel", 1.0), ("jacobi", 0.5)])
def test_an_algebraic_loop_is_repeated_step_by_step(algorithm: str, power: float) -> None:
    # b = 0 removes the state from the loop. All values are zero, so that initialization is already a solution.
    made = PROBLEMS["feedthrough"].system(1e-2, 1.0, d=1.5, g=-2.0, b=0.0, r=0.0, x=0.0)
    verdict = stability(made, algorithm=algorithm)
    assert verdict.radius == pytest.approx(3.0**power, abs=ACCURACY)
    assert verdict.largest_stable_step is None
    assert any(sentence.startswith("newton with order 0 is stable") for sentence in verdict.advice)


def implicit(order: int, h: float) -> np.ndarray:
    """Map of (x, v) over a step; the force is that of the end, or a line from the start to the end."""
    w = K_WALL / M_WALL
    start, end = ((0.0, 0.5), (0.0, 1.0)) if order == 0 else ((1 / 3, 1 / 6), (1 / 2, 1 / 2))
    left = np.array([[1 + w * h**2 * start[1], 0], [w * h * end[1], 1]])
    right = np.array([[1 - w * h**2 * start[0], h], [-w * h * end[0], 1]])
    return np.linalg.solve(left, right)


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("correction", [Correction(), Correction(NEWTON)])
def test_corrected_inputs_are_those_of_the_end(order: int, correction: Correction) -> None:
    h = 1e-2
    for exchange in (PARALLEL, "sequential"):
        verdict = stability(at_wall(h), algorithm=Algorithm("own", exchange, order, correction))
        assert verdict.radius == pytest.approx(radius(implicit(order, h)), abs=ACCURACY)
        assert verdict.stable
        q, x_of_F = K_WALL * h**2 / M_WALL, (1 / 2, 1 / 6)[order]
        contraction = q * x_of_F  # F -> x -> F once round; two sweeps if both are assumed
        expected = np.sqrt(contraction) if exchange == PARALLEL else contraction
        assert verdict.contraction == pytest.approx(expected, abs=ACCURACY)


def lagrange(nodes: list[float], h: float) -> np.ndarray:
    """Coefficients of the polynomial through values at the times `nodes` * h, s; one row per power of time."""
    return np.linalg.inv(np.vander(np.array(nodes) * h, increasing=True))


@pytest.mark.parametrize("order", [1, 2])
def test_extrapolated_inputs_continue_the_past(order: int) -> None:
    h, n = 1e-2, order + 1
    verdict = stability(at_wall(h), algorithm=Algorithm("own", order=order))
    # z = (v, x_0, ..., x_-p, F_0, ..., F_-(p-1)). The wall extrapolates x from past values; the mass also uses F_1.
    unit = np.eye(1 + n + order)
    v, x, F = unit[0], unit[1 : 1 + n], unit[1 + n :]
    powers = h ** np.arange(n)
    F_new = -K_WALL * powers @ lagrange([-float(a) for a in range(n)], h) @ x
    course = lagrange([1.0, *(-float(a) for a in range(order))], h) @ np.vstack([F_new, F])  # of F, by power
    a = np.arange(n)
    v_new = v + (powers * h / (a + 1)) @ course / M_WALL
    x_new = x[0] + h * v + (powers * h**2 / (a + 1) / (a + 2)) @ course / M_WALL
    expected = np.vstack([v_new, x_new, x[:-1], F_new, F[:-1]])
    assert verdict.radius == pytest.approx(radius(expected), abs=ACCURACY)


@pytest.mark.parametrize(("order", "first"), [("relay plant", True), ("plant relay", False)])
def test_ticks_every_second_step(small: dict[str, Path], order: str, first: bool) -> None:
    units = {"relay": "Relay", "plant": "Integrator"}
    links = "plant.x -> relay.u\nrelay.y -> plant.u"
    made = system(small, {name: units[name] for name in order.split()}, links)
    h = H / 2
    plant, relay = np.array([[1, h], [0, 1]]), np.array([[1, 0], [2, 0]])  # of (x, y), y = 2 x at the tick
    tick = plant @ relay if first else relay @ plant
    verdict = stability(made, h)
    assert verdict.radius == pytest.approx(np.sqrt(radius(plant @ tick)), abs=ACCURACY)


def test_blame_and_advice() -> None:
    verdict = stability(at_wall(1e-2))
    assert {str(connection) for connection, _ in verdict.blame[:2]} == {"mass.x -> wall.x", "wall.F -> mass.F"}
    h, q = 1e-2, 1e-2
    assert verdict.blame[0][1] == pytest.approx(q / 4, rel=0.02)  # rho - 1 = k h^2 / (4 m) is linear in the gain
    assert verdict.blame[2][1] == pytest.approx(0, abs=1e-6)  # v has no influence, because there is no damper
    assert any("newton or iterative with order 0 is stable" in sentence for sentence in verdict.advice)
    text = str(verdict)
    assert f"gauss-seidel with a step of {h:g} s is UNSTABLE" in text
    assert "none is stable" in text
    assert "wall.F -> mass.F" in text


def test_a_verdict_at_a_later_time() -> None:
    now, later = stability(at_wall(1e-2)), stability(at_wall(1e-2), at=0.5)
    assert later.radius == pytest.approx(now.radius, abs=ACCURACY)


def test_free_masses_are_stable() -> None:
    made = force_displacement.system(1e-2, 1.0, k1=0.0, k2=0.0, d_c=2.0)
    verdict = stability(made, algorithm=Algorithm("own", PARALLEL, 1, Correction(NEWTON)))
    # Lines through both ends of a step reproduce a common motion exactly. The map has a double eigenvalue 1, which
    # noise of 1e-13 splits by the square root of its size.
    assert verdict.stable
    assert verdict.radius == pytest.approx(1, abs=1e-5)
    assert verdict.threshold < 1e-4
    # Held positions are late by h v. So a force acts on a common motion, and the exact map is unstable as well.
    held = stability(made)
    expected = radius(force_displacement.step_map("gauss-seidel", 1e-2, k1=0.0, k2=0.0, d_c=2.0))
    assert expected > 1 + 1e-4
    assert held.radius == pytest.approx(expected, abs=1e-7)
    assert not held.stable


def test_a_system_without_feedback_is_stable(small: dict[str, Path]) -> None:
    verdict = stability(system(small, {"a": "Integrator", "b": "Integrator"}, "a.x -> b.u"), H)
    assert verdict.radius == 0
    assert verdict.largest_stable_step == np.inf


def test_fig2_settles_as_its_target_impedance(fig2: System) -> None:
    verdict = stability(fig2)
    assert verdict.stable
    # The target impedance of 2 kg and 4000 N/m is critically damped, with a double pole at 44.7/s. During the
    # experiment the arm moves by 2 rad/s * 13 * 0.1 ms = 0.3 %, which splits a double pole by sqrt(0.003) = 6 %.
    assert -verdict.growth_rate == pytest.approx(np.sqrt(4000 / 2), rel=0.1)
    assert verdict.largest_stable_step is not None
    assert verdict.largest_stable_step > 1e-3


def test_invalid_arguments_are_refused() -> None:
    for step in (0.0, -1.0, np.nan):
        with pytest.raises(SystemDescriptionError, match=r"must be positive|give a finite number"):
            stability(at_wall(1e-2), step)
    with pytest.raises(SystemDescriptionError, match="There is no algorithm"):
        stability(at_wall(1e-2), algorithm="magic")


def test_a_page_shows_what_hides_in_a_verdict() -> None:
    verdict = Verdict("s\u202e", "jacobi", 0.1, None, 1.0, 1e-9, None, None, (), ("Use <b>\u2066 less.",))
    page = verdict._repr_html_()
    assert not set(page) & set("\u202e\u2066")
    assert page.startswith("<pre>s\\u202e: jacobi with a step of 0.1 s is stable as far as can be seen\n  radius ")
    assert page.endswith("\n  - Use &lt;b&gt;\\u2066 less.</pre>")
