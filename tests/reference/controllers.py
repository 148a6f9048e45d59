"""The four impedance controllers of the reference: torque, adaptation and reference trajectory in closed form.

Lu and Meng (1991). At a tick, with e = x - x_t, e' = dx - dx_t, ddq* = J^-1 (a - dJ/dt dq),
a = ddx_v - M^-1 [B (dx - dx_v) + K (x - x_v) + F_hat] and H^, C^, g^, f^ at p_hat:

    HoganImpedance               tau = H^ ddq* + C^ dq + g^ + f^ + J' F_hat                             (6), (7)
    CraigAdaptiveImpedance       tau = the same + J' F_c,    F_c = -(gamma/2) H^_x e*                  (10), (22)
                                 dp_hat/dt = -Gamma W_c' H^_x^-1 e*,    e* = e' + Psi e                     (19)
    SlotineLiAdaptiveImpedance   tau = Y(q, dq, dq_r, ddq_r) p_hat + J' (F_hat - K_d s)                     (36)
                                 dp_hat/dt = -Gamma W_s' s,    s = e' + Psi e                               (33)
    SpongOrtegaAdaptiveImpedance as Craig's with H^ = H(p0) fixed, tau -= Y(q, dq, dq, a_f) (p0 - p_hat)  (III-C, 2)

The fields of Law are those of Setup, the `kind` (one of KINDS), the geometry of the `arm` and the discrete target
impedance `tirt`. A sample is everything that a controller knows at a tick: the tuple (q, dq, F_hat, virtual, x_t, dx_t)
of arrays, where `virtual` has the rows x_v, dx_v, ddx_v. All arrays hold SI units: q (rad), tau (N.m), x (m), F (N).
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from .arm import (
    Arm,
    coriolis,
    friction_torque,
    gravity_torque,
    inertia,
    jacobian,
    jacobian_rate,
    regressor,
    tip_position,
)
from .compiled import compiled

HOGAN, CRAIG, SLOTINE_LI, SPONG_ORTEGA = 0, 1, 2, 3
KINDS = {
    "HoganImpedance": HOGAN,
    "CraigAdaptiveImpedance": CRAIG,
    "SlotineLiAdaptiveImpedance": SLOTINE_LI,
    "SpongOrtegaAdaptiveImpedance": SPONG_ORTEGA,
}


class Law(NamedTuple):
    """Numbers of one controller: gains per axis, shape (2,); parameters p, shape (6,); `tirt`, shape (2, 2, 3)."""

    kind: int
    arm: Arm
    tirt: np.ndarray
    sample_time: float
    M: np.ndarray
    B: np.ndarray
    K: np.ndarray
    Psi: np.ndarray
    K_d: np.ndarray
    p_start: np.ndarray
    p_min: np.ndarray
    p_max: np.ndarray
    Gamma: np.ndarray
    projection: bool
    dead_zone: float
    freeze_when_saturated: bool
    update_divisor: int
    controller_noise_bound: float
    contact_threshold: float
    gamma_margin: float
    gamma_eps: float
    acc_filter_time: float


def reference_transition(M, B, K, h):
    """Return the exact map of the target impedance M d'' + B d' + K d = -F over one sample with F held, per axis.

    Parameters
    ----------
    M, B, K : sequence of floats
        Diagonal target impedance, one element for each axis of the task (kg, N.s/m, N/m).
    h : float
        Sample time (s).

    Returns
    -------
    ndarray, shape (axes, 2, 3)
        For each axis, (d(h), d'(h)) = row . (d, d', F).

    Notes
    -----
    The exponential is taken in the variables (d, h d', h^2 F / M), all in metres. So the entries of the matrix are of
    one magnitude, and the rounding error of the norm is also that of each entry.
    """
    transition = np.empty((len(M), 2, 3))
    for axis in range(len(M)):
        m, b, k = M[axis], B[axis], K[axis]
        scaled = expm(np.array([[0.0, 1.0, 0.0], [-k / m * h * h, -b / m * h, -1.0], [0.0, 0.0, 0.0]]))
        transition[axis] = scaled[:2] * np.array([1.0, h, h * h / m]) / np.array([[1.0], [h]])
    return transition


@compiled
def advance_reference(law, sample):
    """Return x_t and dx_t of the next tick, eq. (11): exact in d = x_t - x_v, with x_v by its Taylor polynomial."""
    _, _, F, v, x_t, dx_t = sample
    h, x_next, dx_next = law.sample_time, np.empty(2), np.empty(2)
    for i in range(2):
        T, d, rate = law.tirt[i], x_t[i] - v[0, i], dx_t[i] - v[1, i]
        x_next[i] = v[0, i] + h * v[1, i] + 0.5 * h * h * v[2, i] + T[0, 0] * d + T[0, 1] * rate + T[0, 2] * F[i]
        dx_next[i] = v[1, i] + h * v[2, i] + T[1, 0] * d + T[1, 1] * rate + T[1, 2] * F[i]
    return x_next, dx_next


@compiled
def torque(law, sample, p_hat, a_f):
    """Return the commanded joint torque, shape (2,); `a_f` is the filtered joint acceleration of Spong-Ortega's law."""
    arm, (q, dq, F_hat, virtual, _, _) = law.arm, sample
    J = jacobian(arm, q)
    if law.kind == SLOTINE_LI:
        s = augmented_error(law, sample)
        dq_r, ddq_r = joint_reference(law, sample)
        return model_torque(arm, p_hat, q, dq, dq_r, ddq_r) + J.T @ (F_hat - law.K_d * s)
    p = law.p_start if law.kind == SPONG_ORTEGA else p_hat
    x, dx = tip(arm, q), J @ dq
    ddx = impedance_acceleration(law, x, dx, virtual, F_hat)
    ddq = np.linalg.solve(J, ddx - jacobian_rate(arm, q, dq) @ dq)
    tau = model_torque(arm, p, q, dq, dq, ddq) + J.T @ F_hat
    if law.kind == SPONG_ORTEGA:
        tau -= regressor(arm, q, dq, dq, a_f) @ (law.p_start - p_hat)
    if law.kind != HOGAN:
        # J' F_c with H_x = J^-T H J^-1.
        e_star = augmented_error(law, sample)
        tau -= 0.5 * robust_gain(law, sample, p) * (inertia(arm, p, q) @ np.linalg.solve(J, e_star))
    return tau


@compiled
def adaptation_rate(law, sample, p_hat, ddq):
    """Return dp_hat/dt, shape (6,), by (19), (33) or Spong-Ortega's law; `ddq` is the measured joint acceleration."""
    error = augmented_error(law, sample)
    if law.kind == HOGAN or np.sqrt(error @ error) <= law.dead_zone:
        return np.zeros(6)
    arm, (q, dq, _, _, _, _) = law.arm, sample
    J = jacobian(arm, q)
    if law.kind == SLOTINE_LI:
        dq_r, ddq_r = joint_reference(law, sample)
        Y, direction = regressor(arm, q, dq, dq_r, ddq_r), np.linalg.solve(J, error)
    else:
        # W_c' H_x^-1 e* = Y' J^-1 (J H^-1 J') e* = Y' H^-1 J' e*.
        p = law.p_start if law.kind == SPONG_ORTEGA else p_hat
        Y, direction = regressor(arm, q, dq, dq, ddq), np.linalg.solve(inertia(arm, p, q), J.T @ error)
    return -law.Gamma * (Y.T @ direction)


@compiled
def robust_gain(law, sample, p):
    """Return gamma of (22): gamma_margin times the right side of (25), with the denominator beta^2 + gamma_eps^2."""
    q, _, F_hat, _, _, _ = sample
    delta = law.controller_noise_bound if np.sqrt(F_hat @ F_hat) > law.contact_threshold else 0.0
    J = jacobian(law.arm, q)
    e, rate = errors(law, sample)
    e_star = rate + law.Psi * e
    k, b = law.K / law.M, law.B / law.M
    alpha = np.sum(2.0 * law.Psi * k * e**2 + 2.0 * (b - law.Psi) * rate**2)
    z = J @ np.linalg.solve(inertia(law.arm, p, q), J.T @ e_star)
    bound = (2.0 * np.sqrt(z @ z) * delta - alpha) / (e_star @ e_star + law.gamma_eps**2)
    return law.gamma_margin * max(0.0, bound)


@compiled
def joint_reference(law, sample):
    """Return dq_r and ddq_r of Slotine-Li: dx_r = dx_t - Psi e, ddx_r = ddx_t - Psi e', with ddx_t by (11)."""
    q, dq, F_hat, virtual, x_t, dx_t = sample
    e, rate = errors(law, sample)
    ddx_t = impedance_acceleration(law, x_t, dx_t, virtual, F_hat)
    J = jacobian(law.arm, q)
    dq_r = np.linalg.solve(J, dx_t - law.Psi * e)
    dJ = jacobian_rate(law.arm, q, dq)
    return dq_r, np.linalg.solve(J, ddx_t - law.Psi * rate - dJ @ dq_r)


@compiled
def impedance_acceleration(law, x, dx, virtual, F):
    """Return the acceleration of the target impedance (3), m/s2: ddx_v - M^-1 [B (dx - dx_v) + K (x - x_v) + F]."""
    return virtual[2] - (law.B * (dx - virtual[1]) + law.K * (x - virtual[0]) + F) / law.M


@compiled
def augmented_error(law, sample):
    """Return the augmented error e' + Psi e (m/s), which is e* of (14) and s of (30)."""
    e, rate = errors(law, sample)
    return rate + law.Psi * e


@compiled
def errors(law, sample):
    """Return the error e = x - x_t (m) and the rate of this error (m/s)."""
    q, dq, _, _, x_t, dx_t = sample
    return tip(law.arm, q) - x_t, jacobian(law.arm, q) @ dq - dx_t


@compiled
def tip(arm, q):
    """Return the position of the tip as an array (m)."""
    x1, x2 = tip_position(arm, q)
    return np.array([x1, x2])


@compiled
def model_torque(arm, p, q, dq, v, a):
    """Return the torque H a + C v + g + f(dq) of the model with parameters p (N.m), shape (2,)."""
    g1, g2 = gravity_torque(arm, p, q)
    f1, f2 = friction_torque(arm, p, dq)
    return inertia(arm, p, q) @ a + coriolis(arm, p, q, dq) @ v + np.array([g1 + f1, g2 + f2])


def tip_space_torque(law, sample, p):
    """Return the torque J' F of form (4), written in task space, which equals (6)-(7) to rounding; for checks only."""
    arm, (q, dq, F_hat, virtual, _, _) = law.arm, sample
    J = jacobian(arm, q)
    J_inv = np.linalg.inv(J)
    H_x = J_inv.T @ inertia(arm, p, q) @ J_inv
    C_x = J_inv.T @ (coriolis(arm, p, q, dq) - inertia(arm, p, q) @ J_inv @ jacobian_rate(arm, q, dq)) @ J_inv
    g_x, f_x = J_inv.T @ gravity_torque(arm, p, q), J_inv.T @ friction_torque(arm, p, dq)
    ddx = impedance_acceleration(law, tip(arm, q), J @ dq, virtual, F_hat)
    return J.T @ (F_hat + C_x @ J @ dq + g_x + f_x + H_x @ ddx)
