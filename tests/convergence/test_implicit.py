"""Corrected steps are implicit steps: each input is held over a step at the value that its source shows at the end.

For linear components z+ = Phi z + Gamma u with u = K z+ + L u + r, an implicit step is a linear system for the end of
the step. The tests solve this system with the closed forms of `tests.reference.problems`.
"""

import numpy as np
import pytest

from orchestration import SimulationError, simulate
from orchestration.master.algorithm import (
    DIFFERENCES,
    DIRECTIONAL,
    FIXED_POINT,
    NEWTON,
    PARALLEL,
    SEQUENTIAL,
    Algorithm,
    Correction,
    Tolerance,
)
from tests.reference.problems import damper_pair, feedthrough, force_displacement
from tests.reference.problems.problem import held
from tests.reference.problems.two_masses import Numbers

TOLERANCE = 1e-11
STATES = ["left.x", "left.v", "right.x", "right.v"]


def corrected(exchange: str, method: str, jacobian: str = DIFFERENCES) -> Algorithm:
    """Return an algorithm whose inputs are held at the values of the end of the step."""
    return Algorithm("held", exchange, correction=Correction(method, Tolerance(TOLERANCE), jacobian=jacobian))


def implicit_map(h: float, **numbers: float) -> np.ndarray:
    """Return the map of (x1, v1, x2, v2) over a step h, s, shape (4, 4), with all inputs taken at t + h."""
    n = Numbers(**numbers)
    Phi_1, Gamma_1 = held(np.array([[0, 1], [-n.k1 / n.m1, -n.d1 / n.m1]]), np.array([[0], [1 / n.m1]]), h)
    own_2 = np.array([[0, 1], [-(n.k2 + n.k_c) / n.m2, -(n.d2 + n.d_c) / n.m2]])
    Phi_2, Gamma_2 = held(own_2, np.array([[0, 0], [n.k_c / n.m2, n.d_c / n.m2]]), h)
    K = np.array([[n.k_c, n.d_c]])
    own = np.block([[Phi_1, np.zeros((2, 2))], [np.zeros((2, 2)), Phi_2]])
    coupling = np.block([[-Gamma_1 @ K, Gamma_1 @ K], [Gamma_2, np.zeros((2, 2))]])
    return np.linalg.solve(np.eye(4) - coupling, own)


@pytest.mark.parametrize("method", [FIXED_POINT, NEWTON])
@pytest.mark.parametrize("exchange", [SEQUENTIAL, PARALLEL])
def test_every_step_is_the_implicit_one(exchange: str, method: str) -> None:
    h = 1e-2
    result = simulate(force_displacement.system(h, 2.0), algorithm=corrected(exchange, method))
    rows = np.column_stack([result[column] for column in STATES])
    one = implicit_map(h)
    scale = np.abs(rows[:-1]) @ np.abs(one.T)
    # Runge-Kutta 4 misses 1e-14 here (10 sub-steps at 6 rad/s). An input differs from its source by at most
    # 1e-11 (1 + |F|), with |F| < 10 N. This moves v by h / m1 of the difference, 1e-12. The last sweep is far closer.
    assert (np.abs(rows[1:] - rows[:-1] @ one.T) <= 1e-12 + 1e-13 * scale).all()
    # The step of Gauss-Seidel is another step by far.
    assert np.abs(one - force_displacement.step_map("gauss-seidel", h)[:4, :4]).max() > 0.1


@pytest.mark.parametrize("exchange", [SEQUENTIAL, PARALLEL])
def test_newton_makes_the_implicit_step_of_a_stiff_pair(exchange: str) -> None:
    """The pair has q = d_c h / m1 = 10, where Gauss-Seidel and Jacobi diverge."""
    h = 1e-2
    result = simulate(damper_pair.system(h, 0.4), algorithm=corrected(exchange, NEWTON))
    rows = np.column_stack([result[column] for column in STATES])
    one = implicit_map(h, **damper_pair.DAMPED)
    # right.F = d_c (v2 - v1) is met within 1e-11 (1 + |F|), with |F| <= 1200 N. F moves v1 by h / m1, and through the
    # implicit step itself by q less: 1.2e-10 in v1. Runge-Kutta 4 misses 8e-11 (`test_orders_known`).
    assert (np.abs(rows[1:] - rows[:-1] @ one.T) <= 2.5e-10).all()
    assert np.abs(np.linalg.eigvals(one)).max() <= 1


@pytest.mark.parametrize(
    "algorithm",
    [
        corrected(SEQUENTIAL, FIXED_POINT),  # one value is assumed: Aitken's relaxation is the secant method
        corrected(SEQUENTIAL, NEWTON),
        corrected(PARALLEL, NEWTON),
        corrected(PARALLEL, NEWTON, DIRECTIONAL),
    ],
    ids=["secant", "newton sequential", "newton", "directional"],
)
@pytest.mark.parametrize("numbers", [{}, feedthrough.CONTRACTING, feedthrough.EXPANDING], ids=["none", "-1/2", "-3"])
def test_an_algebraic_loop_is_solved_at_every_step(numbers: dict[str, float], algorithm: Algorithm) -> None:
    """Each step solves u = g (c x+ + d u) + r with x+ = Phi x + Gamma u, also where repetition diverges (|d g| > 1)."""
    h, n = 1e-2, feedthrough.Numbers(**numbers)
    result = simulate(feedthrough.system(h, 1.0, **numbers), algorithm=algorithm)
    Phi, Gamma = (float(m[0, 0]) for m in held(np.array([[n.a]]), np.array([[n.b]]), h))
    x = result["plant.x"]
    u = (n.g * n.c * Phi * x[:-1] + n.r) / (1 - n.g * (n.c * Gamma + n.d))
    # Inputs and sources agree within 1e-11 (1 + 2). The solution differs from both by at most that over |1 - d g| >= 1,
    # and once more by the factor |g| = 2 in u.
    np.testing.assert_allclose(x[1:], Phi * x[:-1] + Gamma * u, rtol=0, atol=1e-10)
    np.testing.assert_allclose(result["gain.y"][1:], u, rtol=0, atol=1e-10)


def test_directional_derivatives_see_the_feedthrough() -> None:
    """Directional derivatives let Newton's method converge at d g = -3, where fixed-point iteration diverges."""
    system = feedthrough.system(1e-2, 1.0, **feedthrough.EXPANDING)
    result = simulate(system, algorithm=corrected(PARALLEL, NEWTON, DIRECTIONAL))
    # The Jacobian leaves out c Gamma = h. Two iterations, in which each value passes both components, leave
    # |g| h / (1 - d g) = 5e-3 of a residual of at most 1. To reach 1e-11 takes 2 ln(1e11) / ln(200) = 9.6 iterations,
    # and one sweep before.
    assert int(result.metadata["sweeps"]) <= 11 * 100


def test_no_convergence_is_an_error_with_residual_connection_and_advice() -> None:
    """Three sweeps are too few to relax three values of the stiff damper, while Newton's method needs two."""
    stop, step = 0.05, 1e-3  # s
    iterative = Algorithm("iterative", PARALLEL, correction=Correction(max_iterations=3))
    message = (
        r"Connection right\.F -> left\.F at t = [\d.e-]+ s \(step \d+\): no convergence after 3 sweeps,"
        r" the residual is [-\d.e]+ N, accepted [\d.e-]+; use algorithm newton, or smaller steps\."
    )
    with pytest.raises(SimulationError, match=message) as caught:
        simulate(damper_pair.system(step, stop), algorithm=iterative)
    result = caught.value.result
    assert result is not None
    assert len(result.time) < round(stop / step)  # only the rows before the error
    newton = Algorithm("newton", PARALLEL, correction=Correction(NEWTON, max_iterations=3))
    newton = simulate(damper_pair.system(step, stop), algorithm=newton)
    assert len(newton.time) == round(stop / step) + 1
    few = Algorithm("few", PARALLEL, correction=Correction(NEWTON, max_iterations=1))
    with pytest.raises(SimulationError, match=r"no convergence after 1 sweeps, .*; use smaller steps\."):
        simulate(damper_pair.system(step, stop), algorithm=few)
