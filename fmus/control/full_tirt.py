"""The target-impedance reference trajectory, eq. (11), for an impedance of full matrices.

With d = x_t - x_v, M d'' + B d' + K d = -F_hat couples the axes. Over a sample of length h with F_hat held,
y = d + K^-1 F_hat moves by the exponential of the companion matrix, in units of h:

    (y, h y')(h) = exp(A) (y, h y')(0),   A = [ 0, I ; -h^2 M^-1 K, -h M^-1 B ]

exp(A) depends on parameters only, so it is computed when they change, by scaling and squaring. Parameters are symbols,
so the number of squarings is fixed, and a small A is scaled more than it needs. That loses no digits, because what is
squared is E = exp(A) - I: (I + E)^2 - I = 2 E + E^2 keeps the small elements of E.
"""

from dataclasses import dataclass

import casadi as ca

from fmus.mechanics.algebra import solve_spd

SQUARINGS = 20
# Terms of the series for A / 2^SQUARINGS. At a norm of 1/8 the first term that is left out is 8^-10 / 11! = 2e-17 of
# the first one.
TERMS = 10
LARGEST_NORM = 2.0**SQUARINGS / 8
"""Largest norm of A, in rows, for which the exponential is exact to rounding."""


@dataclass(frozen=True)
class FullImpedance:
    """Matrices of the target impedance, eq. (3): M kg, B N.s/m, K N/m, symmetric, each of shape (m, m)."""

    M: ca.SX
    B: ca.SX
    K: ca.SX

    @property
    def b(self) -> ca.SX:
        """M^-1 B, 1/s, shape (m, m)."""
        return solve_spd(self.M, self.B)

    @property
    def k(self) -> ca.SX:
        """M^-1 K, 1/s2, shape (m, m)."""
        return solve_spd(self.M, self.K)

    def acceleration(self, dd: ca.SX, d: ca.SX, F: ca.SX) -> ca.SX:
        """M^-1 (B dd + K d + F), m/s2, shape (m,), for a deviation d, its rate dd and a force F."""
        return ca.mtimes(self.b, dd) + ca.mtimes(self.k, d) + ca.mtimes(solve_spd(self.M, ca.SX.eye(F.numel())), F)

    def advance(
        self, x_t: ca.SX, dx_t: ca.SX, virtual: tuple[ca.SX, ca.SX, ca.SX], F_hat: ca.SX, h: ca.SX
    ) -> tuple[ca.SX, ca.SX]:
        """State of the TIRT one sample later, as `fmus.control.tirt.advance` describes it."""
        x_v, dx_v, ddx_v = virtual
        m = x_t.numel()
        rest = -ca.mtimes(solve_spd(self.K, ca.SX.eye(m)), F_hat)
        begin = ca.vertcat(x_t - x_v - rest, h * (dx_t - dx_v))
        moved = ca.mtimes(exponential_minus_identity(companion(self.b, self.k, h)), begin)
        x_next = x_v + h * dx_v + 0.5 * h**2 * ddx_v + rest + (begin[:m] + moved[:m])
        dx_next = dx_v + h * ddx_v + (begin[m:] + moved[m:]) / h
        return x_next, dx_next


def companion(M_inverse_B: ca.SX, M_inverse_K: ca.SX, h: ca.SX) -> ca.SX:
    """Matrix A above, without a unit, shape (2 m, 2 m).

    Parameters
    ----------
    M_inverse_B, M_inverse_K
        1/s and 1/s2, shape (m, m).
    h
        Length of a sample, s.
    """
    m = M_inverse_B.shape[0]
    upper = ca.horzcat(ca.SX.zeros(m, m), ca.SX.eye(m))
    return ca.densify(ca.vertcat(upper, ca.horzcat(-(h**2) * M_inverse_K, -h * M_inverse_B)))


def row_norm(A: ca.SX) -> ca.SX:
    """Largest sum of absolute values of a row of A."""
    largest = ca.SX(0)
    for i in range(A.shape[0]):
        largest = ca.fmax(largest, ca.sum2(ca.fabs(A[i, :])))
    return largest


def exponential_minus_identity(A: ca.SX) -> ca.SX:
    """Matrix exp(A) - I, for a norm of A up to `LARGEST_NORM`."""
    small = A / 2**SQUARINGS
    E = small / TERMS
    for k in range(TERMS - 1, 0, -1):  # Horner's scheme: small (I + small/2 (I + small/3 (...)))
        E = (small + ca.mtimes(small, E)) / k
    for _ in range(SQUARINGS):
        E = 2 * E + ca.mtimes(E, E)
    return E
