"""Linear algebra of small matrices, written out so that generated code has few operations."""

from functools import reduce
from operator import mul

import casadi as ca

SQUARINGS = 12  # of a matrix, for its largest eigenvalue


def solve_spd(A: ca.SX, b: ca.SX) -> ca.SX:
    """Solve A x = b for a symmetric positive definite A by its LDL' factors.

    Parameters
    ----------
    A
        Shape (n, n); only the lower triangle is read.
    b
        Shape (n, k).

    Returns
    -------
    SX
        x, shape (n, k). No square roots and no pivoting: positive definite matrices need neither.
    """
    L, D = factors_spd(A)
    n = len(D)
    y: list[ca.SX] = []
    for i in range(n):
        y.append(b[i, :] - sum((L[i][k] * y[k] for k in range(i)), ca.SX.zeros(1, b.shape[1])))
    x: list[ca.SX] = [y[i] / D[i] for i in range(n)]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            x[i] = x[i] - L[k][i] * x[k]
    return ca.vertcat(*x)


def factors_spd(A: ca.SX) -> tuple[list[list[ca.SX]], list[ca.SX]]:
    """Factors of A = L diag(D) L': the rows of L, below the diagonal of ones, and the pivots D.

    Parameters
    ----------
    A
        Symmetric, shape (n, n); only the lower triangle is read. All pivots are positive if, and only if, A is
        positive definite.
    """
    n = A.shape[0]
    L = [[ca.SX(0)] * n for _ in range(n)]
    D: list[ca.SX] = []
    for j in range(n):
        D.append(A[j, j] - sum((L[j][k] ** 2 * D[k] for k in range(j)), ca.SX(0)))
        for i in range(j + 1, n):
            L[i][j] = (A[i, j] - sum((L[i][k] * L[j][k] * D[k] for k in range(j)), ca.SX(0))) / D[j]
    return L, D


def times(A: ca.SX, v: ca.SX) -> ca.SX:
    """Product A v, shape (n,), of a matrix, or of a diagonal matrix that is given as the column of its diagonal."""
    return A * v if is_diagonal(A) else ca.mtimes(A, v)


def is_diagonal(A: ca.SX) -> bool:
    """Whether A is the column of a diagonal, shape (n,), in the place of a matrix, shape (n, n)."""
    return len(A.shape) == 1 or A.shape[1] == 1


def solve_square(A: ca.SX, b: ca.SX) -> ca.SX:
    """Solve A x = b for an invertible A of any size, A of shape (n, n), b of shape (n, k).

    Returns
    -------
    SX
        x, shape (n, k): up to three rows by Cramer's rule, and from four rows on by Householder reflections. Both need
        no pivots, so that the number of operations does not depend on values.
    """
    n = A.shape[0]
    if n == 1:
        return b / A
    if n == 2:
        return solve_2x2(A, b)
    return _solve_3x3(A, b) if n == 3 else _solve_by_reflections(A, b)


def solve_mobility(W: ca.SX, b: ca.SX) -> ca.SX:
    """Solve W x = b for a mobility tensor, symmetric and positive definite, of shape (m, m); b of shape (m, k)."""
    return solve_2x2(W, b) if W.shape[0] == 2 else solve_spd(W, b)


def gram_determinant(A: ca.SX) -> ca.SX:
    """Determinant of A A', shape (1,), of a matrix with no more rows than columns; 0 where its rank is not full."""
    gram = ca.mtimes(A, A.T)
    if A.shape[0] <= 2:
        return ca.det(gram)
    _, pivots = factors_spd(gram)
    return reduce(mul, pivots)


def spectral_norm(A: ca.SX) -> ca.SX:
    """Spectral norm of a symmetric matrix A of shape (n, n): the largest absolute eigenvalue.

    For more than two rows the result is trace(A^N)^(1/N) with N = 2^12. It is never below the norm, and above it by a
    factor of at most n^(1/N), that is 1.0005 for n = 6.
    """
    if A.shape[0] == 2:
        mean, difference = 0.5 * (A[0, 0] + A[1, 1]), 0.5 * (A[0, 0] - A[1, 1])
        return ca.fabs(mean) + ca.sqrt(difference**2 + A[0, 1] ** 2)
    power, logarithm = A, ca.SX(0)
    for k in range(1, SQUARINGS + 1):
        power = ca.mtimes(power, power)
        trace = ca.trace(power)
        logarithm, power = logarithm + ca.log(trace) / 2**k, power / trace
    return ca.exp(logarithm)


def solve_2x2(A: ca.SX, b: ca.SX) -> ca.SX:
    """Solve A x = b, A of shape (2, 2), b of shape (2, k), by Cramer's rule."""
    return ca.mtimes(adjugate_2x2(A), b) / determinant_2x2(A)


def determinant_2x2(A: ca.SX) -> ca.SX:
    """Determinant of a 2 x 2 matrix."""
    return A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]


def adjugate_2x2(A: ca.SX) -> ca.SX:
    """Adjugate of a 2 x 2 matrix: A adj(A) = det(A) I."""
    return ca.vertcat(ca.horzcat(A[1, 1], -A[0, 1]), ca.horzcat(-A[1, 0], A[0, 0]))


def _solve_3x3(A: ca.SX, b: ca.SX) -> ca.SX:
    """Cramer's rule for three rows: the rows of the adjugate are cross products of the columns of A."""
    columns = [A[:, j] for j in range(3)]
    adjugate = [ca.cross(columns[(j + 1) % 3], columns[(j + 2) % 3]).T for j in range(3)]
    return ca.mtimes(ca.vertcat(*adjugate), b) / ca.mtimes(adjugate[0], columns[0])


def _solve_by_reflections(A: ca.SX, b: ca.SX) -> ca.SX:
    """Householder's reflections turn A into a triangle; backward substitution solves that."""
    n = A.shape[0]
    work = ca.densify(ca.horzcat(A, b))
    diagonal: list[ca.SX] = []
    for k in range(n - 1):
        v = work[k:, k]
        length = ca.copysign(ca.norm_2(v), v[0])
        v = ca.vertcat(v[0] + length, v[1:])
        for j in range(k + 1, work.shape[1]):
            work[k:, j] = work[k:, j] - ca.dot(v, work[k:, j]) / (length * v[0]) * v
        diagonal.append(-length)
    diagonal.append(work[n - 1, n - 1])
    x: list[ca.SX] = [ca.SX(0)] * n
    for i in reversed(range(n)):
        known = sum((work[i, j] * x[j] for j in range(i + 1, n)), ca.SX.zeros(1, b.shape[1]))
        x[i] = (work[i, n:] - known) / diagonal[i]
    return ca.vertcat(*x)
