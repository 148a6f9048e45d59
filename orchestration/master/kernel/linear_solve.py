"""Solves a system of linear equations in place by LU factors with partial pivoting."""

import numpy as np

from orchestration.master.kernel.compiled import compiled_for_callers


@compiled_for_callers
def factorize(a: np.ndarray, pivots: np.ndarray) -> bool:
    """Replace the first n columns of a, shape (n, n + 1), by their LU factors; false if they are singular."""
    n = a.shape[0]
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[p, k]):
                p = i
        pivots[k] = p
        if not abs(a[p, k]) > 0.0:
            return False
        for j in range(n):
            a[k, j], a[p, j] = a[p, j], a[k, j]
        for i in range(k + 1, n):
            a[i, k] /= a[k, k]
            for j in range(k + 1, n):
                a[i, j] -= a[i, k] * a[k, j]
    return True


@compiled_for_callers
def solve(a: np.ndarray, pivots: np.ndarray) -> None:
    """Solve a linear system with the factors of `factorize`; the right-hand side in the last column is replaced."""
    n = a.shape[0]
    for k in range(n):
        p = pivots[k]
        a[k, n], a[p, n] = a[p, n], a[k, n]
    for i in range(n):
        for j in range(i):
            a[i, n] -= a[i, j] * a[j, n]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            a[i, n] -= a[i, j] * a[j, n]
        a[i, n] /= a[i, i]
