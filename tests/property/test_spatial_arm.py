"""Identities of the equations of spatial arms at random states, friction and rotors included."""

from functools import cache

import casadi as ca
import numpy as np
import pytest

from fmus.mechanics.planar_arm import PlanarArm
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.robots.puma560 import puma560
from tests.property.robots import GRAVITY, LENGTHS, MASSES, NAMES, chain
from tests.property.samples import EPS, evaluate

STATES = 100
# Some 25 rounded operations per joint, one after the other, along chains of eight joints; see test_spatial_pinocchio.
RELATIVE = 200 * EPS
GIVEN = (np.tile(np.array(GRAVITY)[:, None], STATES), np.full((1, STATES), 0.2))


@cache
def sample(name: str) -> dict[str, np.ndarray]:
    """A state, a second rate and an acceleration, and parameters with friction and rotors, one column each."""
    numbers = chain(name)
    rng = np.random.default_rng(86)
    p = numbers.p.copy()
    p[10 * numbers.n :] = rng.uniform(0.1, 1.0, 3 * numbers.n)
    columns = {key: rng.uniform(-3, 3, (numbers.n, STATES)) for key in ("q", "dq", "v", "a")}
    return columns | {"p": np.tile(p[:, None], STATES)}


@cache
def arm(name: str) -> SpatialArm:
    return SpatialArm(chain(name))


def near(found: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=RELATIVE * np.abs(expected).max())


@cache
def coriolis(name: str) -> np.ndarray:
    s = sample(name)
    return evaluate(arm(name).coriolis, s["q"], s["dq"], s["p"])


@pytest.mark.parametrize("name", NAMES)
def test_power_of_inertia_is_that_of_coriolis_torques(name: str) -> None:
    """The derivative of H by automatic differentiation is C + C': dH/dt - 2 C is skew-symmetric."""
    a, s = arm(name), sample(name)
    q, dq, p = ca.SX.sym("q", a.n), ca.SX.sym("dq", a.n), ca.SX.sym("p", len(s["p"]))
    H = a.inertia(q, p)
    rate = ca.Function("dH", [q, dq, p], [ca.reshape(ca.jtimes(ca.vec(H), q, dq), a.n, a.n)])
    C = coriolis(name)
    near(C + C.transpose(0, 2, 1), evaluate(rate, s["q"], s["dq"], s["p"]))


@pytest.mark.parametrize("name", NAMES)
def test_coriolis_matrix_is_that_of_christoffels_symbols(name: str) -> None:
    """Skewness leaves C open; Christoffel's symbols are symmetric, so that C(q, dq) v = C(q, v) dq as well."""
    s = sample(name)
    exchanged = evaluate(arm(name).coriolis, s["q"], s["v"], s["p"])
    near(coriolis(name) @ s["v"].T[:, :, None], exchanged @ s["dq"].T[:, :, None])


@pytest.mark.parametrize("name", NAMES)
def test_torque_is_the_sum_of_its_parts(name: str) -> None:
    a, s = arm(name), sample(name)
    q, dq, v, p = s["q"], s["dq"], s["v"], s["p"]
    parts = (
        evaluate(a.inertia, q, p) @ s["a"].T[:, :, None]
        + coriolis(name) @ v.T[:, :, None]
        + evaluate(a.gravity_torque, q, p, GIVEN[0])
        + evaluate(a.friction_torque, dq, p, GIVEN[1])
    )
    near(evaluate(a.inverse_dynamics, q, dq, v, s["a"], p, *GIVEN), parts)


@pytest.mark.parametrize("name", NAMES)
def test_bias_is_the_torque_at_one_velocity_without_acceleration(name: str) -> None:
    a, s = arm(name), sample(name)
    q, dq, p = s["q"], s["dq"], s["p"]
    torque = evaluate(a.inverse_dynamics, q, dq, dq, 0 * dq, p, *GIVEN)
    near(evaluate(a.bias, q, dq, p, *GIVEN), torque)


@pytest.mark.parametrize("name", NAMES)
def test_regressor_gives_the_torque_at_two_velocities_with_friction_and_rotors(name: str) -> None:
    a, s = arm(name), sample(name)
    motion = (s["q"], s["dq"], s["v"], s["a"])
    torque = evaluate(a.regressor, *motion, *GIVEN) @ s["p"].T[:, :, None]
    near(torque, evaluate(a.inverse_dynamics, *motion, s["p"], *GIVEN))


@pytest.mark.parametrize("name", NAMES)
def test_acceleration_gives_back_the_torque(name: str) -> None:
    a, s = arm(name), sample(name)
    tau = 50 * s["a"]
    ddq = evaluate(a.acceleration, s["q"], s["dq"], tau, s["p"], *GIVEN)
    torque = evaluate(a.inverse_dynamics, s["q"], s["dq"], s["dq"], ddq[:, :, 0].T, s["p"], *GIVEN)
    # The solution of a positive definite system has a small residual whatever its condition: of the size of H ddq.
    size = np.abs(evaluate(a.inertia, s["q"], s["p"])) @ np.abs(ddq)
    assert np.all(np.abs(torque - tau.T[:, :, None]) <= RELATIVE * (size.max() + np.abs(tau).max()))


def test_planar_arm_is_the_spatial_arm_in_a_plane() -> None:
    """The planar arm of the paper, with point masses and gravity along -x2."""
    planar, s = PlanarArm(3), sample("planar 3R")
    p = np.tile(chain("planar 3R").p[:, None], STATES)
    l, m = (np.tile(np.array(values)[:, None], STATES) for values in (LENGTHS, MASSES))
    down = np.tile(np.array([[0.0], [-9.81], [0.0]]), STATES)
    a = arm("planar 3R")
    near(evaluate(a.jacobian, s["q"])[:, :2], evaluate(planar.jacobian, s["q"], l))
    near(evaluate(a.inertia, s["q"], p), evaluate(planar.inertia, s["q"], m, l))
    near(evaluate(a.coriolis, s["q"], s["dq"], p), evaluate(planar.coriolis, s["q"], s["dq"], m, l))
    g = evaluate(planar.gravity_torque, s["q"], m, l, np.full((1, STATES), 9.81))
    near(evaluate(a.gravity_torque, s["q"], p, down), g)


def test_puma_has_the_gravity_constants_that_its_authors_publish() -> None:
    """Armstrong, Khatib and Burdick: g1 = -37.2, g2 = -8.44, g3 = 1.02, g4 = 0.249, g5 = -0.0282 N.m (three digits).

    With a straight wrist the weight turns joint 2 by g1 cos(q2) + g3 sin(q2) + (g2 + g5) sin(q2 + q3)
    + g4 cos(q2 + q3).
    """
    numbers = puma560()
    puma = SpatialArm(numbers)

    def torque(q2: float, q3: float) -> float:
        return float(puma.gravity_torque([0, q2, q3, 0, 0, 0], numbers.p, [0, 0, -9.81])[1])

    right = np.pi / 2
    assert (torque(0, 0) + torque(0, np.pi)) / 2 == pytest.approx(-37.2, abs=0.05)
    assert (torque(0, 0) - torque(0, np.pi)) / 2 == pytest.approx(0.249, abs=5e-4)
    assert (torque(right, 0) + torque(right, np.pi)) / 2 == pytest.approx(1.02, abs=5e-3)
    assert (torque(right, 0) - torque(right, np.pi)) / 2 == pytest.approx(-8.44 - 0.0282, abs=0.03)


# What the functions had when they were written, and a tenth. A frame that no longer keeps its zeros, or a function
# whose results share nothing, costs twice as much.
OPERATIONS = {
    "acceleration": 1600,
    "inverse_dynamics": 1280,
    "regressor": 2380,
    "inertia": 630,
    "bias": 880,
    "jacobian_rate": 570,
}


@pytest.mark.parametrize("law", OPERATIONS)
def test_equations_of_the_puma_stay_cheap(law: str) -> None:
    assert getattr(arm("PUMA"), law).n_instructions() < OPERATIONS[law]
