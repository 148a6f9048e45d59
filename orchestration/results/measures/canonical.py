"""The text of a formula, in one way of writing: what `parse_formula` reads gives the same formula again."""

import re
from keyword import iskeyword

from orchestration.fmi.given import short
from orchestration.results.columns import TIME
from orchestration.results.measures.expression import (
    ARITHMETIC,
    COMPARISONS,
    Before,
    Binary,
    Column,
    Expression,
    Norm,
    Number,
    Reduction,
    Since,
    Time,
    Unary,
)

_INDEX = r"\[(?:0|[1-9][0-9]*)(?:,(?:0|[1-9][0-9]*))*\]"
_PLAIN = re.compile(rf"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*|{_INDEX})*")
_WORDS = re.compile(r"[A-Za-z_]\w*")

# How closely an operator binds, as in Python.
_OR, _AND, _NOT, _COMPARED, _SUM, _PRODUCT, _SIGN, _ATOM = range(8)
_BINDING = {
    "or": _OR,
    "and": _AND,
    **dict.fromkeys(COMPARISONS, _COMPARED),
    **dict.fromkeys(ARITHMETIC, _SUM),
    "*": _PRODUCT,
    "/": _PRODUCT,
}


def written(node: Expression) -> str:
    """Return the text of a part of a formula."""
    return _written(node)[0]


def written_name(name: str) -> str:
    """Return the name of a column as a formula has it: in quotes unless Python reads it as a name."""
    plain = _PLAIN.fullmatch(name) and name != TIME and not any(iskeyword(word) for word in _WORDS.findall(name))
    return name if plain else repr(name)


def _written(node: Expression) -> tuple[str, int]:
    """The text of a part, and how closely its outermost operator binds."""
    match node:
        case Number(value):
            return short(value), _ATOM
        case Column(name):
            return written_name(name), _ATOM
        case Time():
            return TIME, _ATOM
        case Unary("-", of):
            return f"-{_inside(of, _SIGN)}", _SIGN
        case Unary("not", of):
            return f"not {_inside(of, _NOT)}", _NOT
        case Unary(op, of):
            return f"{op}({written(of)})", _ATOM
        case Binary(op, left, right):
            binding = _BINDING[op]
            return f"{_inside(left, binding)} {op} {_inside(right, binding + 1)}", binding
        case _:
            return _called(node), _ATOM


def _called(node: Expression) -> str:
    match node:
        case Norm(of):
            return f"norm({', '.join(map(written, of))})"
        case Before(condition):
            return f"before({written(condition)})"
        case Since(condition):
            return f"since({written(condition)})"
        case Reduction(kind, value, where):
            chosen = "" if where is None else f", where={written(where)}"
            return f"{kind}({written(value)}{chosen})"
        case _:
            msg = f"{node!r} is no part of a formula."
            raise TypeError(msg)


def _inside(node: Expression, binding: int) -> str:
    """The text of an operand, in parentheses where the operator around it binds more closely."""
    text, own = _written(node)
    return text if own >= binding else f"({text})"
