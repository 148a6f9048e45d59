"""Theory for tasks of positions and angles, n = m: (12), (20), (25) and (35) of the declared controllers.

    e'' + B_n e' + K_n e = H_hat_x^-1 (W_c phi + F_c + dF_e)                    (12); H_0 in the variant
    dV_c/dt = -alpha + 2 e*' S^2 H_hat_x^-1 (F_c + dF_e)                        (20), S = diag(1, ..., L)
    dV_s/dt = -s' K_d s + s' dF_e                                               (35)

phi = p_hat - p, dF_e = F_hat - F_ext. The right sides come from `tests.property.chains` for three joints in the plane,
and from `tests.property.spatial_chains` for six joints in space, at any orientation of the tip and with gains along any
axes. Plant and controller are evaluated together, as tests/property/test_adaptation_dynamics.py does for two joints.
"""

import numpy as np
import pytest

from tests.property.meeting import (
    CRAIG,
    HOGAN,
    PLANAR,
    SLOTINE_LI,
    SPONG_ORTEGA,
    TOLERANCE,
    TS,
    Loop,
    Meeting,
    closed_loop,
    meeting,
    norm,
    rounding_of_steps,
    scales,
)
from tests.property.spatial_chains import SpatialChains
from tests.property.task_space import apply

ARMS = (PLANAR, "PUMA", "UR5")
each_arm = pytest.mark.parametrize("name", ARMS)
algorithm_1 = pytest.mark.parametrize("law", [CRAIG, SPONG_ORTEGA])


def mobility(at: Meeting, loop: Loop, law: str) -> np.ndarray:
    """The inverse of the inertia that algorithm 1 has in task space."""
    return np.linalg.inv(at.arms.H_x(loop.given["p_start"] if law == SPONG_ORTEGA else at.p_hat))


def weight(at: Meeting, loop: Loop) -> np.ndarray:
    """The diagonal of S^2."""
    return np.where(scales(at.arms) == 1, 1, loop.given["L"]) ** 2


@each_arm
def test_samples_are_well_conditioned(name: str) -> None:
    at = meeting(name)
    assert at.size >= 200
    assert max(at.arms.roundings(p).max() for p in (at.p, at.p_hat)) < TOLERANCE
    touching = np.any(closed_loop(name, CRAIG).F_ext != 0, axis=1)
    assert 0.3 < touching.mean() < 0.7
    if isinstance(at.arms, SpatialChains):  # the angles are far from small ones
        assert np.abs(at.arms.phi[:, 1]).max() > 1.1
        assert np.linalg.norm(at.arms.wrench_map, 2, axis=(1, 2)).max() > 1.3
    else:
        assert (closed_loop(name, CRAIG).F_ext[:, 2] == 0).all()  # a point contact has no moment about the tip


@each_arm
@algorithm_1
def test_algorithm_1_obeys_equation_12(name: str, law: str) -> None:
    at, loop = meeting(name), closed_loop(name, law)
    given, arms = loop.given, at.arms
    M, B, K = given["M"], given["B"], given["K"]
    dde = loop.ddx - loop.ddx_t
    left = dde + B / M * loop.de + K / M * loop.e
    W = arms.W(arms.dx, loop.ddx)
    parts = [apply(W, at.p_hat - at.p), loop.shown["F_c"], loop.F_hat - loop.F_ext]
    inverse = mobility(at, loop, law)
    size = norm(inverse) * sum(norm(part) for part in parts)
    size += norm(dde) + norm(B / M * loop.de) + norm(K / M * loop.e)
    assert (norm(left - apply(inverse, np.sum(parts, axis=0))) <= TOLERANCE * size * loop.condition).all()
    assert {(bool(f.any()), bool(g > 0)) for f, g in zip(loop.F_ext, loop.shown["gamma"][:, 0], strict=True)} == {
        (False, False),
        (False, True),
        (True, False),
        (True, True),
    }


@each_arm
@algorithm_1
def test_the_lyapunov_function_of_algorithm_1_changes_as_equation_20_says(name: str, law: str) -> None:
    """V_c in coordinates of one unit: S e for e, with the adaptation that the controller declares."""
    at, loop = meeting(name), closed_loop(name, law)
    given, shown, S2 = loop.given, loop.shown, weight(at, loop)
    Psi, k, b = given["Psi"], given["K"] / given["M"], given["B"] / given["M"]
    dde = loop.ddx - loop.ddx_t
    # d/dt of ((k + psi b) e^2 + 2 psi e de + de^2) per axis, and of phi' Gamma^-1 phi
    terms = [
        S2 * 2 * (k + Psi * b) * loop.e * loop.de,
        S2 * 2 * Psi * (loop.de**2 + loop.e * dde),
        S2 * 2 * loop.de * dde,
    ]
    state = "phi_hat" if law == SPONG_ORTEGA else "p_hat"
    moved = (shown[f"{state}_next"] - given[state]) / TS
    rate = -moved if law == SPONG_ORTEGA else moved
    learning = 2 * (at.p_hat - at.p) / given["Gamma"] * rate
    growth = sum(term.sum(axis=1) for term in terms) + learning.sum(axis=1)
    e_star = loop.de + Psi * loop.e
    inverse = mobility(at, loop, law)
    through = apply(inverse, S2 * e_star)
    expected = -shown["alpha"][:, 0] + 2 * ((shown["F_c"] + loop.F_hat - loop.F_ext) * through).sum(axis=1)
    size = sum(np.abs(term).sum(axis=1) for term in (*terms, learning)) + np.abs(shown["alpha"][:, 0])
    size += norm(inverse) * norm(S2 * e_star) * (norm(shown["F_c"]) + norm(loop.F_hat) + norm(loop.F_ext))
    # Twice, as in `learning`; p_start of the variant is larger than p_hat.
    rounding = 4 * rounding_of_steps(np.abs(at.p_hat) + np.abs(at.p) + 1, at.p_hat - at.p, given["Gamma"])
    assert (np.abs(growth - expected) <= TOLERANCE * size * loop.condition + rounding).all()
    metres = np.sqrt(S2) * e_star
    np.testing.assert_allclose(shown["beta"][:, 0], norm(metres), rtol=1e-10)
    np.testing.assert_allclose(shown["mu"][:, 0], norm(np.sqrt(S2) * through), rtol=1e-9)
    np.testing.assert_allclose(shown["e_star"], e_star, rtol=0, atol=1e-10 * norm(e_star).max())


@each_arm
@algorithm_1
def test_gamma_lets_the_lyapunov_function_fall_for_every_error_within_the_bound(name: str, law: str) -> None:
    """(21) to (25): for every error dw of the wrench with |S^-1 dw| <= delta the right side of (20) is not positive.

    Outside of the boundary layer. An error of the wrench is A dw as a force of the coordinates, and E in A has a norm
    above 1 where the tip pitches.
    """
    at, loop = meeting(name), closed_loop(name, law)
    given, shown, S2 = loop.given, loop.shown, weight(at, loop)
    e_star = loop.de + given["Psi"] * loop.e
    through = apply(mobility(at, loop, law), S2 * e_star)
    of_wrench = np.einsum("kji,kj->ki", at.arms.wrench_map, through)  # the worst error of the wrench points along it
    delta = np.where(norm(loop.F_hat) > 0, given["noise_bound"][:, 0], 0)
    worst = 2 * delta * norm(np.sqrt(S2) * of_wrench) - shown["alpha"][:, 0] + 2 * (shown["F_c"] * through).sum(axis=1)
    scale = shown["alpha"][:, 0] + 2 * delta * norm(np.sqrt(S2) * of_wrench)
    assert (worst <= 1e-8 * scale).all()
    assert (shown["gamma"][:, 0] > 0).any()
    bound = shown["gamma_bound"][:, 0]  # (26), where case (c) holds
    gain = np.linalg.norm(at.arms.wrench_map, 2, axis=(1, 2))
    needed = (2 * shown["mu"][:, 0] * gain * delta - shown["alpha"][:, 0]) / shown["beta"][:, 0] ** 2
    assert ((bound == 0) | (bound >= needed * (1 - 1e-9))).all()
    assert (bound > 0).any()


@each_arm
def test_algorithm_2_obeys_its_error_dynamics_and_equation_35(name: str) -> None:
    at, loop = meeting(name), closed_loop(name, SLOTINE_LI)
    arms, given = at.arms, loop.given
    Psi, K_d = given["Psi"], given["K_d"]
    dx_r, ddx_r = given["dx_t"] - Psi * loop.e, loop.ddx_t - Psi * loop.de
    s, ds, phi = arms.dx - dx_r, loop.ddx - ddx_r, at.p_hat - at.p
    error = loop.F_hat - loop.F_ext
    inertial, coriolis = apply(arms.H_x(at.p), ds), apply(arms.C_x(at.p), s)
    driving = apply(arms.W(dx_r, ddx_r), phi)
    size = norm(arms.H_x(at.p)) * (norm(loop.ddx) + norm(ddx_r)) + norm(coriolis) + norm(K_d * s) + norm(driving)
    size += norm(loop.F_hat) + norm(loop.F_ext)
    assert (norm(inertial + coriolis + K_d * s - driving - error) <= TOLERANCE * size).all()
    np.testing.assert_allclose(loop.shown["s"], s, rtol=0, atol=1e-12 * norm(s).max())
    # s' dH_x/dt s / 2 is s' C_x s, since dH_x/dt - 2 C_x is skew.
    rate = (loop.shown["p_hat_next"] - given["p_hat"]) / TS
    learning = phi / given["Gamma"] * rate
    growth = (s * (inertial + coriolis)).sum(axis=1) + learning.sum(axis=1)
    expected = -(s * K_d * s).sum(axis=1) + (s * error).sum(axis=1)
    allowed = TOLERANCE * (norm(s) * size + np.abs(learning).sum(axis=1))
    assert (np.abs(growth - expected) <= allowed + rounding_of_steps(at.p_hat, phi, given["Gamma"])).all()
    assert (expected < 0).mean() > 0.2


@each_arm
def test_with_zero_gains_algorithm_1_gives_the_bits_of_the_conventional_law(name: str) -> None:
    """Gamma = 0 and delta = 0: neither p_hat nor F_c acts."""
    at, loop = meeting(name), closed_loop(name, CRAIG)
    given = {**at.given, "F_hat": loop.given["F_hat"], "p_start": at.p_hat}
    conventional = at.evaluate(HOGAN, given)["tau_cmd"]
    idle = {"Gamma": np.zeros(at.p.shape), "ddq": np.ones(loop.ddq.shape)}
    craig = at.evaluate(CRAIG, given | idle | {"p_hat": at.p_hat})
    rest = {"a_f": np.ones(loop.ddq.shape), "phi_hat": np.zeros(at.p.shape)}
    fixed = at.evaluate(SPONG_ORTEGA, given | idle | rest)
    np.testing.assert_array_equal(craig["tau_cmd"], conventional)
    np.testing.assert_array_equal(fixed["tau_cmd"], conventional)
    np.testing.assert_array_equal(craig["p_hat_next"], at.p_hat)
    np.testing.assert_array_equal(fixed["phi_hat_next"], np.zeros(at.p.shape))


@each_arm
def test_algorithm_2_is_the_conventional_law_on_its_reference(name: str) -> None:
    """With e = de = 0 both laws ask for the acceleration of (3), and s is zero."""
    at, loop = meeting(name), closed_loop(name, SLOTINE_LI)
    arms = at.arms
    given = {**at.given, "F_hat": loop.given["F_hat"], "p_start": at.p_hat, "x_t": arms.x, "dx_t": arms.dx}
    conventional = at.evaluate(HOGAN, given)["tau_cmd"]
    shown = at.evaluate(SLOTINE_LI, given | {"p_hat": at.p_hat, "K_d": np.full(arms.x.shape, 100.0)})
    assert np.abs(shown["s"]).max() < 1e-10
    scale = np.linalg.norm(conventional, axis=1) + norm(arms.H(at.p_hat)) * norm(loop.ddx_t)
    assert (norm(shown["tau_cmd"] - conventional) <= 1e-10 * scale).all()
