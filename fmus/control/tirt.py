"""The target-impedance reference trajectory (TIRT), eq. (11), integrated exactly.

With d = x_t - x_v, eq. (11) is M d'' + B d' + K d = -F_hat for each axis: linear, time invariant,
driven by the force alone. Over a sample of length h with F_hat held, the exact solution is taken
from the exponential of the 2 x 2 companion matrix.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Formula, Formulas

# Below this |(B/2M)^2 - K/M| h^2 the kernels come from their series, whose first neglected term,
# z^7/14!, is then below 1e-24.
SERIES_LIMIT = 1e-2


FORMULAS = Formulas(
    "Reference trajectory of the target impedance (TIRT)",
    [
        Formula(
            r"M (\ddot{x}_t - \ddot{x}_v) + B (\dot{x}_t - \dot{x}_v) + K (x_t - x_v) = -\hat{F}",
            "What the tip would do if it were the target; solved exactly over each sample.",
            "11",
        ),
        Formula(r"e = x - x_t", "The regression error: how far the arm is from its target."),
    ],
)


@dataclass(frozen=True)
class Kernels:
    """Impulse response S (s) and its companion C of y'' + 2 a y' + w2 y = 0 at time h.

    y(h) = (C + a S) y(0) + S y'(0), y'(h) = -w2 S y(0) + (C - a S) y'(0).
    """

    a: ca.SX
    w2: ca.SX
    C: ca.SX
    S: ca.SX


def kernels(M: ca.SX, B: ca.SX, K: ca.SX, h: ca.SX) -> Kernels:
    """Kernels of the target impedance, for one axis.

    Parameters
    ----------
    M, B, K
        Target inertia kg, damping N.s/m, stiffness N/m; all positive.
    h
        Time, s.

    Notes
    -----
    With r = sqrt(a^2 - w2), C = exp(-a h) cosh(r h) and S = exp(-a h) sinh(r h) / r. Overdamped
    kernels use decaying exponentials only (exp times cosh is 0 times infinity), and near critical
    damping, where r -> 0, the series in z = (r h)^2.
    """
    a, w2 = B / (2 * M), K / M
    discriminant = a**2 - w2
    z = discriminant * h**2
    r = ca.sqrt(ca.fabs(discriminant))
    decay = ca.exp(-a * h)
    slow = ca.exp(-w2 / (a + r) * h)  # a - r, without cancellation
    fast = ca.exp(-(a + r) * h)
    cosh_series, sinh_series = _series(z)
    critical = ca.fabs(z) < SERIES_LIMIT
    C = ca.if_else(
        critical,
        decay * cosh_series,
        ca.if_else(z > 0, 0.5 * (slow + fast), decay * ca.cos(r * h)),
    )
    S = ca.if_else(
        critical,
        decay * h * sinh_series,
        ca.if_else(z > 0, 0.5 * (slow - fast) / r, decay * ca.sin(r * h) / r),
    )
    return Kernels(a, w2, C, S)


def advance(
    x_t: ca.SX,
    dx_t: ca.SX,
    virtual: tuple[ca.SX, ca.SX, ca.SX],
    F_hat: ca.SX,
    impedance: "Impedance",
    h: ca.SX,
) -> tuple[ca.SX, ca.SX]:
    """State of the TIRT one sample later, eq. (11).

    Parameters
    ----------
    x_t, dx_t
        TIRT at this sample, m and m/s, shape (m,).
    virtual
        x_v, dx_v, ddx_v at this sample, m, m/s, m/s2, shape (m,).
    F_hat
        Measured force, N, shape (m,), held over the sample.
    h
        Length of the sample, s.

    Returns
    -------
    tuple
        x_t and dx_t at the next sample.

    Notes
    -----
    The state is (x_t, dx_t), not the difference from x_v: a corner of the virtual trajectory is
    then treated as (11) demands.
    """
    x_v, dx_v, ddx_v = virtual
    x_next, dx_next = [], []
    for i in range(x_t.numel()):
        M, B, K = impedance.M[i], impedance.B[i], impedance.K[i]
        k = kernels(M, B, K, h)
        rest = -F_hat[i] / K
        y, dy = x_t[i] - x_v[i] - rest, dx_t[i] - dx_v[i]
        d = rest + (k.C + k.a * k.S) * y + k.S * dy
        dd = -k.w2 * k.S * y + (k.C - k.a * k.S) * dy
        x_next.append(x_v[i] + h * dx_v[i] + 0.5 * h**2 * ddx_v[i] + d)
        dx_next.append(dx_v[i] + h * ddx_v[i] + dd)
    return ca.vertcat(*x_next), ca.vertcat(*dx_next)


@dataclass(frozen=True)
class Impedance:
    """Diagonals of the target impedance, eq. (3): M kg, B N.s/m, K N/m, each of shape (m,)."""

    M: ca.SX
    B: ca.SX
    K: ca.SX

    def acceleration(self, dd: ca.SX, d: ca.SX, F: ca.SX) -> ca.SX:
        """M^-1 (B dd + K d + F), m/s2, shape (m,), for a deviation d, its rate dd and a force F."""
        return (self.B * dd + self.K * d + F) / self.M

    def advance(
        self, x_t: ca.SX, dx_t: ca.SX, virtual: tuple[ca.SX, ca.SX, ca.SX], F_hat: ca.SX, h: ca.SX
    ) -> tuple[ca.SX, ca.SX]:
        """State of the TIRT one sample later; see the function `advance`."""
        return advance(x_t, dx_t, virtual, F_hat, self, h)


def _series(z: ca.SX) -> tuple[ca.SX, ca.SX]:
    """cosh(sqrt(z)) and sinh(sqrt(z))/sqrt(z) by their series, also for negative z."""
    cosh, sinh, term = ca.SX(1), ca.SX(1), ca.SX(1)
    for k in range(1, 7):
        term = term * z / ((2 * k - 1) * (2 * k))
        cosh += term
        sinh += term / (2 * k + 1)
    return cosh, sinh
