"""Linear algebra of `fmus.mechanics.algebra` against NumPy, at random matrices of every size up to seven rows."""

import casadi as ca
import numpy as np
import pytest

from fmus.mechanics.algebra import gram_determinant, solve_mobility, solve_spd, solve_square, spectral_norm
from tests.property.samples import EPS, evaluate

SIZE = 300
SIZES = range(1, 8)


def matrices(n: int, *, definite: bool = False) -> np.ndarray:
    """Random matrices, shape (SIZE, n, n); every third has a zero at the first place, where elimination would fail."""
    A = np.random.default_rng(n).normal(size=(SIZE, n, n))
    if definite:
        return A @ A.transpose(0, 2, 1) + 0.1 * np.eye(n)
    if n > 1:
        A[::3, 0, 0] = 0
    return A


def columns(values: np.ndarray) -> np.ndarray:
    """Matrices as columns for a CasADi function, shape (rows columns, SIZE)."""
    return values.transpose(2, 1, 0).reshape(-1, SIZE)


def solved(solver, A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solutions of all systems, shape (SIZE, n, k)."""
    n, k = b.shape[1:]
    left, right = ca.SX.sym("A", n * n), ca.SX.sym("b", n * k)
    x = solver(ca.reshape(left, n, n), ca.reshape(right, n, k))
    values = evaluate(ca.Function("x", [left, right], [ca.vec(x)]), columns(A), columns(b))
    return values.reshape(SIZE, k, n).transpose(0, 2, 1)


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("k", [1, 3])
def test_square_systems_are_solved(n: int, k: int) -> None:
    A, b = matrices(n), np.random.default_rng(k).normal(size=(SIZE, n, k))
    x = solved(solve_square, A, b)
    norm = np.linalg.norm
    # Backward stable methods miss by n EPS of |A| |x|. Cramer's rule, for three rows, by the condition number more.
    cramer = np.linalg.cond(A) if n in (2, 3) else 1.0
    tolerance = 10 * n * EPS * cramer * norm(A, axis=(1, 2)) * norm(x, axis=(1, 2))
    assert (norm(A @ x - b, axis=(1, 2)) <= tolerance).all()


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("solver", [solve_spd, solve_mobility])
def test_definite_systems_are_solved(solver, n: int) -> None:
    A, b = matrices(n, definite=True), np.random.default_rng(9).normal(size=(SIZE, n, 2))
    x = solved(solver, A, b)
    tolerance = 10 * n * EPS * np.linalg.cond(A) * np.linalg.norm(np.linalg.solve(A, b), axis=(1, 2))
    assert (np.linalg.norm(x - np.linalg.solve(A, b), axis=(1, 2)) <= tolerance).all()


@pytest.mark.parametrize("n", SIZES)
def test_a_square_system_has_no_branches(n: int) -> None:
    """The operations are the same whatever the numbers: no comparison, and no choice of a pivot."""
    A, b = ca.SX.sym("A", n, n), ca.SX.sym("b", n)
    function = ca.Function("x", [A, b], [solve_square(A, b)])
    found = {function.instruction_id(i) for i in range(function.n_instructions())}
    assert not found & {ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_IF_ELSE_ZERO, ca.OP_FMIN, ca.OP_FMAX}


@pytest.mark.parametrize("n", SIZES)
def test_the_gram_determinant_is_that_of_the_product_and_zero_without_full_rank(n: int) -> None:
    A = np.random.default_rng(n).normal(size=(SIZE, n, n + 1))
    symbol = ca.SX.sym("A", n * (n + 1))
    function = ca.Function("d", [symbol], [gram_determinant(ca.reshape(symbol, n, n + 1))])
    expected = np.linalg.det(A @ A.transpose(0, 2, 1))
    scale = np.prod(np.linalg.norm(A, axis=2) ** 2, axis=1)  # Hadamard's bound
    assert (np.abs(evaluate(function, columns(A)).ravel() - expected) <= 100 * n * EPS * scale).all()
    A[:, -1] = A[:, 0] if n > 1 else 0
    rounded = evaluate(function, columns(A)).ravel()
    assert (np.abs(rounded) <= 100 * n * EPS * scale.max()).all()


@pytest.mark.parametrize("n", [n for n in SIZES if n > 1])
@pytest.mark.parametrize("definite", [True, False])
def test_the_spectral_norm_is_a_close_upper_bound(n: int, definite: bool) -> None:
    A = matrices(n, definite=definite)
    A = (A + A.transpose(0, 2, 1)) / 2
    A[1] *= 1e-9
    A[2] *= 1e9
    symbol = ca.SX.sym("A", n * n)
    function = ca.Function("norm", [symbol], [spectral_norm(ca.reshape(symbol, n, n))])
    found, exact = evaluate(function, columns(A)).ravel(), np.linalg.norm(A, 2, axis=(1, 2))
    assert (found >= exact * (1 - 1e-12)).all()
    assert (found <= exact * (n ** (1 / 2**12) + 1e-12)).all()
