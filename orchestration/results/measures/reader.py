"""Turns what Python has read of a formula into the parts of the formula; the rest of Python is refused."""

import ast
import sys
from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches
from functools import reduce
from typing import Any, NoReturn

from orchestration.errors import FormulaError
from orchestration.results.columns import TIME
from orchestration.results.measures.expression import (
    CONDITION_KINDS,
    KINDS,
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
    is_condition,
)

_OPERATORS: dict[type, str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.And: "and",
    ast.Or: "or",
}
_Read = Callable[[ast.expr], Expression]
_FUNCTIONS = ("abs", "sqrt", "norm", "before", "since")
_KNOWN = "formulas have + - * / **2, comparisons, and, or, not, {}, {}".format(", ".join(_FUNCTIONS), ", ".join(KINDS))


@dataclass(frozen=True)
class Reader:
    """Reads one text.

    Attributes
    ----------
    line
        The text, in one line.
    """

    line: str

    def refuse(self, node: ast.AST, what: str) -> NoReturn:
        """Raise the error for a part of the text."""
        before = self.line.encode()[: getattr(node, "col_offset", 0)].decode()
        fragment = ast.get_source_segment(self.line, node) or self.line
        place = "" if fragment == self.line else f", character {len(before) + 1}, {fragment}"
        msg = f"Measure {self.line}{place}: {what}{'' if what.endswith('?') else '.'}"
        raise FormulaError(msg)

    def outer(self, node: ast.expr) -> Expression:
        """A part outside of reductions: arithmetic over reductions."""
        found = self.expression(node, self.outer)
        if isinstance(found, Column | Time):
            self.refuse(node, "a measure is one number of a run; reduce the values, such as max(...) or final(...)")
        if isinstance(found, Before | Since):
            self.refuse(node, "before and since stand within a reduction, such as max(..., where=before(...))")
        return found

    def inner(self, node: ast.expr) -> Expression:
        """A part within a reduction: a number or a condition at each instant."""
        found = self.expression(node, self.inner)
        if isinstance(found, Reduction):
            self.refuse(node, f"{found.kind} stands within another reduction; join reductions by arithmetic instead")
        return found

    def expression(self, node: ast.expr, read: _Read) -> Expression:
        """A part whose own parts are read by `read`."""
        match node:
            case ast.Constant(value) if isinstance(value, str):
                return Time() if value == TIME else Column(value)
            case ast.Constant(value) if isinstance(value, int | float) and not isinstance(value, bool):
                return self.constant(node, value)
            case ast.Name() | ast.Attribute() | ast.Subscript():
                name = self.name(node)
                return Time() if name == TIME else Column(name)
            case ast.UnaryOp(ast.USub(), of):
                return Unary("-", self.number(of, read))
            case ast.UnaryOp(ast.UAdd(), of):
                return self.number(of, read)
            case ast.UnaryOp(ast.Not(), of):
                return Unary("not", self.condition(of, read))
            case ast.BinOp(left, ast.Pow(), right):
                return self.square(node, left, right, read)
            case ast.BinOp(left, op, right) if type(op) in _OPERATORS:
                return Binary(_OPERATORS[type(op)], self.number(left, read), self.number(right, read))
            case ast.BoolOp(op, values):
                return _chain(_OPERATORS[type(op)], [self.condition(value, read) for value in values])
            case ast.Compare(first, operators, others):
                return self.comparison(node, [first, *others], operators, read)
            case ast.Call(ast.Name(function), arguments, keywords):
                return self.call(node, function, arguments, keywords, read)
        self.refuse(node, f"this is not part of a formula; {_KNOWN}")

    def number(self, node: ast.expr, read: _Read) -> Expression:
        """A part that has to be a number."""
        found = read(node)
        if is_condition(found):
            self.refuse(node, "this is a condition, and a number is needed here")
        return found

    def condition(self, node: ast.expr, read: _Read) -> Expression:
        """A part that has to be a condition."""
        found = read(node)
        if not is_condition(found):
            self.refuse(node, "this is a number, and a condition is needed here; compare it, such as ... > 0")
        return found

    def constant(self, node: ast.expr, value: float) -> Number:
        """A finite constant."""
        if value > sys.float_info.max:
            self.refuse(node, "this number is too large for a float64")
        return Number(float(value))

    def name(self, node: ast.expr) -> str:
        """A dotted name with indices, such as ``plant.x[1]``."""
        match node:
            case ast.Name(name):
                return name
            case ast.Attribute(owner, name):
                return f"{self.name(owner)}.{name}"
            case ast.Subscript(owner, index):
                indices = index.elts if isinstance(index, ast.Tuple) and index.elts else [index]
                return f"{self.name(owner)}[{','.join(map(self.index, indices))}]"
        self.refuse(node, "this is not a name of a column; such a name is plant.x[1]")

    def index(self, node: ast.expr) -> str:
        """An index of an element."""
        if not isinstance(node, ast.Constant) or type(node.value) is not int:
            self.refuse(node, "this is not an index; an index is an integer, as in plant.x[1]")
        return str(node.value)

    def square(self, node: ast.expr, base: ast.expr, exponent: ast.expr, read: _Read) -> Binary:
        """A square as a product."""
        if not isinstance(exponent, ast.Constant) or type(exponent.value) is bool or exponent.value != 2:
            self.refuse(node, "the only power is 2; write products, such as x * x * x, or sqrt(x)")
        found = self.number(base, read)
        return Binary("*", found, found)

    def comparison(self, node: ast.expr, operands: list[ast.expr], operators: list[ast.cmpop], read: _Read) -> Binary:
        """One or more comparisons in a row."""
        unknown = [op for op in operators if type(op) not in _OPERATORS]
        if unknown:
            self.refuse(node, "comparisons are < <= > >= == !=")
        found = [self.number(operand, read) for operand in operands]
        pairs = zip(operators, found, found[1:], strict=False)
        return _chain("and", [Binary(_OPERATORS[type(op)], left, right) for op, left, right in pairs])

    def call(
        self, node: ast.Call, function: str, arguments: list[ast.expr], keywords: list[ast.keyword], read: _Read
    ) -> Expression:
        """A function or a reduction."""
        if function in KINDS:
            return self.reduction(node, function, arguments, keywords)
        if function not in _FUNCTIONS:
            near = get_close_matches(function, (*_FUNCTIONS, *KINDS), 1)
            help_ = f"did you mean {near[0]}?" if near else _KNOWN
            self.refuse(node, f"there is no function {function}; {help_}")
        if keywords or not arguments or (len(arguments) > 1 and function != "norm"):
            takes = "one number or more" if function == "norm" else "one argument"
            self.refuse(node, f"{function} takes {takes} and no keyword")
        if function == "norm":
            return Norm(tuple(self.number(argument, read) for argument in arguments))
        if function in ("before", "since"):
            made = Before if function == "before" else Since
            return made(self.condition(arguments[0], self.inner))
        return Unary(function, self.number(arguments[0], read))

    def reduction(self, node: ast.Call, kind: str, arguments: list[ast.expr], keywords: list[ast.keyword]) -> Reduction:
        """A reduction of what stands in its parentheses."""
        if len(arguments) != 1 or [keyword.arg for keyword in keywords] not in ([], ["where"]):
            what = "condition" if kind in CONDITION_KINDS else "number"
            self.refuse(
                node,
                f"{kind} takes one {what} and, if wanted, where=condition; norm(a, b) joins two numbers",
            )
        read = self.condition if kind in CONDITION_KINDS else self.number
        where = self.condition(keywords[0].value, self.inner) if keywords else None
        return Reduction(kind, read(arguments[0], self.inner), where)


def _chain(op: str, conditions: list[Expression]) -> Any:
    """Conditions joined from left to right."""
    return reduce(lambda left, right: Binary(op, left, right), conditions)
