"""Units of measures, where the rule is plain: a sum keeps its unit, a ratio of equals has none, time is in s."""

from collections import Counter
from collections.abc import Callable, Sequence

from orchestration.results.measures.expression import Binary, Column, Expression, Norm, Number, Reduction, Time, Unary

_Powers = Counter[str] | None
"""Powers of units by their names, empty for a ratio; None where no rule says what the unit is."""

_SECOND = "s"


def unit_of(node: Expression, unit_of_column: Callable[[str], str]) -> str:
    """Return the unit of a formula; empty for a pure number, and where the unit is not plain."""
    found = _powers(node, unit_of_column)
    if not found or isinstance(node, Number):
        return ""
    (first, power), *more = sorted(found.items())
    if not more:
        return first if power == 1 else ""
    if len(more) == 1 and (power, more[0][1]) == (1, 1) and _SECOND in (first, more[0][0]):
        return _times_second(more[0][0] if first == _SECOND else first)
    return ""


def _times_second(unit: str) -> str:
    """The unit of an integral over time: m/s becomes m, N becomes N.s."""
    if unit.endswith("/s") and "/" not in unit[:-2]:
        return unit[:-2]
    return "" if "/" in unit else f"{unit}.{_SECOND}"


def _powers(node: Expression, unit_of_column: Callable[[str], str]) -> _Powers:
    match node:
        case Column(name):
            unit = unit_of_column(name)
            return Counter({unit: 1}) if unit else None
        case Time():
            return Counter({_SECOND: 1})
        case Number():
            return Counter()
        case Unary("sqrt", of):
            return _root(_powers(of, unit_of_column))
        case Unary(_, of):
            return _powers(of, unit_of_column)
        case Binary(op, left, right):
            return _joined(op, [left, right], unit_of_column)
        case Norm(of):
            return _joined("+", of, unit_of_column)
        case Reduction(kind, value):
            return _of_reduction(kind, value, unit_of_column)
        case _:
            return None


def _of_reduction(kind: str, value: Expression, unit_of_column: Callable[[str], str]) -> _Powers:
    if kind == "share":
        return Counter()
    if kind in ("duration", "first_time", "last_time", "time_of_max", "time_of_min"):
        return Counter({_SECOND: 1})
    found = _powers(value, unit_of_column)
    return _product(found, Counter({_SECOND: 1}), 1) if kind == "integral" else found


def _joined(op: str, operands: Sequence[Expression], unit_of_column: Callable[[str], str]) -> _Powers:
    found = [_powers(part, unit_of_column) for part in operands]
    if op in ("*", "/"):
        return _product(found[0], found[1], 1 if op == "*" else -1)
    # A constant that is added or subtracted is in the unit of the other operand.
    in_units = [powers for part, powers in zip(operands, found, strict=True) if not _constant(part)] or found
    return in_units[0] if all(powers == in_units[0] for powers in in_units) else None


def _constant(node: Expression) -> bool:
    return isinstance(node, Number) or (isinstance(node, Unary) and _constant(node.of))


def _product(a: _Powers, b: _Powers, sign: int) -> _Powers:
    if a is None or b is None:
        return None
    powers = Counter(a)
    for unit, power in b.items():
        powers[unit] += sign * power
    return Counter({unit: power for unit, power in powers.items() if power})


def _root(powers: _Powers) -> _Powers:
    if powers is None or any(power % 2 for power in powers.values()):
        return None
    return Counter({unit: power // 2 for unit, power in powers.items()})
