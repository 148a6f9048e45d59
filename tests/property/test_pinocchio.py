"""Evidence from an independent engine: Pinocchio's rigid-body algorithms give the arm's H, C dq, g, J, dJ dq and Y.

Pinocchio knows no CasADi expression of ours: it walks the chain of spatial inertias numerically (composite rigid body,
recursive Newton-Euler). Joints turn about x3, the normal of the plane; a link is massless but for a point at its end.
"""

from functools import cache
from typing import Any

import numpy as np
import pytest

from fmus.mechanics.planar_arm import PlanarArm
from tests.property.samples import EPS, evaluate, random_arms

pin: Any = pytest.importorskip("pinocchio", reason="pinocchio is not installed (group interop)")

STATES = 1000
# Each side sums at most some 500 products (three links, six-dimensional recursions), each rounded once and none larger
# than the largest value over all states; cancellation at a single state is no error of ours. Seen: 6e-16.
RELATIVE = 1e3 * EPS
IN_PLANE = slice(0, 2)


def planar_arm(m: np.ndarray, l: np.ndarray, gravity: float) -> tuple[Any, int]:
    """Pinocchio's model of the arm, and the index of its tip frame."""
    model, parent, placement = pin.Model(), 0, pin.SE3.Identity()
    for i in range(len(m)):
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint{i}")
        end = np.array([l[i], 0.0, 0.0])
        model.appendBodyToJoint(parent, pin.Inertia(m[i], end, np.zeros((3, 3))), pin.SE3.Identity())
        placement = pin.SE3(np.eye(3), end)
    model.gravity = pin.Motion(np.array([0.0, -gravity, 0.0]), np.zeros(3))
    return model, model.addFrame(pin.Frame("tip", parent, placement, pin.FrameType.OP_FRAME))


def mass_columns(Y_body: np.ndarray, l: np.ndarray) -> np.ndarray:
    """Regressor of the point masses from that of (m, m c, I): a mass at (l, 0, 0) has m c1 = m l, I22 = I33 = m l^2."""
    columns = []
    for i, length in enumerate(l):
        per_mass = np.zeros(10)  # m, mc1, mc2, mc3, I11, I12, I22, I13, I23, I33
        per_mass[[0, 1, 6, 9]] = 1, length, length**2, length**2
        columns.append(Y_body[:, 10 * i : 10 * (i + 1)] @ per_mass)
    return np.stack(columns, axis=1)


@cache
def theirs(n: int) -> dict[str, np.ndarray]:
    """All quantities at all states, each of shape (STATES, ...)."""
    s = random_arms(n, STATES, seed=1991)
    rows: dict[str, list[np.ndarray]] = {name: [] for name in ("x", "J", "dJ dq", "H", "C dq", "g", "Y", "tau")}
    for k in range(STATES):
        q, dq, a, m, l = s.q[:, k], s.dq[:, k], s.a[:, k], s.m[:, k], s.l[:, k]
        model, tip = planar_arm(m, l, s.gravity[0, k])
        data = model.createData()
        pin.forwardKinematics(model, data, q, dq, np.zeros(n))
        pin.updateFramePlacements(model, data)
        rows["x"].append(data.oMf[tip].translation[IN_PLANE].copy())
        drift = pin.getFrameClassicalAcceleration(model, data, tip, pin.LOCAL_WORLD_ALIGNED).linear
        rows["dJ dq"].append(drift[IN_PLANE].copy())
        rows["J"].append(pin.computeFrameJacobian(model, data, q, tip, pin.LOCAL_WORLD_ALIGNED)[IN_PLANE])
        upper = np.triu(pin.crba(model, data, q))
        rows["H"].append(upper + np.triu(upper, 1).T)
        rows["C dq"].append(pin.computeCoriolisMatrix(model, data, q, dq) @ dq)
        rows["g"].append(pin.computeGeneralizedGravity(model, data, q).copy())
        rows["Y"].append(mass_columns(pin.computeJointTorqueRegressor(model, data, q, dq, a), l))
        rows["tau"].append(pin.rnea(model, data, q, dq, a).copy())
    return {name: np.array(values) for name, values in rows.items()}


@cache
def ours(n: int) -> dict[str, np.ndarray]:
    """The same quantities from `fmus.mechanics.planar_arm`; friction left out, which Pinocchio's model has not."""
    arm, s = PlanarArm(n), random_arms(n, STATES, seed=1991)
    masses = np.concatenate([s.m, np.zeros((2 * n, STATES))])
    given = (s.l, s.gravity, s.coulomb_velocity)
    C = evaluate(arm.coriolis, s.q, s.dq, s.m, s.l)
    dJ = evaluate(arm.jacobian_rate, s.q, s.dq, s.l)
    return {
        "x": evaluate(arm.forward_kinematics, s.q, s.l)[..., 0],
        "J": evaluate(arm.jacobian, s.q, s.l),
        "dJ dq": np.einsum("kij,jk->ki", dJ, s.dq),
        "H": evaluate(arm.inertia, s.q, s.m, s.l),
        "C dq": np.einsum("kij,jk->ki", C, s.dq),
        "g": evaluate(arm.gravity_torque, s.q, s.m, s.l, s.gravity)[..., 0],
        "Y": evaluate(arm.regressor, s.q, s.dq, s.dq, s.a, *given)[..., :n],
        "tau": evaluate(arm.inverse_dynamics, s.q, s.dq, s.dq, s.a, masses, *given)[..., 0],
    }


@pytest.mark.parametrize("quantity", ["x", "J", "dJ dq", "H", "C dq", "g", "Y", "tau"])
@pytest.mark.parametrize("n", [2, 3])
def test_arm_agrees_with_pinocchio(n: int, quantity: str) -> None:
    expected, value = theirs(n)[quantity], ours(n)[quantity]
    assert value.shape == expected.shape
    assert np.abs(value - expected).max() <= RELATIVE * np.abs(expected).max()
