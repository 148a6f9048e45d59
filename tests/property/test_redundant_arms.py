"""Redundant arms, n > m: the null space of the conventional law, and algorithm 2 beyond the paper.

    H ds_q/dt + C s_q = Y_r phi + J' (dF_e - K_d s) - d_n D s_q
    dV/dt = -s' K_d s - d_n s_q' D s_q + s' dF_e,   V = (s_q' H s_q + phi' Gamma^-1 phi) / 2

phi = p_hat - p, dF_e = F_hat - F_ext, s_q = dq - dq_r. The right sides are formed in NumPy: dq_r from its definition,
and ddq_r with dH/dt = C + C', which the code does not use.
"""

from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import DefinitionError
from fmus.control.impedance import ArmEstimate, Measured
from fmus.control.redundant_reference import nearest_rate
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.mechanics.algebra import solve_square
from fmus.mechanics.arm import ArmModel
from fmus.mechanics.spatial_model import SpatialArmModel
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from tests.property.meeting import (
    HOGAN,
    PLANAR_REDUNDANT,
    SLOTINE_LI,
    TOLERANCE,
    TS,
    closed_loop,
    meeting,
    norm,
    rounding_of_steps,
)
from tests.property.samples import EPS, evaluate
from tests.property.spatial_robots import robot
from tests.property.task_space import apply

ARMS = (PLANAR_REDUNDANT, "Panda")
each_arm = pytest.mark.parametrize("name", ARMS)
DAMPING, STIFFNESS = 10.0, 25.0  # 1/s and 1/s2, start values


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar product at each sample."""
    return (a * b).sum(axis=1)


def transposed(matrices: np.ndarray) -> np.ndarray:
    """Transpose of the matrix at each sample."""
    return matrices.transpose(0, 2, 1)


@cache
def pseudo_inverse(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """H_0^-1 J' W_0^-1, its time derivative, shape (size, n, m), and D, shape (size, n, n); with H_0 at p_start."""
    at = meeting(name)
    arms, p = at.arms, at.nominal
    H, J, dJ = arms.H(p), arms.J, arms.dJ
    dH = arms.C(p) + transposed(arms.C(p))
    G = np.linalg.inv(H)
    dG = -G @ dH @ G
    W = J @ G @ transposed(J)
    dW = dJ @ G @ transposed(J) + J @ dG @ transposed(J) + J @ G @ transposed(dJ)
    right = G @ transposed(J) @ np.linalg.inv(W)
    rate = (dG @ transposed(J) + G @ transposed(dJ) - right @ dW) @ np.linalg.inv(W)
    return right, rate, H - transposed(J) @ np.linalg.solve(W, J)


@cache
def reference(name: str) -> tuple[np.ndarray, np.ndarray]:
    """dq_r and ddq_r of the closed loop of algorithm 2."""
    at, loop = meeting(name), closed_loop(name, SLOTINE_LI)
    arms, given = at.arms, loop.given
    right, rate, _ = pseudo_inverse(name)
    dx_r, ddx_r = given["dx_t"] - given["Psi"] * loop.e, loop.ddx_t - given["Psi"] * loop.de
    pull = STIFFNESS / DAMPING
    dq_0, ddq_0 = -pull * (given["q"] - given["posture"]), -pull * given["dq"]
    missing = dx_r - apply(arms.J, dq_0)
    growing = ddx_r - apply(arms.dJ, dq_0) - apply(arms.J, ddq_0)
    return dq_0 + apply(right, missing), ddq_0 + apply(rate, missing) + apply(right, growing)


@each_arm
def test_samples_are_well_conditioned(name: str) -> None:
    at = meeting(name)
    assert at.size >= 200
    assert at.arms.n > at.arms.x.shape[1]
    # W_0 and H_0 are inverted one after the other, where the square laws invert one matrix.
    assert max(at.arms.roundings(p).max() for p in (at.p, at.p_hat)) < TOLERANCE


@each_arm
def test_form_5_gives_the_tip_the_target_impedance_whatever_the_null_space_does(name: str) -> None:
    at, loop = meeting(name), closed_loop(name, HOGAN)
    given, arms = loop.given, at.arms
    demand = (
        given["ddx_v"] - (given["B"] * (arms.dx - given["dx_v"]) + given["K"] * (arms.x - given["x_v"])) / given["M"]
    )
    demand = demand - loop.F_hat / given["M"]
    # The arm feels F_ext, and the law compensates F_hat: the difference accelerates the tip through its mobility.
    mobility = arms.J @ np.linalg.solve(arms.H(at.p), transposed(arms.J))
    expected = demand + apply(mobility, loop.F_hat - loop.F_ext)
    size = norm(demand) + norm(apply(arms.dJ, arms.rates)) + norm(mobility) * (norm(loop.F_hat) + norm(loop.F_ext))
    through = norm(arms.J @ np.linalg.inv(arms.H(at.p)))
    size += through * norm(loop.shown["tau_cmd"])
    assert (norm(loop.ddx - expected) <= TOLERANCE * size).all()


def test_damping_and_posture_work_in_the_null_space_alone() -> None:
    """Of the conventional law in space; test_impedance_forms.py has the damping of planar arms."""
    name = "Panda"
    at = meeting(name)
    arms, size = at.arms, at.size
    given = closed_loop(name, HOGAN).given

    def torque(damping: float, stiffness: float) -> np.ndarray:
        gains = {"null_damping": np.full((size, 1), damping), "null_stiffness": np.full((size, 1), stiffness)}
        return at.evaluate(HOGAN, given | gains)["tau_cmd"]

    free = torque(0, 0)
    through = arms.J @ np.linalg.inv(arms.H(at.p))
    rounding = arms.roundings(at.p) * norm(through)
    for motion, tau in (
        (given["dq"], torque(DAMPING, 0) - free),
        (given["q"] - given["posture"], torque(0, STIFFNESS) - free),
    ):
        work = dot(tau, motion)
        assert (norm(apply(through, tau)) <= rounding * (norm(free) + norm(tau))).all()
        assert (work <= norm(motion) * (norm(free) + norm(tau)) * arms.roundings(at.p)).all()
        assert np.median(work) < -0.01  # W or J: damping takes energy, and the posture draws nearer
    both = torque(DAMPING, STIFFNESS) - free
    apart = torque(DAMPING, 0) + torque(0, STIFFNESS) - 2 * free
    assert (norm(both - apart) <= 20 * EPS * (norm(free) + norm(both) + norm(apart))).all()


@each_arm
def test_algorithm_2_obeys_its_error_dynamics_and_its_lyapunov_function_falls(name: str) -> None:
    at, loop = meeting(name), closed_loop(name, SLOTINE_LI)
    arms, given, shown = at.arms, loop.given, loop.shown
    dq_r, ddq_r = reference(name)
    D = pseudo_inverse(name)[2]
    s_q, ds_q, phi = given["dq"] - dq_r, loop.ddq - ddq_r, at.p_hat - at.p
    s, error, K_d = apply(arms.J, s_q), loop.F_hat - loop.F_ext, given["K_d"]
    np.testing.assert_allclose(s, loop.de + given["Psi"] * loop.e, rtol=0, atol=1e-11 * norm(s).max())
    np.testing.assert_allclose(shown["s"], s, rtol=0, atol=1e-11 * norm(s).max())

    H, C, Y_r = arms.H(at.p), arms.C(at.p), arms.Y(dq_r, ddq_r)
    left = apply(H, ds_q) + apply(C, s_q)
    of_tip = apply(transposed(arms.J), error - K_d * s)
    right = apply(Y_r, phi) + of_tip - DAMPING * apply(D, s_q)
    size = norm(H) * (norm(loop.ddq) + norm(ddq_r)) + norm(C) * (norm(given["dq"]) + norm(dq_r)) + norm(apply(Y_r, phi))
    size += norm(arms.J) * (norm(loop.F_hat) + norm(loop.F_ext) + norm(K_d * s)) + DAMPING * norm(D) * norm(s_q)
    assert (norm(left - right) <= TOLERANCE * size).all()

    rate = (shown["p_hat_next"] - given["p_hat"]) / TS
    learning = phi / given["Gamma"] * rate
    growth = dot(s_q, left) + learning.sum(axis=1)  # s_q' dH/dt s_q / 2 is s_q' C s_q
    taken, hidden = dot(s, K_d * s), DAMPING * dot(s_q, apply(D, s_q))
    expected = -taken - hidden + dot(s, error)
    allowed = TOLERANCE * (norm(s_q) * size + np.abs(learning).sum(axis=1))
    assert (np.abs(growth - expected) <= allowed + rounding_of_steps(at.p_hat, phi, given["Gamma"])).all()
    assert (hidden >= -TOLERANCE * norm(D) * norm(s_q) ** 2).all()  # so dV/dt <= 0 without errors of the force
    assert np.median(hidden / allowed) > 1e4  # the damping of the null space is far above the tolerance


@each_arm
def test_the_damping_of_algorithm_2_does_not_push_the_tip(name: str) -> None:
    """J H_0^-1 D = 0, and its null space is all that D does not damp."""
    at = meeting(name)
    D = pseudo_inverse(name)[2]
    through = at.arms.J @ np.linalg.inv(at.arms.H(at.nominal))
    assert (norm(through @ D) <= at.arms.roundings(at.nominal) * norm(through) * norm(D)).all()
    n, m = at.arms.n, at.arms.x.shape[1]
    values = np.linalg.eigvalsh(D)
    assert (values[:, :m] <= TOLERANCE * values[:, -1:]).all()
    assert (values[:, m:] > 1e-3 * values[:, -1:]).all()
    assert values[:, m:].shape[1] == n - m


@cache
def arm(name: str) -> ArmModel:
    """Equations of an arm in space."""
    return SpatialArmModel(robot(name).arm, ca.SX(ca.DM((0, 0, -9.81))), ca.SX(0.1), ca.SX.eye(3))


def nearest(name: str) -> tuple[list[ca.SX], ca.SX, ca.SX]:
    """Arguments of `nearest_rate` as symbols, and what it gives."""
    model = arm(name)
    n = model.n
    q, dq, dq_0, ddq_0 = (ca.SX.sym(which, n) for which in ("q", "dq", "dq_0", "ddq_0"))
    p, dx_r, ddx_r = ca.SX.sym("p", len(model.parameters)), ca.SX.sym("dx_r", 6), ca.SX.sym("ddx_r", 6)
    dq_r, ddq_r = nearest_rate(Measured(q, dq, ca.SX(6, 1)), ArmEstimate(model, p), (dx_r, ddx_r), (dq_0, ddq_0))
    return [q, dq, p, dx_r, ddx_r, dq_0, ddq_0], dq_r, ddq_r


def columns(name: str, size: int = 200) -> list[np.ndarray]:
    """Numbers for the arguments of `nearest`, near the start of the arm."""
    one, rng = robot(name), np.random.default_rng(7)
    q = np.array(one.start.q)[:, None] + rng.uniform(-0.3, 0.3, (one.n, size))
    drawn = [rng.uniform(-2, 2, (k, size)) for k in (one.n, 6, 6, one.n, one.n)]
    return [q, drawn[0], np.tile(np.array(one.p_start)[:, None], size), *drawn[1:]]


@pytest.mark.parametrize("name", ["Panda", "PUMA"])
def test_the_acceleration_is_the_derivative_of_the_nearest_rate(name: str) -> None:
    """By CasADi's differentiation of dq_r, along q, dx_r and dq_0."""
    arguments, dq_r, ddq_r = nearest(name)
    q, dq, _, dx_r, ddx_r, dq_0, ddq_0 = arguments
    derived = sum((ca.jtimes(dq_r, x, dx) for x, dx in ((q, dq), (dx_r, ddx_r), (dq_0, ddq_0))), ca.SX(dq.shape[0], 1))
    both = ca.Function("both", arguments, [ca.horzcat(ddq_r, derived)])
    found = evaluate(both, *columns(name))
    np.testing.assert_allclose(found[..., 0], found[..., 1], rtol=0, atol=1e-10 * np.abs(found).max())


def test_for_a_square_jacobian_the_nearest_rate_is_that_of_the_inverse() -> None:
    """With n = m there is no choice: dq_0 does not matter, and dq_r and ddq_r are those of algorithm 2 in the paper."""
    arguments, dq_r, ddq_r = nearest("PUMA")
    q, dq, _, dx_r, ddx_r, *_ = arguments
    model = arm("PUMA")
    J = model.jacobian(q)
    rate = solve_square(J, dx_r)
    acceleration = solve_square(J, ddx_r - ca.mtimes(model.jacobian_rate(q, dq), rate))
    both = ca.Function("both", arguments, [ca.horzcat(dq_r, rate, ddq_r, acceleration)])
    found = evaluate(both, *columns("PUMA"))
    for one in (0, 2):
        mine, inverse = found[..., one], found[..., one + 1]
        # Its terms with dq_0 cancel; the condition of J^2 H stays below 1e5 at these states.
        np.testing.assert_allclose(mine, inverse, rtol=0, atol=1e-10 * np.abs(found).max())


def test_laws_that_invert_the_jacobian_refuse_a_redundant_arm_in_space() -> None:
    panda: Any = robot("Panda")
    reason = "needs as many joints as task coordinates, .* has 7 joints and 6 task coordinates"
    with pytest.raises(DefinitionError, match=f"^Mine: algorithm 1 {reason}"):
        craig_adaptive_impedance("Mine", panda)
    with pytest.raises(DefinitionError, match=f"^Mine: algorithm 2 without C_x s {reason}"):
        slotine_li_adaptive_impedance("Mine", panda, coriolis_of_s=False)
