"""Evidence for the TIRT, eq. (11): one sample against the matrix exponential, a run against SciPy's integrator."""

from collections.abc import Callable, Iterator
from functools import cache

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fmus.control.tirt import SERIES_LIMIT, Impedance, advance
from tests.property.samples import EPS

Virtual = Callable[[float], np.ndarray]

H = 1e-4  # s
ELLIPSE = np.array([1.5, 1.0])  # m
RATE = np.pi  # rad/s
EDGE = -1.46  # m, where the straight segment holds x1


@cache
def sample() -> ca.Function:
    """`advance` of arrays: x_t, dx_t, x_v, dx_v, ddx_v, F, M, B, K, each of shape (2,), and h."""
    symbols = [ca.SX.sym(name, 2) for name in ("x_t", "dx_t", "x_v", "dx_v", "ddx_v", "F", "M", "B", "K")]
    x_t, dx_t, x_v, dx_v, ddx_v, F, M, B, K = symbols
    h = ca.SX.sym("h")
    result = advance(x_t, dx_t, (x_v, dx_v, ddx_v), F, Impedance(M, B, K), h)
    return ca.Function("advance", [*symbols, h], [ca.horzcat(*result)])


def step(state: np.ndarray, virtual: np.ndarray, F: np.ndarray, impedance: tuple[float, ...], h: float) -> np.ndarray:
    """State of the TIRT after h; state and virtual hold position, rate (and acceleration) by row, shape (., 2)."""
    return np.array(sample()(*state, *virtual, F, *(np.full(2, value) for value in impedance), h)).T


def exponential(
    state: np.ndarray, virtual: np.ndarray, F: np.ndarray, impedance: tuple[float, ...], h: float
) -> np.ndarray:
    """The same from the exponential of (x_t, dx_t, x_v, dx_v, ddx_v, F), with time in units of h: all are lengths."""
    M, B, K = impedance
    b, k = B * h / M, K * h**2 / M
    A = np.zeros((6, 6))
    A[0, 1] = A[2, 3] = A[3, 4] = 1
    A[1] = [-k, -b, k, b, 1, -1]
    scale = np.array([1, h, 1, h, h**2, h**2 / M])
    start = np.concatenate([state, virtual, [F]]) * scale[:, None]
    return (expm(A) @ start)[:2] / scale[:2, None]


def impedances() -> Iterator[tuple[str, float, float, float, float]]:
    """Yield name, M, B, K, h of one case each."""
    critical = 2 * np.sqrt(2.0 * 4000.0)
    yield from (("critical", 2.0, critical, 4000.0, h) for h in (1e-5, 1e-4, 1e-3, 0.05, 1.0))
    yield from (("paper", 2.0, 340.0, 4000.0, h) for h in (2e-5, 1e-4, 1e-2, 0.5))
    yield from (
        ("underdamped", 2.0, ratio * critical, 4000.0, h) for ratio in (0, 1e-3, 0.3, 0.9) for h in (H, 0.02, 0.3)
    )
    yield from (("overdamped", 2.0, ratio * critical, 4000.0, h) for ratio in (1.1, 3.0, 50.0) for h in (H, 0.02, 0.3))
    # The last: exp(-a h) is 0 and cosh(r h) infinite, a h = 5000.
    stiff = ((0.1, 2e3, 1e6), (1e-3, 1e2, 1e5), (1e-2, 1e3, 10.0), (1e-4, 1e2, 1e5))
    yield from (("stiff", M, B, K, 1e-2) for M, B, K in stiff)
    for z in np.concatenate([SERIES_LIMIT * np.linspace(0.9, 1.1, 21), [0, 1e-15, 1e-9, 1e-5, 3e-3, 0.1]]):
        for sign in (
            1,
            -1,
        ):  # z = (a^2 - w2) h^2 at w2 h^2 = 0.2: both sides of the series' limit, and of zero
            yield "near critical", 1.0, 2 * np.sqrt(0.2 + sign * z) / H, 0.2 / H**2, H


@pytest.mark.parametrize(("M", "B", "K", "h"), [pytest.param(*case, id=name) for name, *case in impedances()])
def test_one_sample_is_the_matrix_exponential(M: float, B: float, K: float, h: float) -> None:
    rng = np.random.default_rng(11)
    state, virtual = rng.normal(size=(2, 2)), rng.normal(size=(3, 2))
    F, scale = rng.normal(size=2) * K, np.array([1, h])  # F of K times 1 m
    expected = exponential(state, virtual, F, (M, B, K), h) * scale[:, None]
    value = step(state, virtual, F, (M, B, K), h) * scale[:, None]
    # Everything as lengths. Scaling and squaring rounds A = (k, b) relative to its norm, about log2 |A| times, and exp
    # passes that on times |A|: 10 EPS (1 + |A|) of the largest input, K times 1 m of force included.
    norm = 1 + B * h / M + K * h**2 / M
    inputs = max(np.abs(state * scale[:, None]).max(), np.abs(virtual).max(), 1.0)
    assert np.abs(value - expected).max() <= 10 * EPS * norm * inputs


def ellipse(t: float) -> np.ndarray:
    """x_v, dx_v, ddx_v of the paper's ellipse, shape (3, 2)."""
    c, s = np.cos(RATE * t), np.sin(RATE * t)
    return np.array([[c, s], [-RATE * s, RATE * c], [-(RATE**2) * c, -(RATE**2) * s]]) * ELLIPSE


def straightened(t: float) -> np.ndarray:
    """The ellipse with x1 held at `EDGE` beyond it: corners with a jump of the rate."""
    virtual = ellipse(t)
    if virtual[0, 0] < EDGE:
        virtual[:, 0] = EDGE, 0, 0
    return virtual


def run(virtual: Virtual, forces: np.ndarray, impedance: tuple[float, ...], h: float, t0: float = 0.0) -> np.ndarray:
    """x_t at all samples from t0, starting on the virtual trajectory, shape (len(forces) + 1, 2)."""
    state = virtual(t0)[:2]
    positions = [state[0]]
    for k, F in enumerate(forces):
        state = step(state, virtual(t0 + k * h), F, impedance, h)
        positions.append(state[0])
    return np.array(positions)


def integrated(
    virtual: Virtual, forces: np.ndarray, impedance: tuple[float, ...], h: float, t0: float = 0.0
) -> np.ndarray:
    """The same from eq. (11) by DOP853, sample by sample because the force jumps there; rtol 1e-11."""
    M, B, K = impedance

    def rhs(t: float, y: np.ndarray, F: np.ndarray) -> np.ndarray:
        x_v, dx_v, ddx_v = virtual(t)
        return np.concatenate([y[2:], ddx_v - (B * (y[2:] - dx_v) + K * (y[:2] - x_v) + F) / M])

    y = virtual(t0)[:2].ravel()
    positions = [y[:2]]
    for k, F in enumerate(forces):
        span = (t0 + k * h, t0 + (k + 1) * h)
        y = solve_ivp(rhs, span, y, "DOP853", args=(F,), rtol=1e-11, atol=1e-13).y[:, -1]
        positions.append(y[:2])
    return np.array(positions)


@pytest.mark.parametrize("B", [40.0, 2 * np.sqrt(8000.0), 340.0])
def test_a_run_with_held_force_follows_equation_11_to_first_order_in_the_third_derivative(B: float) -> None:
    """Within a sample x_v is a parabola, so ddx_v lags by h/2 on average: x_t is off by M x_v''' h / (2 K)."""
    impedance, errors = (2.0, B, 4000.0), []
    for h in (2e-3, 1e-3):
        forces = np.random.default_rng(5).normal(0, 200, (100, 2)).repeat(round(2e-3 / h), axis=0)
        errors.append(np.abs(run(ellipse, forces, impedance, h) - integrated(ellipse, forces, impedance, h)).max())
    # Lightly damped, a suddenly applied lag overshoots, at most to twice the static value.
    static = 2.0 * ELLIPSE[0] * RATE**3 * 1e-3 / (2 * 4000.0)
    assert errors[1] <= 2 * static
    # First order: the ratio is 2 up to the next term, of relative size h times the fastest pole, 157/s: 0.16.
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.16)


def test_free_motion_keeps_to_the_virtual_trajectory_within_a_micrometre() -> None:
    """The error is about 1e-6 m at h = 1e-4 s. The bound is M x_v''' h / (2 K) = 1.2e-6 m."""
    virtual = np.array([ellipse(k * H)[0] for k in range(5001)])
    error = np.abs(run(ellipse, np.zeros((5000, 2)), (2.0, 340.0, 4000.0), H) - virtual).max()
    assert 2e-7 < error <= 2.0 * ELLIPSE[0] * RATE**3 * H / (2 * 4000.0)


def test_a_corner_of_the_virtual_trajectory_is_treated_as_equation_11_demands() -> None:
    """x_t moves on smoothly where x_v stops: carrying d = x_t - x_v over the corner would miss this by 5 mm."""
    impedance, t0 = (2.0, 340.0, 4000.0), np.arccos(EDGE / ELLIPSE[0]) / RATE
    forces = np.zeros((600, 2))
    x_t = run(straightened, forces, impedance, H, t0 - 100 * H - H / 3)
    expected = integrated(straightened, forces, impedance, H, t0 - 100 * H - H / 3)
    virtual = np.array([straightened(t0 - 100 * H - H / 3 + k * H)[0] for k in range(601)])
    # x_v's rate of 1.08 m/s stops H/3 into a sample and is held to its end: off by 1.08 * 2/3 H, decaying.
    jump = RATE * ELLIPSE[0] * np.sin(RATE * t0)
    assert np.abs(x_t - expected).max() <= jump * H
    # The excursion of d'' + 170 d' + 2000 d = 0 from d' = 1.08 m/s is 5.5 mm; without it d would stay below 2e-6 m.
    assert np.abs(x_t - virtual).max() == pytest.approx(5.5e-3, abs=0.1e-3)
