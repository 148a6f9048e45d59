"""The parts of a formula as values: numbers and conditions at each instant of a run, and what reduces them.

A number or a condition has one value at each instant. A `Reduction` makes one number of a whole run out of them.
Python's reader of `orchestration.results.measures.parser` makes these values, numpy or a C program computes them.
"""

from collections.abc import Iterator
from dataclasses import dataclass

ARITHMETIC = ("+", "-", "*", "/")
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")
LOGIC = ("and", "or")


@dataclass(frozen=True)
class Number:
    """A constant, finite and not negative; a negative one is a `Unary` of it."""

    value: float


@dataclass(frozen=True)
class Column:
    """A column ``component.variable``, or the name of an array until the formula is expanded."""

    name: str


@dataclass(frozen=True)
class Time:
    """The time of the instant, s."""


@dataclass(frozen=True)
class Unary:
    """``-``, ``abs`` or ``sqrt`` of a number, or ``not`` of a condition."""

    op: str
    of: "Expression"


@dataclass(frozen=True)
class Binary:
    """Two numbers joined by one of `ARITHMETIC` or `COMPARISONS`, or two conditions joined by one of `LOGIC`."""

    op: str
    left: "Expression"
    right: "Expression"


@dataclass(frozen=True)
class Norm:
    """Euclidean norm: the square root of the sum of squares, from left to right; of one number its absolute value."""

    of: "tuple[Expression, ...]"


@dataclass(frozen=True)
class Before:
    """A condition that holds until another condition holds for the first time, this instant excluded."""

    condition: "Expression"


@dataclass(frozen=True)
class Since:
    """A condition that holds from the instant on at which another condition holds for the first time."""

    condition: "Expression"


NUMBER_KINDS = ("max", "min", "mean", "rms", "integral", "initial", "final", "time_of_max", "time_of_min")
"""Kinds of reductions of a number."""

CONDITION_KINDS = ("duration", "share", "first_time", "last_time")
"""Kinds of reductions of a condition."""

KINDS = NUMBER_KINDS + CONDITION_KINDS
"""Kinds of reductions, as `Reduction` explains them."""


@dataclass(frozen=True)
class Reduction:
    """One number of a whole run, from the values at its instants.

    Let v be the value, c a condition as the value, t the time of an instant, h the time until the next row, all at
    the instants at which `where` holds. Sums begin at 0 and go from first to last, one by one.

    ==============  =============================================  ==========================
    kind            number                                         without an instant
    ==============  =============================================  ==========================
    max, min        largest, smallest v                            NaN
    mean            sum of v / number of instants                  NaN
    rms             sqrt(sum of v*v / number of instants)          NaN
    initial, final  first, last v                                  NaN
    time_of_max     t of the first of the largest v                NaN
    time_of_min     t of the first of the smallest v               NaN
    integral        sum of v*h                                     0
    duration        sum of h where c holds                         0
    share           part of the instants at which c holds          NaN
    first_time      first t at which c holds                       NaN, also if c never holds
    last_time       last t at which c holds                        NaN, also if c never holds
    ==============  =============================================  ==========================

    Attributes
    ----------
    kind
        One of `KINDS`.
    value
        A number for `NUMBER_KINDS`, a condition for `CONDITION_KINDS`.
    where
        Condition that an instant has to fulfil; None for all instants.
    """

    kind: str
    value: "Expression"
    where: "Expression | None" = None


Expression = Number | Column | Time | Unary | Binary | Norm | Before | Since | Reduction


def is_condition(node: Expression) -> bool:
    """Whether a part of a formula holds or does not hold, other than a number."""
    match node:
        case Unary(op):
            return op == "not"
        case Binary(op):
            return op not in ARITHMETIC
        case _:
            return isinstance(node, Before | Since)


def parts(node: Expression) -> tuple[Expression, ...]:
    """The parts that a part of a formula is made of, from left to right."""
    match node:
        case Unary(_, of):
            return (of,)
        case Binary(_, left, right):
            return (left, right)
        case Norm(of):
            return of
        case Before(condition) | Since(condition):
            return (condition,)
        case Reduction(_, value, where):
            return (value,) if where is None else (value, where)
        case _:
            return ()


def walk(node: Expression) -> Iterator[Expression]:
    """All parts of a part of a formula, itself first, from left to right."""
    yield node
    for part in parts(node):
        yield from walk(part)
