"""The paper's formulas at one tick, written in tip space as the paper writes them; NumPy on closed forms.

What the FMUs do in joint space, without an inverse of H_x, is done here with the matrices of
tests/property/pose.py.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tests.property.pose import Pose


@dataclass(frozen=True)
class Gains:
    """Parameters of a controller; per axis of shape (2,), per element of p of shape (6,). Gains may be matrices."""

    M: np.ndarray
    B: np.ndarray
    K: np.ndarray
    Psi: np.ndarray
    K_d: np.ndarray
    Gamma: np.ndarray
    p_start: np.ndarray
    noise_bound: float
    contact_threshold: float
    gamma_margin: float
    gamma_eps: float
    acc_filter_time: float
    sample_time: float


@dataclass(frozen=True)
class Tick:
    """Inputs and states of a controller at a tick: shape (2,) each, p_hat (6,); a_f is the filtered ddq."""

    pose: Pose
    ddq: np.ndarray
    F_hat: np.ndarray
    x_v: np.ndarray
    dx_v: np.ndarray
    ddx_v: np.ndarray
    x_t: np.ndarray
    dx_t: np.ndarray
    p_hat: np.ndarray
    a_f: np.ndarray

    @property
    def e(self) -> np.ndarray:
        """M."""
        return self.pose.x - self.x_t

    @property
    def de(self) -> np.ndarray:
        """m/s."""
        return self.pose.dx - self.dx_t

    def demand(self, x: np.ndarray, dx: np.ndarray, gains: Gains) -> np.ndarray:
        """Acceleration that (3) asks for at x, dx; at x_t, dx_t that of (11). m/s2."""
        pull = times(gains.B, dx - self.dx_v) + times(gains.K, x - self.x_v) + self.F_hat
        return self.ddx_v - times(inverse(gains.M), pull)


@dataclass(frozen=True)
class Answer:
    """What a controller should show, and dp_hat/dt; `scales` are the sizes of the terms that make each up."""

    outputs: dict[str, np.ndarray]
    rate: np.ndarray
    scales: Mapping[str, float | np.floating]


def times(A: np.ndarray, v: np.ndarray) -> np.ndarray:
    """A v for a matrix, or for the diagonal of one."""
    return A * v if A.ndim == 1 else A @ v


def inverse(A: np.ndarray) -> np.ndarray:
    """Inverse of a matrix, or of a diagonal one."""
    return 1 / A if A.ndim == 1 else np.linalg.inv(A)


def matrix(A: np.ndarray) -> np.ndarray:
    """A matrix, also of its diagonal."""
    return np.diag(A) if A.ndim == 1 else A


def augmented(tick: Tick, gains: Gains) -> np.ndarray:
    """e* of (14), s of (30): de + Psi e, m/s."""
    return tick.de + times(gains.Psi, tick.e)


def craig(tick: Tick, gains: Gains, *, fixed: bool = False) -> Answer:
    """Algorithm 1, (10), (19), (22) to (26); with `fixed` remark 2 of III-C."""
    pose, norm = tick.pose, np.linalg.norm
    p = gains.p_start if fixed else tick.p_hat
    H, e_star = pose.H_x(p), augmented(tick, gains)
    watched, scales = rejection(tick, gains, H)
    demand = tick.demand(pose.x, pose.dx, gains)
    if fixed:
        W = pose.W(pose.dx, pose.acceleration(tick.a_f))
        demand = demand - np.linalg.solve(H, W @ (gains.p_start - tick.p_hat))
    F = tick.F_hat + pose.force(p, pose.dx, demand) + watched["F_c"]
    W_c = pose.W(pose.dx, pose.acceleration(tick.ddq))
    terms = [tick.F_hat, pose.C_x(p) @ pose.dx, pose.bias_x(p), watched["F_c"]]
    size = sum(norm(term) for term in terms) + norm(H) * norm(demand)
    return Answer(
        outputs={"tau_cmd": pose.J.T @ F, **watched},
        rate=-times(gains.Gamma, W_c.T @ np.linalg.solve(H, e_star)),
        scales={
            "tau_cmd": norm(pose.J) * size,
            **scales,
            "rate": norm(matrix(gains.Gamma) @ W_c.T) * scales["mu"],
        },
    )


def slotine_li(tick: Tick, gains: Gains) -> Answer:
    """Algorithm 2, (32) and (33)."""
    pose, norm, s = tick.pose, np.linalg.norm, augmented(tick, gains)
    dx_r = tick.dx_t - times(gains.Psi, tick.e)
    ddx_r = tick.demand(tick.x_t, tick.dx_t, gains) - times(gains.Psi, tick.de)
    F = pose.force(tick.p_hat, dx_r, ddx_r) + tick.F_hat - times(gains.K_d, s)
    W_s, H, C = pose.W(dx_r, ddx_r), pose.H_x(tick.p_hat), pose.C_x(tick.p_hat)
    size = norm(tick.F_hat) + norm(pose.bias_x(tick.p_hat)) + norm(times(gains.K_d, s))
    size += norm(H) * norm(ddx_r) + norm(C) * norm(dx_r)
    return Answer(
        outputs={"tau_cmd": pose.J.T @ F, "s": s},
        rate=-times(gains.Gamma, W_s.T @ s),
        scales={
            "tau_cmd": norm(pose.J) * size,
            "s": norm(s),
            "rate": norm(matrix(gains.Gamma) @ W_s.T) * norm(s),
        },
    )


def rejection(tick: Tick, gains: Gains, H: np.ndarray) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """The watched quantities of (14), (22) to (26), and their scales; H is H_hat_x.

    alpha is minus the derivative of X' P X along e'' + B_n e' + K_n e = 0, with P of (A2): no use of the
    paper's Q.
    """
    e_star, mobility = augmented(tick, gains), np.linalg.inv(H)
    delta = gains.noise_bound if np.linalg.norm(tick.F_hat) > gains.contact_threshold else 0.0
    by_M, psi = matrix(inverse(gains.M)), matrix(gains.Psi)
    k, b = by_M @ matrix(gains.K), by_M @ matrix(gains.B)
    first = psi @ b + k.T
    P = np.block([[(first + first.T) / 2, psi], [psi, np.eye(2)]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-k, -b]])
    X = np.concatenate([tick.e, tick.de])
    alpha = -X @ (A.T @ P + P @ A) @ X
    beta, mu = np.linalg.norm(e_star), np.linalg.norm(mobility @ e_star)
    layer, stretch = beta**2 + gains.gamma_eps**2, np.linalg.norm(mobility, 2)
    gamma = gains.gamma_margin * max(0.0, (2 * mu * delta - alpha) / layer)
    bound = 4 * delta**2 * stretch**2 * (2 * beta * delta * stretch - alpha) / alpha**2
    case_c = delta > 0 and 0 < alpha <= 2 * mu * delta
    F_c = -0.5 * gamma * H @ e_star
    largest = gains.gamma_margin * (2 * mu * delta + alpha) / layer
    values = {"e_star": e_star, "alpha": alpha, "beta": beta, "mu": mu, "gamma": gamma, "F_c": F_c}
    values["gamma_bound"] = max(0.0, bound) if case_c else 0.0
    scales = {name: float(np.linalg.norm(value)) for name, value in values.items()}
    scales |= {"gamma": float(largest), "mu": float(stretch * beta)}
    scales["F_c"] = float(0.5 * largest * np.linalg.norm(H) * beta)
    return {name: np.atleast_1d(value) for name, value in values.items()}, scales
