"""Tests of full gain matrices: the TIRT of coupled axes, turned problems, and which matrices are refused.

The laws with full matrices are compared with the paper's formulas tick by tick in test_adaptation_ticks.py.
"""

from collections.abc import Iterator, Mapping
from functools import cache

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from fmus import start as start_of_arm
from fmus.control.full_tirt import LARGEST_NORM, FullImpedance, exponential_minus_identity
from fmus.control.tirt import Impedance
from orchestration import Result, System, TimeSeries, simulate
from orchestration.paper.built_fmus import built
from tests.property.samples import EPS
from tests.property.ticks import elements

NAMES = ("HoganImpedance", "CraigAdaptiveImpedance", "SlotineLiAdaptiveImpedance", "SpongOrtegaAdaptiveImpedance")
ANGLE = np.radians(30.0)
TURN = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
STEP, STOP = 1e-4, 1.2  # s: contact is from 0.92 s to 1.08 s
WALL, DEPTH = 1.45, 0.01  # m


def definite(rng: np.random.Generator, size: float) -> np.ndarray:
    """A symmetric positive definite matrix of about a size, with any axes and a condition up to some 100."""
    X = rng.normal(size=(2, 2))
    return size * (X @ X.T + 0.05 * np.eye(2))


@cache
def exponential() -> ca.Function:
    """The map from A to exp(A) - I."""
    A = ca.SX.sym("A", 4, 4)
    return ca.Function("exponential", [A], [exponential_minus_identity(A)])


@pytest.mark.parametrize("size", [1e-9, 1e-4, 1e-2, 1.0, 30.0, 1e3, 3e4])
def test_the_exponential_is_that_of_scipy(size: float) -> None:
    rng = np.random.default_rng(7)
    for _ in range(50):
        M, B, K = (definite(rng, 1.0) for _ in range(3))
        A = np.block([[np.zeros((2, 2)), np.eye(2)], [-size * np.linalg.solve(M, K), -size * np.linalg.solve(M, B)]])
        norm = np.abs(A).sum(axis=1).max()
        if norm >= LARGEST_NORM:
            continue
        expected, value = expm(A), np.array(exponential()(A)) + np.eye(4)
        # Both round A relative to its norm, and exp passes that on. As in test_tirt.py; seen: 2.6 EPS (1 + norm).
        assert np.abs(value - expected).max() <= 10 * EPS * (1 + norm) * np.abs(expected).max()


def test_small_elements_of_the_exponential_keep_their_digits() -> None:
    """A sample of 1 us moves the rate by 4e-9 of the deviation: relative to 1, eight digits would be gone."""
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-4e-9, 1e-9, -2e-4, 5e-5], [1e-9, -3e-9, 5e-5, -1e-4]])
    # E = A + A^2/2 + ...; for the norm of 1 that the unit blocks have the series needs 20 terms.
    expected, term = np.zeros((4, 4)), np.eye(4)
    for k in range(1, 21):
        term = term @ A / k
        expected += term
    # Twenty squarings of two roundings each.
    np.testing.assert_allclose(np.array(exponential()(A)), expected, rtol=50 * EPS)


@cache
def sample(kind: type) -> ca.Function:
    """`advance` of an impedance as a function of x_t, dx_t, x_v, dx_v, ddx_v, F, M, B, K and h."""
    x_t, dx_t, x_v, dx_v, ddx_v, F = symbols = [ca.SX.sym(name, 2) for name in ("x", "dx", "xv", "dxv", "ddxv", "F")]
    columns = 2 if kind is FullImpedance else 1
    M, B, K = matrices = [ca.SX.sym(name, 2, columns) for name in "MBK"]
    h = ca.SX.sym("h")
    result = kind(M, B, K).advance(x_t, dx_t, (x_v, dx_v, ddx_v), F, h)
    return ca.Function("advance", [*symbols, *matrices, h], [ca.horzcat(*result)])


def cases() -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, float]]:
    """M, B, K with axes of their own, and the length of a sample."""
    rng = np.random.default_rng(17)
    for h in (1e-6, 1e-4, 1e-3, 0.05):
        for _ in range(10):
            yield definite(rng, 2.0), definite(rng, 340.0), definite(rng, 4000.0), h


def test_one_sample_of_coupled_axes_is_the_matrix_exponential() -> None:
    """As in test_tirt.py: the exponential of (x_t, dx_t, x_v, dx_v, ddx_v, F) in units of h is the reference."""
    rng = np.random.default_rng(23)
    for M, B, K, h in cases():
        state, virtual, F = rng.normal(size=(2, 2)), rng.normal(size=(3, 2)), 100 * rng.normal(size=2)
        b, k, m = h * np.linalg.solve(M, B), h**2 * np.linalg.solve(M, K), h**2 * np.linalg.inv(M)
        A = np.zeros((12, 12))
        A[:2, 2:4] = A[4:6, 6:8] = A[6:8, 8:10] = np.eye(2)
        A[2:4] = np.hstack([-k, -b, k, b, np.eye(2), -m])
        start = np.concatenate([*(state * [[1], [h]]), *(virtual * [[1], [h], [h**2]]), F])
        expected = (expm(A) @ start)[:4]
        x, dx = np.array(sample(FullImpedance)(*state, *virtual, F, M, B, K, h)).T
        norm = 1 + np.abs(A).sum(axis=1).max()
        # K^-1 F, the rest, is solved from F: it loses the condition of K.
        size = np.abs(start[:10]).max() + np.linalg.cond(K) * np.linalg.norm(np.linalg.solve(K, F))
        assert np.abs(np.concatenate([x, h * dx]) - expected).max() <= 10 * EPS * norm * np.linalg.cond(M) * size


def test_diagonal_matrices_give_the_sample_of_their_diagonals() -> None:
    rng = np.random.default_rng(3)
    for h in (2e-5, 1e-4, 1e-2):
        arguments = rng.normal(size=(6, 2))
        M, B, K = (rng.uniform(low, high, 2) for low, high in ((0.5, 5), (50, 500), (500, 8000)))
        plain = np.array(sample(Impedance)(*arguments, M, B, K, h))
        full = np.array(sample(FullImpedance)(*arguments, np.diag(M), np.diag(B), np.diag(K), h))
        # Some ten roundings of positions of 3 m; a rate is a difference of lengths over h, with EPS times dx_t itself.
        np.testing.assert_allclose(full, plain, rtol=0, atol=100 * EPS * np.abs(arguments).max())


def virtual(t: np.ndarray) -> dict[str, np.ndarray]:
    """The paper's ellipse with its straight segment: x_v, dx_v, ddx_v, shape (size, 2) each."""
    w, c, s = np.pi, np.cos(np.pi * t), np.sin(np.pi * t)
    x = np.column_stack([1.5 * c, s])
    dx, ddx = np.column_stack([-1.5 * w * s, w * c]), -(w**2) * x
    straight = x[:, 0] < -(WALL + DEPTH)
    x[straight, 0], dx[straight, 0], ddx[straight, 0] = -(WALL + DEPTH), 0, 0
    return {"x_v": x, "dx_v": dx, "ddx_v": ddx}


def run(controller: str, start: Mapping[str, np.ndarray | float], turn: np.ndarray) -> Result:
    """The paper's task with everything turned about the arm's base; `start` are values of the controller.

    The trajectory comes as time series, since the FMU's ellipse has its axes along x1 and x2.
    """
    fmus = {"sensor": "ForceSensor", "controller": controller, "actuator": "Actuator", "plant": "Plant"}
    system = System.of({name: built(identifier) for name, identifier in fmus.items()}).connect()
    values: dict[str, float] = {}
    for name, value in start.items():
        values |= elements(name, value) if isinstance(value, np.ndarray) else {name: value}
    system = system.set({f"controller.{name}": value for name, value in values.items()})
    q1 = start_of_arm.ARMS[2].q[0] + np.arctan2(turn[1, 0], turn[0, 0])
    system = system.set({"plant.q_start[1]": q1, "plant.wall_normal": list(turn @ [-1.0, 0.0])})
    t = STEP * np.arange(round(STOP / STEP) + 1)
    series = {
        f"controller.{name}": TimeSeries(t, values @ turn.T, interpolation="held")
        for name, values in virtual(t).items()
    }
    return simulate(system, STOP, STEP, inputs=series)


def diagonals(controller: str) -> dict[str, np.ndarray | float]:
    """Gains that differ between normal and tangent, and a wrong mass for the adaptive laws.

    The boundary layer of F_c is wide: in a thin one the torque chatters, and a rounding becomes newtons.
    """
    gains: dict[str, np.ndarray | float] = {
        "M": np.array([2.0, 3.0]),
        "B": np.array([340.0, 300.0]),
        "K": np.array([4000.0, 2500.0]),
    }
    if controller == "HoganImpedance":
        return gains
    gains |= {"Psi": np.array([90.0, 60.0]), "p_start": np.array([2.0, 1.5, 0, 0, 0, 0])}
    gains["Gamma"] = np.array([0.5, 4.0, 0, 0, 0, 0])
    if controller == "SlotineLiAdaptiveImpedance":
        return gains | {"K_d": np.array([100.0, 70.0])}
    return gains | {"noise_bound": 30.0, "gamma_eps": 0.1}


def matrices(gains: Mapping[str, np.ndarray | float], turn: np.ndarray) -> dict[str, np.ndarray | float]:
    """The gains as matrices with turned axes; Gamma acts on p, which has no axes in the plane."""
    turned: dict[str, np.ndarray | float] = dict(gains)
    for name in ("M", "B", "K", "Psi", "K_d"):
        if name in gains:
            turned[name] = turn @ np.diag(gains[name]) @ turn.T
    if "Gamma" in gains:
        turned["Gamma"] = np.diag(gains["Gamma"])
    return turned


@pytest.mark.parametrize("controller", NAMES)
@pytest.mark.parametrize("turn", [np.eye(2), TURN], ids=["straight", "turned by 30 degrees"])
def test_a_turned_problem_has_the_turned_result(controller: str, turn: np.ndarray) -> None:
    """Diagonal matrices do in the variant what they do in the plain FMU, and so they do along turned axes.

    The runs differ by rounding: a position of 1.5 m by some EPS, which the loop forgets within 1/Psi, 100 samples. So
    positions agree to 100 samples of 10 EPS of 1.5 m. A rate is such a difference over a sample, 3e-9 m/s, and gains of
    up to H_hat_x (B/M + gamma/2) = 1000 N.s/m act on it. Seen: 1.3e-14 m, 4e-10 N.m, 1.4e-12 kg.
    """
    gains = diagonals(controller)
    plain = run(controller, gains, np.eye(2))
    full = run(f"{controller}Full", matrices(gains, turn), turn)
    assert np.abs(plain["plant.F_ext"]).max() > 100  # N: the tip does meet the wall
    position = 1000 * EPS * 1.5  # m
    torque = 1000 * position / STEP  # N.m
    for name in ("plant.x", "controller.x_t", "controller.e"):
        assert np.abs(full[name] - plain[name] @ turn.T).max() <= position, name
    assert np.abs(full["controller.tau_cmd"] - plain["controller.tau_cmd"]).max() <= torque
    # Gamma W' H^-1 is up to 1000 kg/(m/s) per second here, and a rounding of e* lasts for 100 samples.
    assert np.abs(full["controller.p_hat"] - plain["controller.p_hat"]).max() <= 1000 * (position / STEP) * 100 * STEP


def test_a_stiffness_along_an_oblique_wall_is_soft_across_it() -> None:
    """Pushed with 40 N across and along axes at 30 degrees, x_t comes to rest at force over stiffness of each axis."""
    K = TURN @ np.diag([500.0, 4000.0]) @ TURN.T
    M, B = 2 * np.eye(2), 300 * np.eye(2)
    x, dx = np.zeros(2), np.zeros(2)
    F = TURN @ np.array([40.0, 40.0])
    for _ in range(400):  # 4 s; the slowest pole is K/B = 1.7 1/s of the soft axis
        x, dx = np.array(sample(FullImpedance)(x, dx, *np.zeros((3, 2)), F, M, B, K, 0.01)).T
    # exp(-1.7 * 4) = 1e-3 of the deflection is left.
    np.testing.assert_allclose(TURN.T @ x, [-40 / 500, -40 / 4000], rtol=2e-3, atol=0)
