"""Gains of the controllers: diagonal matrices, or symmetric ones that must be positive definite.

A diagonal gain is a column of parameters, ``M[1]``, ``M[2]``. A full one is a symmetric matrix,
``M[1,1]``, ``M[1,2]``, ``M[2,1]``, ``M[2,2]``. Whether a matrix is positive definite is tested by the pivots of its
factorisation A = L D L', each relative to its element of the diagonal.
"""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu import Limits, SampledModel
from adaptimp_fmu.model import PerElement
from fmus.mechanics.algebra import factors_spd

# A pivot is zero if it is below this part of its element of the diagonal. Rounding leaves some 1e-16 of it.
ROUNDING = 1e-12


def declare_gain(
    model: SampledModel,
    name: str,
    diagonal: Sequence[float],
    *,
    full: bool,
    unit: PerElement,
    limits: Limits,
    description: PerElement,
) -> ca.SX:
    """Declare a gain that is tunable: a column, shape (n,), or if `full` a symmetric matrix, shape (n, n).

    Parameters
    ----------
    diagonal
        Start values of the diagonal, shape (n,).
    limits
        Range of the elements of the diagonal.
    """
    declare = model.symmetric_parameter if full else model.parameter
    return declare(name, diagonal, unit=unit, limits=limits, tunable=True, description=description)


def require_definite(model: SampledModel, A: ca.SX, sentence: str) -> None:
    """Demand that a symmetric matrix is positive definite; `sentence` is the error message."""
    _, pivots = factors_spd(A)
    for j, pivot in enumerate(pivots):
        model.require(pivot - ROUNDING * A[j, j], sentence)


def require_semidefinite(model: SampledModel, A: ca.SX, sentence: str) -> None:
    """Demand that a symmetric matrix is positive semidefinite; `sentence` is the error message.

    The matrix is scaled to a diagonal of ones, since units of its elements differ. A zero on the diagonal, as of the
    adaptation gain of a known parameter, needs a row of zeros.
    """
    n = A.shape[0]
    scales = [ca.if_else(A[i, i] > 0, A[i, i], 1) for i in range(n)]
    for i in range(n):
        others = sum((ca.fabs(A[i, j]) for j in range(n) if j != i), ca.SX(0))
        allowed = ca.logic_or(A[i, i] > 0, ca.logic_and(A[i, i] == 0, others == 0))
        model.require(allowed - 0.5, sentence)
    scaled = ca.SX(n, n)
    for i in range(n):
        for j in range(n):
            scaled[i, j] = A[i, j] / ca.sqrt(scales[i] * scales[j])
    _, pivots = factors_spd(scaled + ROUNDING * ca.SX.eye(n))
    for pivot in pivots:
        model.require(pivot, sentence)
