"""Theory for a task of position and angle, n = m = 3: (12), (20) and (35) of the declared plant and controllers.

    e'' + B_n e' + K_n e = H_hat_x^-1 (W_c phi + F_c + dF_e)                    (12); H_0 in the variant
    dV_c/dt = -alpha + 2 e*' S^2 H_hat_x^-1 (F_c + dF_e)                        (20), S = diag(1, 1, L)
    dV_s/dt = -s' K_d s + s' dF_e                                               (35)

phi = p_hat - p, dF_e = F_hat - F_ext. The right sides come from `tests.property.chains`. Plant and controller are
evaluated together, as tests/property/test_adaptation_dynamics.py does for two joints.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from tests.property.chains import Chains
from tests.property.definitions import outputs

SIZE = 1000
TOLERANCE = 1e-10  # of the largest terms; rounding: see `test_samples_are_well_conditioned`
PLANT = "Plant3RPose"
CRAIG, SLOTINE_LI, SPONG_ORTEGA = (
    "CraigAdaptiveImpedance3RPose",
    "SlotineLiAdaptiveImpedance3RPose",
    "SpongOrtegaAdaptiveImpedance3RPose",
)
TS = 1e-4  # s, start of the sampling period
Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Meeting:
    """A plant and a controller at the same states: inputs by name, shape (k, SIZE), and what the paper's terms need."""

    plant: Columns
    controller: Columns
    p: np.ndarray
    p_hat: np.ndarray
    chains: Chains

    def of(self, name: str) -> np.ndarray:
        """A vector that the controller is given, shape (SIZE, k)."""
        return self.controller[name].T


@dataclass(frozen=True)
class Loop:
    """Closed loop of a law: accelerations, errors and forces, shape (SIZE, 3); p of shape (SIZE, 9)."""

    shown: Columns
    ddx: np.ndarray
    e: np.ndarray
    de: np.ndarray
    ddx_t: np.ndarray
    F_ext: np.ndarray
    F_hat: np.ndarray
    given: Columns
    condition: np.ndarray


def norm(vectors: np.ndarray) -> np.ndarray:
    """Euclidean norm of each row, or of each matrix."""
    return np.linalg.norm(vectors.reshape(len(vectors), -1), axis=1)


def apply(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Product of a matrix and a vector at each sample."""
    return np.einsum("kij,kj->ki", matrices, vectors)


@cache
def meeting() -> Meeting:
    """Arms like the default one, half of them in contact; e, e' of the size of 1 cm, 0.05 rad and 1 m/s."""
    rng = np.random.default_rng(12)

    def uniform(low: float, high: float, k: int = 3) -> np.ndarray:
        return rng.uniform(low, high, (k, SIZE))

    q = uniform(-np.pi, np.pi)
    q[1] = rng.uniform(0.8, 2.2, SIZE) * rng.choice([-1, 1], SIZE)
    dq, l = uniform(-3, 3), np.vstack([uniform(0.8, 1.2, 2), uniform(0.4, 0.7, 1)])
    p, p_hat = (np.vstack([uniform(1, 3), uniform(0, 2, 6)]) for _ in range(2))
    gravity, coulomb_velocity = uniform(0, 10, 1), uniform(0.05, 0.5, 1)
    chains = Chains(q.T, dq.T, l.T, gravity[0], coulomb_velocity[0])
    x, dx = chains.x.T, chains.dx.T
    common = {"q": q, "dq": dq, "l": l, "gravity": gravity, "coulomb_velocity": coulomb_velocity}
    turn, depth = uniform(-np.pi, np.pi, 1), uniform(-0.005, 0.005, 1)
    normal = np.vstack([np.cos(turn), np.sin(turn)])
    plant = {
        **common,
        "m": p[:3],
        "viscous": p[3:6],
        "coulomb": p[6:],
        "wall_normal": normal,
        "wall_offset": (normal * x[:2]).sum(axis=0, keepdims=True) - depth,
        "mu": uniform(0, 0.5, 1),
        "mode_contact": (depth > 0).astype(float),
        "mode_pushing": np.ones((1, SIZE)),
    }
    scale = np.array([[1.0], [1.0], [0.15]])  # what is 1 m of a position is 1/0.15 rad of an angle
    M, B = uniform(0.5, 5) * scale**2, uniform(100, 500) * scale**2
    controller = {**common, "M": M, "B": B, "K": uniform(500, 8000) * scale**2, "Psi": uniform(0.2, 0.9) * B / M}
    for name, middle, width in (
        ("x_v", x, 0.01),
        ("dx_v", dx, 0.5),
        ("ddx_v", 0, 20),
        ("x_t", x, 0.01),
        ("dx_t", dx, 0.5),
    ):
        controller[name] = middle + width / scale * rng.normal(size=(3, SIZE))
    return Meeting(plant, controller, p.T, p_hat.T, chains)


@cache
def closed_loop(law: str) -> Loop:
    """The acceleration at which the torque of a law and the equation of motion fit each other."""
    at, rng = meeting(), np.random.default_rng(15)
    F_ext = outputs(PLANT, **at.plant)["F_ext"]
    given = {**at.controller, "F_hat": F_ext.T + rng.normal(0, [[30], [30], [5]], (3, SIZE))}
    given["Gamma"] = rng.uniform(0.5, 5, (9, SIZE))
    given["L"] = rng.uniform(0.1, 0.3, (1, SIZE))
    if law == SLOTINE_LI:
        given |= {"p_hat": at.p_hat.T, "K_d": rng.uniform(10, 300, (3, SIZE))}
    else:
        given["noise_bound"] = rng.uniform(0, 200, (1, SIZE))
    if law == CRAIG:
        given["p_hat"] = at.p_hat.T
    if law == SPONG_ORTEGA:
        given |= {"p_start": at.p.T + 1, "phi_hat": (at.p + 1 - at.p_hat).T, "acc_filter_time": np.zeros((1, SIZE))}

    def acceleration(ddq: np.ndarray) -> tuple[np.ndarray, Columns]:
        more = {"ddq": ddq, "a_f": ddq} if law == SPONG_ORTEGA else {"ddq": ddq}
        shown = outputs(law, **given, **more)
        return outputs(PLANT, **at.plant, tau=shown["tau_cmd"].T)["ddq"].T, shown

    # The torque of the variant is affine in ddq, since a_f = ddq without the filter; that of the others is constant.
    c = acceleration(np.zeros((3, SIZE)))[0]
    G = np.stack([acceleration(np.tile(unit[:, None], SIZE))[0] - c for unit in np.eye(3)], axis=2).transpose(1, 0, 2)
    ddq = np.linalg.solve(np.eye(3) - G, c.T[..., None])[..., 0]
    _, shown = acceleration(ddq.T)
    e, de = at.chains.x - at.of("x_t"), at.chains.dx - at.of("dx_t")
    pull = at.of("B") * (at.of("dx_t") - at.of("dx_v")) + at.of("K") * (at.of("x_t") - at.of("x_v")) + given["F_hat"].T
    ddx_t = at.of("ddx_v") - pull / at.of("M")  # (11)
    condition = np.maximum(1.0, np.linalg.cond(np.eye(3) - G))
    transposed = {name: values.T for name, values in given.items()}
    return Loop(shown, at.chains.acceleration(ddq), e, de, ddx_t, F_ext, given["F_hat"].T, transposed, condition)


def test_samples_are_well_conditioned() -> None:
    at = meeting()
    assert max(at.chains.rounding(p) for p in (at.p, at.p_hat)) < TOLERANCE
    touching = np.any(closed_loop(CRAIG).F_ext != 0, axis=1)
    assert 0.3 < touching.mean() < 0.7
    assert (closed_loop(CRAIG).F_ext[:, 2] == 0).all()  # a point contact has no moment about the tip


@pytest.mark.parametrize("law", [CRAIG, SPONG_ORTEGA])
def test_algorithm_1_obeys_equation_12(law: str) -> None:
    at, loop = meeting(), closed_loop(law)
    chains, M = at.chains, at.of("M")
    dde = loop.ddx - loop.ddx_t
    left = dde + at.of("B") / M * loop.de + at.of("K") / M * loop.e
    W = chains.W(chains.dx, loop.ddx)
    parts = [apply(W, at.p_hat - at.p), loop.shown["F_c"], loop.F_hat - loop.F_ext]
    mobility = np.linalg.inv(chains.H_x(loop.given["p_start"] if law == SPONG_ORTEGA else at.p_hat))
    size = norm(mobility) * sum(norm(part) for part in parts)
    size += norm(dde) + norm(at.of("B") / M * loop.de) + norm(at.of("K") / M * loop.e)
    assert (norm(left - apply(mobility, np.sum(parts, axis=0))) <= TOLERANCE * size * loop.condition).all()
    assert {(bool(f.any()), bool(g > 0)) for f, g in zip(loop.F_ext, loop.shown["gamma"][:, 0], strict=True)} == {
        (False, False),
        (False, True),
        (True, False),
        (True, True),
    }


@pytest.mark.parametrize("law", [CRAIG, SPONG_ORTEGA])
def test_the_lyapunov_function_of_algorithm_1_changes_as_equation_20_says(law: str) -> None:
    """V_c in coordinates of one unit: S e for e, with the adaptation that the controller declares."""
    at, loop = meeting(), closed_loop(law)
    chains, Psi, shown = at.chains, at.of("Psi"), loop.shown
    k, b = at.of("K") / at.of("M"), at.of("B") / at.of("M")
    weight = np.column_stack([np.ones((SIZE, 2)), loop.given["L"]]) ** 2
    dde = loop.ddx - loop.ddx_t
    # d/dt of ((k + psi b) e^2 + 2 psi e de + de^2) per axis, and of phi' Gamma^-1 phi
    terms = [
        weight * 2 * (k + Psi * b) * loop.e * loop.de,
        weight * 2 * Psi * (loop.de**2 + loop.e * dde),
        weight * 2 * loop.de * dde,
    ]
    state = "phi_hat" if law == SPONG_ORTEGA else "p_hat"
    moved = (shown[f"{state}_next"] - loop.given[state]) / TS
    rate = -moved if law == SPONG_ORTEGA else moved
    learning = 2 * (at.p_hat - at.p) / loop.given["Gamma"] * rate
    growth = sum(term.sum(axis=1) for term in terms) + learning.sum(axis=1)
    e_star = loop.de + Psi * loop.e
    mobility = np.linalg.inv(chains.H_x(loop.given["p_start"] if law == SPONG_ORTEGA else at.p_hat))
    through = apply(mobility, weight * e_star)
    expected = -shown["alpha"][:, 0] + 2 * ((shown["F_c"] + loop.F_hat - loop.F_ext) * through).sum(axis=1)
    size = sum(np.abs(term).sum(axis=1) for term in (*terms, learning)) + np.abs(shown["alpha"][:, 0])
    size += norm(mobility) * norm(weight * e_star) * (norm(shown["F_c"]) + norm(loop.F_hat) + norm(loop.F_ext))
    # p_hat moves by Ts times its rate, and the difference of two values of p_hat rounds.
    size += norm(at.p_hat - at.p) / loop.given["Gamma"].min(axis=1) * 20 * norm(at.p_hat) * (1e-16 / TS) / TOLERANCE
    assert (np.abs(growth - expected) <= TOLERANCE * size * loop.condition).all()
    metres = np.sqrt(weight) * e_star
    np.testing.assert_allclose(shown["beta"][:, 0], norm(metres), rtol=1e-10)
    np.testing.assert_allclose(shown["mu"][:, 0], norm(np.sqrt(weight) * through), rtol=1e-9)


@pytest.mark.parametrize("law", [CRAIG, SPONG_ORTEGA])
def test_gamma_lets_the_lyapunov_function_fall_for_every_error_within_the_bound(law: str) -> None:
    """(21) to (25): with |S^-1 dF_e| <= delta the right side of (20) is not positive outside the boundary layer."""
    at, loop = meeting(), closed_loop(law)
    shown, weight = loop.shown, np.column_stack([np.ones((SIZE, 2)), loop.given["L"]]) ** 2
    e_star = loop.de + at.of("Psi") * loop.e
    mobility = np.linalg.inv(at.chains.H_x(loop.given["p_start"] if law == SPONG_ORTEGA else at.p_hat))
    through = np.sqrt(weight) * apply(mobility, weight * e_star)  # in metres; the worst error points along it
    delta = np.where(norm(loop.F_hat) > 0, loop.given["noise_bound"][:, 0], 0)
    worst = (
        2 * delta * norm(through) - shown["alpha"][:, 0] + 2 * (shown["F_c"] * through / np.sqrt(weight)).sum(axis=1)
    )
    scale = shown["alpha"][:, 0] + 2 * delta * norm(through)
    assert (worst <= 1e-8 * scale).all()
    assert (shown["gamma"][:, 0] > 0).any()
    bound = shown["gamma_bound"][:, 0]  # (26), where case (c) holds
    needed = (2 * shown["mu"][:, 0] * delta - shown["alpha"][:, 0]) / shown["beta"][:, 0] ** 2
    assert ((bound == 0) | (bound >= needed * (1 - 1e-9))).all()
    assert (bound > 0).any()


def test_algorithm_2_obeys_its_error_dynamics_and_equation_35() -> None:
    at, loop = meeting(), closed_loop(SLOTINE_LI)
    chains, Psi, K_d = at.chains, at.of("Psi"), loop.given["K_d"]
    dx_r, ddx_r = at.of("dx_t") - Psi * loop.e, loop.ddx_t - Psi * loop.de
    s, ds, phi = chains.dx - dx_r, loop.ddx - ddx_r, at.p_hat - at.p
    error = loop.F_hat - loop.F_ext
    inertial, coriolis = apply(chains.H_x(at.p), ds), apply(chains.C_x(at.p), s)
    driving = apply(chains.W(dx_r, ddx_r), phi)
    size = norm(chains.H_x(at.p)) * (norm(loop.ddx) + norm(ddx_r)) + norm(coriolis) + norm(K_d * s) + norm(driving)
    size += norm(loop.F_hat) + norm(loop.F_ext)
    assert (norm(inertial + coriolis + K_d * s - driving - error) <= TOLERANCE * size).all()
    np.testing.assert_allclose(loop.shown["s"], s, rtol=0, atol=1e-11)
    # s' dH_x/dt s / 2 is s' C_x s, since dH_x/dt - 2 C_x is skew.
    rate = (loop.shown["p_hat_next"] - loop.given["p_hat"]) / TS
    learning = phi / loop.given["Gamma"] * rate
    growth = (s * (inertial + coriolis)).sum(axis=1) + learning.sum(axis=1)
    expected = -(s * K_d * s).sum(axis=1) + (s * error).sum(axis=1)
    rounding = norm(phi) / loop.given["Gamma"].min(axis=1) * 20 * norm(at.p_hat) * 1e-16 / TS
    assert (np.abs(growth - expected) <= TOLERANCE * (norm(s) * size + np.abs(learning).sum(axis=1)) + rounding).all()
    assert (expected < 0).mean() > 0.2


def test_with_zero_gains_algorithm_1_gives_the_bits_of_the_conventional_law() -> None:
    """Gamma = 0 and delta = 0: neither p_hat nor F_c acts."""
    at, loop = meeting(), closed_loop(CRAIG)
    given = {**at.controller, "F_hat": loop.F_hat.T, "p_start": at.p_hat.T}
    conventional = outputs("HoganImpedance3RPose", **given)["tau_cmd"]
    idle = {"Gamma": np.zeros((9, SIZE)), "ddq": np.ones((3, SIZE))}
    craig = outputs(CRAIG, **given, **idle, p_hat=at.p_hat.T)
    fixed = outputs(SPONG_ORTEGA, **given, **idle, a_f=np.ones((3, SIZE)), phi_hat=np.zeros((9, SIZE)))
    np.testing.assert_array_equal(craig["tau_cmd"], conventional)
    np.testing.assert_array_equal(fixed["tau_cmd"], conventional)
    np.testing.assert_array_equal(craig["p_hat_next"], at.p_hat)
    np.testing.assert_array_equal(fixed["phi_hat_next"], np.zeros((SIZE, 9)))


def test_algorithm_2_is_the_conventional_law_on_its_reference() -> None:
    """With e = de = 0 both laws ask for the acceleration of (3), and s is zero."""
    at, loop = meeting(), closed_loop(SLOTINE_LI)
    chains = at.chains
    given = {**at.controller, "F_hat": loop.F_hat.T, "p_start": at.p_hat.T}
    given |= {"x_t": chains.x.T, "dx_t": chains.dx.T}
    conventional = outputs("HoganImpedance3RPose", **given)["tau_cmd"]
    shown = outputs(SLOTINE_LI, **given, p_hat=at.p_hat.T, K_d=np.full((3, SIZE), 100.0))
    assert np.abs(shown["s"]).max() < 1e-10
    scale = np.linalg.norm(conventional, axis=1) + norm(chains.H(at.p_hat)) * norm(loop.ddx_t)
    assert (norm(shown["tau_cmd"] - conventional) <= 1e-10 * scale).all()
