"""The arithmetic of formulas with numpy: IEEE double, one operation after the other, as a C program does it."""

from collections.abc import Callable
from typing import Any

import numpy as np

from orchestration.results.measures.expression import Before, Binary, Expression, Norm, Number, Since, Unary

_UNARY = {"-": np.negative, "abs": np.abs, "sqrt": np.sqrt, "not": np.logical_not}
_BINARY = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
    "and": np.logical_and,
    "or": np.logical_or,
}


def computed(node: Expression, leaf: Callable[[Expression], Any]) -> Any:
    """Compute a part of a formula.

    Parameters
    ----------
    leaf
        Gives the values of a column, of the time, or of a reduction: float64, shape (n,) or ().

    Returns
    -------
    ndarray
        float64, or bool for a condition; shape (n,), or () for constants. A division by zero is infinite or NaN, the
        root of a negative number NaN.
    """
    with np.errstate(all="ignore"):
        return _computed(node, leaf)


def _computed(node: Expression, leaf: Callable[[Expression], Any]) -> Any:
    match node:
        case Number(value):
            return np.float64(value)
        case Unary(op, of):
            return _UNARY[op](_computed(of, leaf))
        case Binary(op, left, right):
            return _BINARY[op](_computed(left, leaf), _computed(right, leaf))
        case Norm(of):
            return _norm([_computed(part, leaf) for part in of])
        case Before(condition):
            return np.logical_not(_ever(_computed(condition, leaf)))
        case Since(condition):
            return _ever(_computed(condition, leaf))
        case _:
            return leaf(node)


def _norm(parts: list[Any]) -> Any:
    if len(parts) == 1:
        return np.abs(parts[0])
    total = parts[0] * parts[0]
    for part in parts[1:]:
        total = total + part * part
    return np.sqrt(total)


def _ever(condition: Any) -> Any:
    """Whether a condition has held at an instant or before; a constant one is the same at all instants."""
    return np.logical_or.accumulate(condition) if np.ndim(condition) else condition
