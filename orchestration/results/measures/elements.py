"""Arrays in a formula: their elements take their place, one by one."""

from collections.abc import Callable, Iterator, Sequence

from orchestration.errors import FormulaError
from orchestration.results.measures.canonical import written, written_name
from orchestration.results.measures.expression import (
    Before,
    Binary,
    Column,
    Expression,
    Norm,
    Reduction,
    Since,
    Unary,
    walk,
)

Elements = Callable[[str], Sequence[str]]
"""Gives the names of the scalar columns that a name stands for, its own if it is that of a scalar."""


def scalar(node: Expression, elements: Elements) -> Expression:
    """Replace the arrays in a part of a formula by their elements.

    Raises
    ------
    FormulaError
        If an array stands where a number is needed, or arrays of unequal sizes are joined.
    """
    found = _expanded(node, elements)
    if len(found) == 1:
        return found[0]
    first = written(found[0])
    msg = (
        f"{written(node)} has {len(found)} elements, and a measure is one number; choose one, such as {first},"
        " or take the norm: norm(...)."
    )
    raise FormulaError(msg)


def _expanded(node: Expression, elements: Elements) -> list[Expression]:
    """The elements of a part of a formula; one for a number."""
    match node:
        case Column(name):
            return [Column(element) for element in elements(name)]
        case Unary(op, of):
            return [Unary(op, part) for part in _expanded(of, elements)]
        case Binary(op, left, right):
            return [Binary(op, a, b) for a, b in _pairs(node, left, right, elements)]
        case Norm(of):
            return [Norm(tuple(element for part in of for element in _expanded(part, elements)))]
        case Before(condition):
            return [Before(_one_condition(condition, elements))]
        case Since(condition):
            return [Since(_one_condition(condition, elements))]
        case Reduction(kind, value, where):
            chosen = None if where is None else _one_condition(where, elements)
            return [Reduction(kind, part, chosen) for part in _expanded(value, elements)]
        case _:
            return [node]


def _pairs(
    node: Expression, left: Expression, right: Expression, elements: Elements
) -> Iterator[tuple[Expression, Expression]]:
    """Elements of two operands side by side; one that is no array stands beside each element of the other."""
    a, b = _expanded(left, elements), _expanded(right, elements)
    if len(a) != len(b) and 1 not in (len(a), len(b)):
        msg = f"{written(node)}: {written(left)} has {len(a)} elements, {written(right)} has {len(b)}; join equal ones."
        raise FormulaError(msg)
    size = max(len(a), len(b))
    return zip(a * (size // len(a)), b * (size // len(b)), strict=True)


def _one_condition(node: Expression, elements: Elements) -> Expression:
    found = _expanded(node, elements)
    if len(found) != 1:
        array = next(part.name for part in _arrays(node, elements))
        msg = (
            f"{written(node)} is {len(found)} conditions, since {array} is an array; write one condition, such as"
            f" {written(found[0])} or norm({written_name(array)}) > 0."
        )
        raise FormulaError(msg)
    return found[0]


def _arrays(node: Expression, elements: Elements) -> Iterator[Column]:
    return (part for part in walk(node) if isinstance(part, Column) and len(elements(part.name)) != 1)
