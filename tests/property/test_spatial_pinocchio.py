"""Evidence from an independent engine: Pinocchio gives the kinematics and dynamics of nine arms in space.

Pinocchio knows no expression of ours. It reads the URDF files itself, holds joints itself, and walks the chain of
spatial inertias numerically; we use accelerations of points and CasADi.
"""

from functools import cache

import numpy as np
import pytest

from fmus.mechanics.spatial_arm import SpatialArm
from tests.property.robots import GRAVITY, NAMES, chain, configuration, model, pin
from tests.property.samples import EPS, evaluate

STATES = 1000
# Along a chain of eight joints each side rounds some 25 sums and products per joint, one after the other, none larger
# than the largest value over all states and joints. Seen: 5e-15.
RELATIVE = 200 * EPS


@cache
def states(name: str) -> dict[str, np.ndarray]:
    """Joint coordinates, two rates and an acceleration, each of shape (n, STATES)."""
    rng = np.random.default_rng(560)
    n = chain(name).n
    limits = {"q": np.pi, "dq": 3.0, "v": 3.0, "a": 10.0}
    return {key: rng.uniform(-limit, limit, (n, STATES)) for key, limit in limits.items()}


@cache
def theirs(name: str) -> dict[str, np.ndarray]:
    """All quantities at all states, each of shape (STATES, ...)."""
    built, tip = model(name)
    data = built.createData()
    s = states(name)
    axes = pin.LOCAL_WORLD_ALIGNED
    quantities = ("R", "x", "J", "dJ", "H", "C dq", "g", "ddq", "tau", "Y")
    rows: dict[str, list[np.ndarray]] = {key: [] for key in quantities}
    zero = np.zeros(built.nv)
    for k in range(STATES):
        q, dq, a = configuration(name, s["q"][:, k]), s["dq"][:, k], s["a"][:, k]
        pin.computeJointJacobiansTimeVariation(built, data, q, dq)
        pin.updateFramePlacements(built, data)
        rows["R"].append(data.oMf[tip].rotation.copy())
        rows["x"].append(data.oMf[tip].translation[:, None].copy())
        rows["dJ"].append(pin.getFrameJacobianTimeVariation(built, data, tip, axes))
        rows["J"].append(pin.computeFrameJacobian(built, data, q, tip, axes))
        upper = np.triu(pin.crba(built, data, q))
        rows["H"].append(upper + np.triu(upper, 1).T)
        g = pin.computeGeneralizedGravity(built, data, q).copy()
        rows["g"].append(g[:, None])
        rows["C dq"].append((pin.rnea(built, data, q, dq, zero) - g)[:, None])
        rows["ddq"].append(pin.aba(built, data, q, dq, a)[:, None].copy())
        rows["tau"].append(pin.rnea(built, data, q, dq, a)[:, None].copy())
        rows["Y"].append(pin.computeJointTorqueRegressor(built, data, q, dq, a).copy())
    return {key: np.array(values) for key, values in rows.items()}


@cache
def ours(name: str) -> dict[str, np.ndarray]:
    """The same quantities of `SpatialArm`; friction, which Pinocchio's functions leave out, is 0."""
    numbers = chain(name)
    arm, s, n = SpatialArm(numbers), states(name), numbers.n
    q, dq, a = s["q"], s["dq"], s["a"]
    p = frictionless(name)
    gravity, softness = np.tile(np.array(GRAVITY)[:, None], STATES), np.ones((1, STATES))
    R, x = (np.array(value) for value in arm.tip_frame(q))
    C = evaluate(arm.coriolis, q, dq, p)
    return {
        "R": R.reshape(3, STATES, 3).transpose(1, 0, 2),
        "x": x.T[:, :, None],
        "J": evaluate(arm.jacobian, q),
        "dJ": evaluate(arm.jacobian_rate, q, dq),
        "H": evaluate(arm.inertia, q, p),
        "C dq": C @ dq.T[:, :, None],
        "g": evaluate(arm.gravity_torque, q, p, gravity),
        "ddq": evaluate(arm.acceleration, q, dq, a, p, gravity, softness),
        "tau": evaluate(arm.inverse_dynamics, q, dq, dq, a, p, gravity, softness),
        "Y": evaluate(arm.regressor, q, dq, dq, a, gravity, softness)[:, :, : 10 * n],
    }


def frictionless(name: str) -> np.ndarray:
    """Parameters at every state, shape (13 n, STATES), without friction."""
    numbers = chain(name)
    p = numbers.p.copy()
    p[10 * numbers.n : 12 * numbers.n] = 0
    return np.tile(p[:, None], STATES)


@pytest.mark.parametrize("name", NAMES)
def test_numbers_of_the_bodies_are_those_that_pinocchio_reads(name: str) -> None:
    built, numbers = model(name)[0], chain(name)
    p = np.concatenate([body.toDynamicParameters() for body in [*built.inertias][1:]])
    np.testing.assert_allclose(numbers.p[: len(p)], p, rtol=0, atol=100 * EPS * np.abs(p).max())
    if name not in ("PUMA", "planar 3R"):
        assert [joint.name for joint in numbers.joints] == [*built.names][1:]
        np.testing.assert_array_equal([joint.damping for joint in numbers.joints], built.damping)
        np.testing.assert_array_equal([joint.friction for joint in numbers.joints], built.upperDryFrictionLimit)
        np.testing.assert_array_equal([joint.limits.effort for joint in numbers.joints], built.upperEffortLimit)


@pytest.mark.parametrize("quantity", ["R", "x", "J", "dJ", "H", "C dq", "g", "tau", "Y"])
@pytest.mark.parametrize("name", NAMES)
def test_pinocchio_finds_the_same(name: str, quantity: str) -> None:
    expected, found = theirs(name)[quantity], ours(name)[quantity]
    np.testing.assert_allclose(found, expected, rtol=0, atol=RELATIVE * np.abs(expected).max())


@pytest.mark.parametrize("name", NAMES)
def test_accelerations_agree_as_far_as_the_inertia_matrix_is_conditioned(name: str) -> None:
    expected, found, H = theirs(name)["ddq"], ours(name)["ddq"], theirs(name)["H"]
    condition = np.linalg.cond(H)[:, None, None]
    scale = np.abs(expected).max(axis=1, keepdims=True)
    assert np.all(np.abs(found - expected) <= RELATIVE * condition * scale)


@pytest.mark.parametrize("name", NAMES)
def test_regressor_times_parameters_is_pinocchios_torque(name: str) -> None:
    expected = theirs(name)["tau"][:, :, 0]
    numbers = chain(name)
    rotors = numbers.p[12 * numbers.n :] * states(name)["a"].T
    torque = ours(name)["Y"] @ numbers.p[: 10 * numbers.n] + rotors
    np.testing.assert_allclose(torque, expected, rtol=0, atol=RELATIVE * np.abs(expected).max())
