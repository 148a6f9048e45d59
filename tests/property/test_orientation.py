"""Roll, pitch and yaw: angles, rates, Jacobian and forces against automatic differentiation and SciPy."""

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmus.mechanics import orientation
from fmus.mechanics.rigid_body import SINGULAR, Placement
from fmus.mechanics.spatial_arm import SpatialArm
from tests.property.robots import NAMES, chain
from tests.property.samples import EPS, evaluate

STATES = 200
PHI, W, F = ca.SX.sym("phi", 3), ca.SX.sym("w", 3), ca.SX.sym("F", 6)
R = ca.SX.sym("R", 3, 3)


def random_angles(pitch: float = 1.5) -> np.ndarray:
    """Angles, rad, shape (3, STATES), with pitches up to a bound, at most 86 degrees."""
    rng = np.random.default_rng(3)
    return rng.uniform([[-np.pi], [-pitch], [-np.pi]], [[np.pi], [pitch], [np.pi]], (3, STATES))


def test_rotation_is_that_of_scipy() -> None:
    phi = random_angles()
    found = evaluate(ca.Function("R", [PHI], [orientation.rotation(PHI)]), phi)
    expected = Rotation.from_euler("xyz", phi.T).as_matrix()
    np.testing.assert_allclose(found, expected, rtol=0, atol=10 * EPS)


def test_angles_of_a_rotation_are_the_angles() -> None:
    phi = random_angles()
    found = evaluate(ca.Function("phi", [PHI], [orientation.angles(orientation.rotation(PHI))]), phi)[:, :, 0]
    # The angles of a matrix that is rounded to EPS are uncertain by EPS / cos(pitch), which is at least 0.07 here.
    np.testing.assert_allclose(found.T, phi, rtol=0, atol=10 * EPS / np.cos(1.5))


@pytest.mark.parametrize("to_the_pole", [0.0, 1e-16, 1e-12, 1e-9, 1e-6, 1.0])
def test_angles_of_a_placement_make_its_rotation_at_the_singularity_too(to_the_pole: float) -> None:
    """Below `SINGULAR` the roll is left out, which errs by cos(pitch)."""
    rolls, yaws = random_angles()[[0, 2]]
    for sign in (-1, 1):
        for roll, yaw in zip(rolls, yaws, strict=True):
            turned = Placement.from_rpy(np.zeros(3), (roll, sign * (np.pi / 2 - to_the_pole), yaw))
            found = Placement.from_rpy(np.zeros(3), turned.rpy)
            np.testing.assert_allclose(found.R, turned.R, rtol=0, atol=2 * SINGULAR)
            if to_the_pole > SINGULAR:
                np.testing.assert_allclose(found.R, turned.R, rtol=0, atol=10 * EPS)


def test_rates_give_the_angular_velocity() -> None:
    """[w]x = dR/dt R', by automatic differentiation."""
    rate = ca.SX.sym("dphi", 3)
    turned = orientation.rotation(PHI)
    spin = ca.reshape(ca.jtimes(ca.vec(turned), PHI, rate), 3, 3) @ turned.T
    w = ca.vertcat(spin[2, 1], spin[0, 2], spin[1, 0])
    difference = ca.Function("d", [PHI, rate], [w - orientation.rates_to_angular_velocity(PHI) @ rate])
    rates = np.random.default_rng(4).uniform(-3, 3, (3, STATES))
    assert np.abs(evaluate(difference, random_angles(), rates)).max() < 100 * EPS


def test_inverse_of_the_rates_matrix_comes_from_the_rotation_alone() -> None:
    turned = orientation.rotation(PHI)
    product = orientation.angular_velocity_to_rates(turned) @ orientation.rates_to_angular_velocity(PHI)
    found = evaluate(ca.Function("I", [PHI], [ca.densify(product)]), random_angles())
    np.testing.assert_allclose(found, np.tile(np.eye(3), (STATES, 1, 1)), rtol=0, atol=10 * EPS / np.cos(1.5) ** 2)


def test_wrench_and_generalized_force_are_inverse_and_have_one_power() -> None:
    turned = orientation.rotation(PHI)
    dx = ca.SX.sym("dx", 6)
    general = orientation.generalized_force(F, PHI)
    back = orientation.wrench(general, turned)
    w = orientation.rates_to_angular_velocity(PHI) @ dx[3:]
    power = ca.dot(dx[:3], F[:3]) + ca.dot(w, F[3:]) - ca.dot(dx, general)
    f = ca.Function("f", [PHI, F, dx], [ca.vertcat(back - F, power)])
    rng = np.random.default_rng(5)
    values = evaluate(f, random_angles(), *rng.uniform(-10, 10, (2, 6, STATES)))
    assert np.abs(values).max() < 1e3 * EPS / np.cos(1.5) ** 2


def test_pitch_cosine_is_what_the_singularity_is_measured_by() -> None:
    turned = orientation.rotation(PHI)
    measure = ca.Function("c", [PHI], [orientation.pitch_cosine(turned)])
    np.testing.assert_allclose(evaluate(measure, random_angles())[:, 0, 0], np.cos(random_angles()[1]), atol=10 * EPS)
    assert float(measure([0.3, np.pi / 2, -0.4])) < 10 * EPS


@pytest.mark.parametrize("name", NAMES)
def test_analytic_jacobian_is_the_derivative_of_the_coordinates(name: str) -> None:
    """J_a against automatic differentiation of (p, phi), relative to a reference orientation."""
    arm = SpatialArm(chain(name))
    reference = Rotation.from_euler("xyz", [2.0, 0.3, -1.0]).as_matrix()
    q = ca.SX.sym("q", arm.n)
    tip, position = arm.tip_frame(q)
    turned = tip @ ca.DM(reference).T
    x = ca.vertcat(position, orientation.angles(turned))
    both = [orientation.analytic_jacobian(arm.jacobian(q), turned), ca.jacobian(x, q), orientation.pitch_cosine(turned)]
    states = np.random.default_rng(6).uniform(-np.pi, np.pi, (arm.n, STATES))
    ours, derived, cosine = (evaluate(ca.Function("f", [q], [ca.densify(value)]), states) for value in both)
    # The terms of J_a grow by 1 / cos(pitch), and errors of the rotation enter them by the square.
    size = np.maximum(1.0, np.abs(evaluate(arm.jacobian, states)).max())
    assert np.all(np.abs(ours - derived) <= 200 * EPS * size / cosine**2)
