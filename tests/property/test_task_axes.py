"""Coordinates of controllers in space: axes of the gains (`task_rpy`), and angles beyond a half turn."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmus.mechanics import turned_task
from fmus.robots.spatial_robot import rotation_matrix
from tests.property.definitions import evaluator
from tests.property.meeting import CRAIG, HOGAN, LAWS, SLOTINE_LI, SPONG_ORTEGA, TOLERANCE, closed_loop, meeting, norm
from tests.property.spatial_robots import robot
from tests.property.task_space import apply

PUMA = "PUMA"
PUSH = 25.0  # N
K = (900.0, 2500.0, 6000.0, 40.0, 60.0, 90.0)  # N/m and N.m/rad


def along_the_base() -> tuple[np.ndarray, np.ndarray]:
    """The frame of the gains at each sample, T of shape (size, 6, 6), and the tip's acceleration in base axes."""
    at, loop = meeting(PUMA), closed_loop(PUMA, HOGAN)
    turned = Rotation.from_euler("xyz", loop.given["task_rpy"]).as_matrix()
    whole = np.zeros((at.size, 6, 6))
    whole[:, :3, :3] = whole[:, 3:, 3:] = turned
    return whole, apply(whole, loop.ddx)


def test_the_tip_has_the_full_matrices_of_the_turned_gains() -> None:
    """M' (ddx - ddx_v) + B' (dx - dx_v) + K' (x - x_v) = -F_hat in the axes of the base, with K' = T diag(K) T'."""
    at, loop = meeting(PUMA), closed_loop(PUMA, HOGAN)
    T, ddx = along_the_base()
    given, arms = loop.given, at.arms
    M, B, K_full = (T @ (given[name][:, :, None] * T.transpose(0, 2, 1)) for name in ("M", "B", "K"))
    base = {name: arms.in_base(given[name]) for name in ("x_v", "dx_v", "ddx_v")}
    x, dx = arms.in_base(arms.x), arms.in_base(arms.dx)
    F_hat, F_ext = arms.in_base(loop.F_hat), arms.in_base(loop.F_ext)
    mobility = np.linalg.inv(T @ arms.H_x(at.p) @ T.transpose(0, 2, 1))
    ddx = ddx - apply(mobility, F_hat - F_ext)  # what the error of the measured force does
    terms = [apply(M, ddx - base["ddx_v"]), apply(B, dx - base["dx_v"]), apply(K_full, x - base["x_v"]), F_hat]
    size = sum(norm(term) for term in terms) + norm(M) * norm(mobility) * (norm(F_hat) + norm(F_ext))
    size += norm(M) * norm(arms.J) * norm(loop.ddq)
    assert (norm(np.sum(terms, axis=0)) <= TOLERANCE * size).all()
    diagonal = np.abs(K_full[:, 0, 1]) / K_full[:, 0, 0]
    assert np.median(diagonal) > 0.05  # the axes are turned


@pytest.mark.parametrize("axis", range(6))
def test_a_static_push_along_a_turned_axis_deflects_the_tip_along_it(axis: int) -> None:
    """At rest under a force f along an axis, the arm is in balance where the tip is f/K behind its virtual position."""
    arm, rpy = robot(PUMA), (0.4, -0.7, 1.1)
    size, force = 1, PUSH if axis < 3 else 0.1 * PUSH
    x = np.array(arm.start.x_v)[:, None]
    R = rotation_matrix(rpy)
    direction = np.zeros((6, 1))
    direction[3 * (axis // 3) : 3 * (axis // 3) + 3, 0] = R[:, axis % 3]
    given = {
        "q": np.array(arm.start.q)[:, None],
        "dq": np.zeros((6, size)),
        "x_v": x + force / K[axis] * direction,
        "dx_v": np.zeros((6, size)),
        "ddx_v": np.zeros((6, size)),
        "x_t": x,
        "dx_t": np.zeros((6, size)),
        "K": np.array(K)[:, None],
        "task_rpy": np.array(rpy)[:, None],
        "F_hat": force * direction,  # the angles of the start are 0: their forces are the moments
    }
    given["p_start"] = np.array(arm.p_start)[:, None]
    tau = evaluator(LAWS[HOGAN](arm))(**given)["tau_cmd"][0]
    held = arm.arm.gravity_torque(arm.start.q, arm.chain.p, (0.0, 0.0, -9.81))
    J = np.array(arm.arm.jacobian(arm.start.q))
    balance = np.array(held).ravel() + J.T @ (force * direction[:, 0])
    # x_v is rounded to 1e-10 m, which K turns into torques.
    np.testing.assert_allclose(tau, balance, rtol=0, atol=1e-10 * max(K) * 10)
    assert np.abs(tau - np.array(held).ravel()).max() > 0.1  # N.m: the push is felt


@pytest.mark.parametrize("law", [HOGAN, CRAIG, SLOTINE_LI, SPONG_ORTEGA])
def test_axes_that_are_not_turned_change_no_bit(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    at, loop = meeting(PUMA), closed_loop(PUMA, law)
    given = {name: values.T for name, values in loop.given.items() if name != "task_rpy"}
    states = {"a_f": loop.ddq.T, "ddq": loop.ddq.T} if law == SPONG_ORTEGA else {"ddq": loop.ddq.T}
    turned = evaluator(LAWS[law](robot(PUMA)))(**given, **states)
    monkeypatch.setattr(turned_task, "_blocks", lambda _, v: v)
    plain = evaluator(LAWS[law](robot(PUMA)))(**given, **states)
    assert turned.keys() == plain.keys()
    for name, values in plain.items():
        np.testing.assert_array_equal(turned[name], values, err_msg=name)
    assert at.size == len(plain["tau_cmd"])


@pytest.mark.parametrize("law", [HOGAN, CRAIG, SLOTINE_LI, SPONG_ORTEGA])
def test_whole_turns_of_the_virtual_angles_change_no_torque(law: str) -> None:
    """The orientation is the same, and the tip's angles, which a matrix gives within a half turn, follow."""
    loop = closed_loop(PUMA, law)
    given = {name: values.T for name, values in loop.given.items()}
    states = {"a_f": loop.ddq.T, "ddq": loop.ddq.T} if law == SPONG_ORTEGA else {"ddq": loop.ddq.T}
    evaluate = evaluator(LAWS[law](robot(PUMA)))
    expected = evaluate(**given, **states)
    turns = np.zeros((6, given["x_v"].shape[1]))
    turns[3], turns[5] = 2 * np.pi, -4 * np.pi
    axes = Rotation.from_euler("xyz", loop.given["task_rpy"]).as_matrix()
    turned = np.concatenate([turns[:3], apply(axes.transpose(0, 2, 1), turns[3:].T).T])  # x_t has the axes of the gains
    moved = {"x_v": given["x_v"] + turns, "x_t": given["x_t"] + turned}
    found = evaluate(**(given | moved), **states)
    # Angles of up to 16 rad are rounded to 2e-15 rad, by which e and the torques differ as they do for such an angle.
    for name in ("tau_cmd", "e"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-9 * np.abs(expected[name]).max())
