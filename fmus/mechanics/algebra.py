"""Linear algebra of small matrices, written out so that generated code has few operations."""

import casadi as ca


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


def solve_2x2(A: ca.SX, b: ca.SX) -> ca.SX:
    """Solve A x = b, A of shape (2, 2), b of shape (2, k), by Cramer's rule."""
    return ca.mtimes(adjugate_2x2(A), b) / determinant_2x2(A)


def determinant_2x2(A: ca.SX) -> ca.SX:
    """Determinant of a 2 x 2 matrix."""
    return A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]


def adjugate_2x2(A: ca.SX) -> ca.SX:
    """Adjugate of a 2 x 2 matrix: A adj(A) = det(A) I."""
    return ca.vertcat(ca.horzcat(A[1, 1], -A[0, 1]), ca.horzcat(-A[1, 0], A[0, 0]))
