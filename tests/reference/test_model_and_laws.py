"""The model and the control laws of the reference agree with point masses and with the printed formulas.

Equation numbers are those of Lu and Meng (1991).
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from .arm import (
    Wall,
    acceleration,
    coriolis,
    external_force,
    friction_torque,
    gravity_torque,
    inertia,
    jacobian,
    jacobian_rate,
    regressor,
    tip_position,
    tip_velocity,
    wall_gap,
)
from .controllers import (
    adaptation_rate,
    augmented_error,
    reference_transition,
    robust_gain,
    tip_space_torque,
    torque,
)
from .monolithic import (
    Setup,
    arm_of,
    law_of,
    plant_of,
)

FULL = Setup(
    m=(2.0, 1.3), l=(1.1, 0.8), viscous=(0.5, 0.3), coulomb=(0.4, 0.2), coulomb_velocity=0.1, gravity=9.81,
    D_f=0.5, mu=0.3, friction_velocity=0.05, Psi=(90.0, 70.0), K_d=(100.0, 60.0), M=(2.0, 3.0), B=(340.0, 500.0),
    p_start=(2.2, 1.0, 0.4, 0.35, 0.3, 0.25), Gamma=(1.0, 4.0, 0.5, 0.6, 0.7, 0.8),
    controller_noise_bound=80.0, gamma_margin=1.3, gamma_eps=0.02,
)  # fmt: skip


def random_states(n=20):
    """Return random states away from the stretched arm, where the Jacobian is singular; rates up to 4 rad/s."""
    rng = np.random.default_rng(1991)
    return [(rng.uniform([-3, 0.4], [3, 2.4]), rng.uniform(-4, 4, 2)) for _ in range(n)]


def random_samples():
    """Yield inputs of a controller around random states, with errors of 1 cm and 0.5 m/s, and forces of 100 N."""
    rng = np.random.default_rng(7)
    for q, dq in random_states():
        x, dx = np.array(tip_position(arm_of(FULL), q)), jacobian(arm_of(FULL), q) @ dq
        virtual = np.stack([x + rng.normal(0, 0.01, 2), dx + rng.normal(0, 0.5, 2), rng.normal(0, 10, 2)])
        yield q, dq, rng.normal(0, 100, 2), virtual, x + rng.normal(0, 0.01, 2), dx + rng.normal(0, 0.5, 2)


def difference(function, q, direction):
    """Return a directional derivative by central differences; truncation and rounding are both about 1e-10."""
    step = 1e-5 * direction
    return (np.asarray(function(q + step)) - np.asarray(function(q - step))) / 2e-5


def test_model_follows_from_point_masses():
    arm, p = plant_of(FULL).arm, plant_of(FULL).p
    elbow = lambda q: np.array([np.cos(q[0]), np.sin(q[0])]) * arm.l1  # noqa: E731

    def potential(q):
        return arm.gravity * (p[0] * elbow(q)[1] + p[1] * tip_position(arm, q)[1])

    for q, dq in random_states():
        J_tip = np.stack([difference(lambda z: tip_position(arm, z), q, e) for e in np.eye(2)], 1)
        J_elbow = np.stack([difference(elbow, q, e) for e in np.eye(2)], 1)
        H = p[0] * J_elbow.T @ J_elbow + p[1] * J_tip.T @ J_tip
        dH = difference(lambda z: inertia(arm, p, z), q, dq)
        kinetic = [0.5 * difference(lambda z: dq @ inertia(arm, p, z) @ dq, q, e) for e in np.eye(2)]  # noqa: B023
        # Central differences err by 1e-10 (see `difference`), times masses, squared rates and gravity of at most 1e2.
        assert_allclose(jacobian(arm, q), J_tip, atol=1e-8)
        assert_allclose(jacobian_rate(arm, q, dq), difference(lambda z: jacobian(arm, z), q, dq), atol=1e-8)
        assert_allclose(inertia(arm, p, q), H, atol=1e-8)
        assert_allclose(coriolis(arm, p, q, dq) @ dq, dH @ dq - kinetic, atol=1e-7)
        assert_allclose(gravity_torque(arm, p, q), [difference(potential, q, e) for e in np.eye(2)], atol=1e-7)
        skew = dH - 2.0 * coriolis(arm, p, q, dq)
        assert_allclose(skew, -skew.T, atol=1e-7)


def test_regressor_reproduces_the_model_and_the_acceleration_solves_it():
    plant, rng = plant_of(FULL), np.random.default_rng(3)
    arm, p = plant.arm, plant.p
    for q, dq in random_states():
        v, a, tau, F = rng.normal(0, 5, (4, 2))
        rest = np.add(gravity_torque(arm, p, q), friction_torque(arm, p, dq))
        model = inertia(arm, p, q) @ a + coriolis(arm, p, q, dq) @ v + rest
        ddq = np.array(acceleration(plant, q, dq, tau, (F[0], F[1])))
        residual = inertia(arm, p, q) @ ddq + coriolis(arm, p, q, dq) @ dq + rest + jacobian(arm, q).T @ F - tau
        # The sums have about ten terms of at most 1e3, so rounding is 10 x 1e3 x 1.1e-16.
        assert_allclose(regressor(arm, q, dq, v, a) @ p, model, atol=1e-12)
        assert_allclose(residual, 0.0, atol=1e-12)


@pytest.mark.parametrize("B", [2.0 * np.sqrt(8000.0), 340.0, 20.0])
def test_reference_transition_agrees_with_solve_ivp(B):
    M, K, h, F = 2.0, 4000.0, 1e-4, 300.0
    transition = reference_transition((M, M), (B, B), (K, K), h)[0]
    d = np.array([0.01, -0.4])
    for _ in range(50):
        d = transition @ np.array([*d, F])
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-16}
    exact = solve_ivp(lambda _, d: [d[1], (-F - B * d[1] - K * d[0]) / M], (0.0, 50 * h), [0.01, -0.4], **options)
    # The accuracy is rtol = 1e-13 per step over some 10 steps, of values of 1e-2 m and 1 m/s.
    assert_allclose(d, exact.y[:, -1], rtol=2e-12)


def tip_space(law, sample, p):
    """Return J, H_x, e and e' from the printed definitions."""
    q, dq, _, _, x_t, dx_t = sample
    J = jacobian(law.arm, q)
    H_x = np.linalg.inv(J).T @ inertia(law.arm, p, q) @ np.linalg.inv(J)
    return J, H_x, np.array(tip_position(law.arm, q)) - x_t, J @ dq - dx_t


def test_torque_forms_agree_and_adaptive_laws_reduce_to_them():
    law = law_of(FULL)
    for sample in random_samples():
        expected = tip_space_torque(law, sample, law.p_start)
        # Torques of at most 1e4 N.m pass through Jacobians of condition below 10, so rounding is 1e4 x 1e2 x 1e-16.
        assert_allclose(torque(law, sample, law.p_start, np.zeros(2)), expected, atol=1e-9)
        for kind in (1, 3):  # without a noise bound and with phi_hat = 0, Craig and Spong-Ortega are form (4)
            quiet = law._replace(kind=kind, controller_noise_bound=0.0)
            assert_allclose(torque(quiet, sample, law.p_start, np.ones(2)), expected, atol=1e-9)


def test_craig_and_spong_ortega_as_printed():
    p_hat, ddq, a_f = np.array([1.8, 1.4, 0.2, 0.3, 0.5, 0.1]), np.array([4.0, -7.0]), np.array([3.0, 9.0])
    active = 0
    for kind in (1, 3):
        law = law_of(FULL)._replace(kind=kind)
        p = p_hat if kind == 1 else law.p_start
        for sample in random_samples():
            J, H_x, e, rate = tip_space(law, sample, p)
            e_star = rate + law.Psi * e
            z = np.linalg.solve(H_x, e_star)
            W = np.linalg.inv(J).T @ regressor(law.arm, sample[0], sample[1], sample[1], ddq)
            # Values up to 1e4 pass through condition numbers below 1e2.
            assert_allclose(adaptation_rate(law, sample, p_hat, ddq), -law.Gamma * (W.T @ z), rtol=1e-9, atol=1e-9)
            k, b = law.K / law.M, law.B / law.M
            X = np.concatenate([e, rate])
            alpha = X @ np.diag([*(2.0 * law.Psi * k), *(2.0 * (b - law.Psi))]) @ X
            need = (2.0 * np.linalg.norm(z) * 80.0 - alpha) / (np.linalg.norm(e_star) ** 2 + 0.02**2)
            gamma = 1.3 * max(0.0, need)
            active += gamma > 0.0
            assert_allclose(robust_gain(law, sample, p), gamma, rtol=1e-10)
            F_c = -0.5 * gamma * H_x @ e_star
            expected = tip_space_torque(law, sample, p) + J.T @ F_c
            if kind == 3:
                expected -= regressor(law.arm, sample[0], sample[1], sample[1], a_f) @ (law.p_start - p_hat)
            assert_allclose(torque(law, sample, p_hat, a_f), expected, rtol=1e-9, atol=1e-8)
    assert active > 5


def test_slotine_li_as_printed():
    law, p_hat = law_of(FULL)._replace(kind=2), np.array([1.8, 1.4, 0.2, 0.3, 0.5, 0.1])
    for sample in random_samples():
        q, dq, F_hat, v, x_t, dx_t = sample
        J, H_x, e, rate = tip_space(law, sample, p_hat)
        s = rate + law.Psi * e
        assert_allclose(augmented_error(law, sample), s, atol=1e-12)
        J_inv, dJ = np.linalg.inv(J), jacobian_rate(law.arm, q, dq)
        d, d_rate = x_t - v[0], dx_t - v[1]
        ddx_t = v[2] - np.linalg.solve(np.diag(law.M), law.B * d_rate + law.K * d + F_hat)
        dx_r, ddx_r = J @ dq - s, ddx_t - law.Psi * rate
        C_x = J_inv.T @ (coriolis(law.arm, p_hat, q, dq) - inertia(law.arm, p_hat, q) @ J_inv @ dJ) @ J_inv
        rest = J_inv.T @ np.add(gravity_torque(law.arm, p_hat, q), friction_torque(law.arm, p_hat, dq))
        F = H_x @ ddx_r + C_x @ dx_r + rest + F_hat - law.K_d * s
        # As above, values up to 1e4 pass through condition numbers below 1e2.
        assert_allclose(torque(law, sample, p_hat, np.zeros(2)), J.T @ F, rtol=1e-9, atol=1e-8)
        dq_r = J_inv @ dx_r
        W = J_inv.T @ regressor(law.arm, q, dq, dq_r, J_inv @ (ddx_r - dJ @ dq_r))
        assert_allclose(adaptation_rate(law, sample, p_hat, np.zeros(2)), -law.Gamma * (W.T @ s), rtol=1e-9, atol=1e-9)


def test_wall_force_law():
    wall = Wall(0.6, 0.8, 0.0, 1e5, 0.2, 0.3, 0.01)
    plant = plant_of(FULL)._replace(wall=wall)
    for q, dq in random_states():
        n, t = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
        dx = np.array(tip_velocity(plant.arm, q, dq))
        F_n = 1e5 * max(wall_gap(plant, q), 0.0) * max(0.0, 1.0 + 0.2 * n @ dx)
        expected = F_n * n + 0.3 * F_n * np.tanh(t @ dx / 0.01) * t
        assert_allclose(external_force(plant, q, dq), expected, rtol=1e-12, atol=1e-9)
    assert len({external_force(plant, q, dq) for q, dq in random_states()}) > 3
