"""The regressors in tip space, (13) and (34): W (p_hat - p) is the difference of the dynamics; (36) is (32).

W = J^-T Y with the code's joint regressor Y (fmus/mechanics/planar_arm.py), against H_x, C_x, g_x, f_x
formed from closed forms.
"""

from functools import cache

import numpy as np
import pytest

from fmus.mechanics.planar_arm import PlanarArm
from tests.property.definitions import outputs
from tests.property.pose import Pose
from tests.property.samples import Samples, evaluate, random_arms
from tests.reference.arm import Arm

SIZE = 200
SECOND = np.random.default_rng(34).uniform(0.3, 3, (6, SIZE))  # a second p, p_hat


@cache
def drawn() -> Samples:
    """Random arms."""
    return random_arms(2, SIZE, seed=1987, regular=True)


def poses() -> list[Pose]:
    """The closed forms at every sample."""
    s = drawn()
    geometry = zip(*s.l, s.gravity[0], s.coulomb_velocity[0], strict=True)
    return [Pose(Arm(*map(float, g)), s.q[:, i], s.dq[:, i]) for i, g in enumerate(geometry)]


def regressors(v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """J^-T Y of the code at tip velocity v and acceleration a, both (SIZE, 2); shape (SIZE, 2, 6)."""
    s = drawn()
    J, dJ = evaluate(PlanarArm(2).jacobian, s.q, s.l), evaluate(PlanarArm(2).jacobian_rate, s.q, s.dq, s.l)
    dq_r = np.linalg.solve(J, v[..., None])
    ddq_r = np.linalg.solve(J, a[..., None] - dJ @ dq_r)
    constants = (s.l, s.gravity, s.coulomb_velocity)
    Y = evaluate(PlanarArm(2).regressor, s.q, s.dq, dq_r[..., 0].T, ddq_r[..., 0].T, *constants)
    return np.linalg.solve(J.transpose(0, 2, 1), Y)


@pytest.mark.parametrize("law", ["W_c", "W_s"])
def test_regressor_gives_the_difference_of_the_dynamics(law: str) -> None:
    at, rng = poses(), np.random.default_rng(13)
    dx, a = np.array([pose.dx for pose in at]), rng.uniform(-30, 30, (SIZE, 2))
    v = dx if law == "W_c" else rng.uniform(-5, 5, (SIZE, 2))
    W = regressors(v, a)
    for i, pose in enumerate(at):
        p_hat, p = SECOND[:, i], drawn().p[:, i]
        difference = pose.force(p_hat, v[i], a[i]) - pose.force(p, v[i], a[i])
        size = sum(
            np.linalg.norm(pose.H_x(some)) * np.linalg.norm(a[i])
            + np.linalg.norm(pose.C_x(some)) * np.linalg.norm(v[i])
            + np.linalg.norm(pose.bias_x(some))
            for some in (p_hat, p)
        )
        miss = np.linalg.norm(W[i] @ (p_hat - p) - difference)
        assert miss <= max(pose.rounding(p), pose.rounding(p_hat)) * size
        assert pose.rounding(p) < 1e-8  # so the bound is far below the difference


def test_both_regressors_agree_where_their_motions_do() -> None:
    """(34) becomes (13) at dx_r = dx, ddx_r = ddx; every column is the force at a unit vector p."""
    at = poses()
    dx, ddx = (
        np.array([pose.dx for pose in at]),
        np.array([p.acceleration(drawn().a[:, i]) for i, p in enumerate(at)]),
    )
    s, J = drawn(), evaluate(PlanarArm(2).jacobian, drawn().q, drawn().l)
    joint = evaluate(PlanarArm(2).regressor, s.q, s.dq, s.dq, s.a, s.l, s.gravity, s.coulomb_velocity)
    measured = np.linalg.solve(J.transpose(0, 2, 1), joint)  # as algorithm 1 has it, from the measured ddq
    for i, (pose, W) in enumerate(zip(at, regressors(dx, ddx), strict=True)):
        expected = pose.W(dx[i], ddx[i])
        tolerance = pose.rounding(drawn().p[:, i]) * np.linalg.norm(expected)
        assert np.linalg.norm(W - expected) <= tolerance
        assert np.linalg.norm(measured[i] - expected) <= tolerance


def test_form_36_is_form_32() -> None:
    """The declared torque of algorithm 2 is J' (W_s p_hat + F_hat - K_d s), all parameters in p."""
    s, at, rng = drawn(), poses(), np.random.default_rng(36)
    x, dx = np.array([pose.x for pose in at]), np.array([pose.dx for pose in at])
    near = {name: rng.normal(0, width, (2, SIZE)) for name, width in (("x_v", 0.01), ("dx_v", 0.3))}
    virtual = {"x_v": near["x_v"] + x.T, "dx_v": near["dx_v"] + dx.T, "ddx_v": rng.normal(0, 20, (2, SIZE))}
    x_t, dx_t = x.T + rng.normal(0, 0.01, (2, SIZE)), dx.T + rng.normal(0, 0.3, (2, SIZE))
    F_hat, Psi, K_d = (
        rng.normal(0, 300, (2, SIZE)),
        rng.uniform(10, 200, (2, SIZE)),
        rng.uniform(10, 300, (2, SIZE)),
    )
    M, B, K = (rng.uniform(low, high, (2, SIZE)) for low, high in ((0.5, 5), (50, 500), (500, 8000)))
    constants = {"l": s.l, "gravity": s.gravity, "coulomb_velocity": s.coulomb_velocity}
    gains = {"Psi": Psi, "K_d": K_d, "M": M, "B": B, "K": K}
    states = {"x_t": x_t, "dx_t": dx_t, "p_hat": SECOND}
    inputs = {"q": s.q, "dq": s.dq, "F_hat": F_hat, **virtual}
    tau = outputs("SlotineLiAdaptiveImpedance", **inputs, **states, **gains, **constants)["tau_cmd"]
    e, de = x.T - x_t, dx.T - dx_t
    ddx_t = virtual["ddx_v"] - (B * (dx_t - virtual["dx_v"]) + K * (x_t - virtual["x_v"]) + F_hat) / M
    v, a, sliding = dx_t - Psi * e, ddx_t - Psi * de, de + Psi * e
    for i, (pose, W_s) in enumerate(zip(at, regressors(v.T, a.T), strict=True)):
        p_hat = SECOND[:, i]
        F = W_s @ p_hat + F_hat[:, i] - K_d[:, i] * sliding[:, i]
        terms = np.linalg.norm(W_s) * np.linalg.norm(p_hat) + np.linalg.norm(F_hat[:, i])
        terms += np.linalg.norm(K_d[:, i] * sliding[:, i])
        terms += np.linalg.norm(pose.H_x(p_hat)) * np.linalg.norm(a[:, i])
        miss = np.linalg.norm(tau[i] - pose.J.T @ F)
        assert miss <= pose.rounding(p_hat) * np.linalg.norm(pose.J) * terms
