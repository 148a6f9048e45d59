"""The measures of the live page as data: formulas that its script computes, with every part written once.

The formulas are those of `orchestration.results.measures`. On the page they may do three things more: name a run, as in
``fig7.e_contact``, name a start value, and compare with a reduction, as in ``time < first_time(...)``. ``count`` counts
how often a condition has begun to hold; a condition is 1 or 0. What can be said by other operations is said so, which
leaves the script few of them.
"""

import ast
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from orchestration.paper.measure import RECOVERED, SETTLED
from orchestration.paper.numbers import TIP_START
from orchestration.results.measures.elements import scalar
from orchestration.results.measures.expression import (
    ARITHMETIC,
    Binary,
    Column,
    Expression,
    Norm,
    Number,
    Reduction,
    Time,
    Unary,
)
from orchestration.results.measures.reader import Reader

SHOWN, IDEAL = "shown", "ideal"
"""Names of the run that the visitor sees, and of the run with true mass and perfect sensor."""
SAMPLED = ("trajectory", "sensor", "controller", "actuator")
"""Components whose row k + 1 holds what they computed at time[k]; each of them ticks at every row of the page."""
PAIRS = ("F_ext", "x", "e", "x_t", "x_v", "saturated")
"""Variables of two elements that formulas name as a whole."""
_COMPARISONS = ("<", "<=", ">", ">=")
_REDUCTIONS = ("max", "min", "mean", "share", "initial", "final")

TOUCHING = "norm(plant.F_ext) > 0"
SATURATED = "norm(actuator.saturated) > 0"
_FIRST, _LAST = f"first_time({TOUCHING})", f"last_time({TOUCHING})"
_BEFORE, _FROM, _AFTER = f"time < {_FIRST}", f"time >= {_FIRST}", f"time >= {_LAST}"
_DURING = f"{_FROM} and time <= {_LAST}"
_E, _APART, _M2 = "norm(controller.e)", "norm(controller.x_t - trajectory.x_v)", "controller.p_hat[2]"
_M2_ERROR = f"abs({_M2} - fig5.plant.m[2])"
_EITHER_TOUCHING = f"norm(plant.F_ext) + norm({IDEAL}.plant.F_ext) > 0"
_TOUCHES = f"count({TOUCHING})"
_END = ", ".join(f"final(plant.x[{i}]) - {place}" for i, place in enumerate(TIP_START, 1)).replace("- -", "+ ")

MEASURES: Mapping[str, str] = {
    "first": _FIRST,
    "last": _LAST,
    "peak_force": "max(norm(plant.F_ext))",
    "steady_force": f"mean(norm(plant.F_ext), where={TOUCHING} and {_TOUCHES} >= 1 + (max({_TOUCHES}) > 1))",
    "touching": f"share({TOUCHING}, where={_DURING})",
    "bounces": f"max({_TOUCHES}) - 1",
    "enter_1": f"initial(plant.x[1], where={TOUCHING})",
    "enter_2": f"initial(plant.x[2], where={TOUCHING})",
    "leave_1": f"final(plant.x[1], where={TOUCHING})",
    "leave_2": f"final(plant.x[2], where={TOUCHING})",
    "apart_before": f"max({_APART}, where={_BEFORE})",
    "apart_later": f"max({_APART}, where={_FROM})",
    "end": f"norm({_END})",
    "m2_settled": f"max(time * ({_M2_ERROR} > {SETTLED}), where={_BEFORE})",
    "m2_at_contact": f"final({_M2_ERROR}, where={_BEFORE})",
    "m2_in_contact": f"max({_M2_ERROR}, where={_DURING})",
    "m2_fluctuation": f"max({_M2}, where={_DURING}) - min({_M2}, where={_DURING})",
    "m2_recovery": f"max((time - {_LAST}) * ({_M2_ERROR} > {RECOVERED}), where={_AFTER})",
    "torque_1": "max(abs(controller.tau_cmd[1]))",
    "torque_2": "max(abs(controller.tau_cmd[2]))",
    "e_max": f"max({_E})",
    "e_start": f"max({_E}, where=not ({_FROM}))",
    "e_free": f"max({_E}, where={_BEFORE} and time > {_FIRST} / 2)",
    "e_contact": f"max({_E}, where={_DURING})",
    "force_error": f"rms(norm(plant.F_ext - {IDEAL}.plant.F_ext), where={_EITHER_TOUCHING})",
    "m2_end": f"final({_M2})",
    "share_saturated": f"share({SATURATED})",
}
"""Measures of one run by name, as `orchestration.paper.measure` has them; NaN without a contact where they need one."""


class _PageReader(Reader):
    """Reads formulas of the page, in which reductions lie within others and conditions are numbers."""

    def inner(self, node: ast.expr) -> Expression:
        """Any part of a formula."""
        return self.expression(node, self.inner)

    def number(self, node: ast.expr, read: Callable[[ast.expr], Expression]) -> Expression:
        """A number, or a condition as 1 or 0."""
        return read(node)

    def call(self, node: ast.Call, function: str, arguments: Any, keywords: Any, read: Any) -> Expression:
        """A function or a reduction, or ``count``."""
        if function == "count":
            return Unary("count", self.inner(arguments[0]))
        return super().call(node, function, arguments, keywords, read)


@dataclass
class Formulas:
    """The parts of formulas, each once, as records ``[operation, operands...]``; operands are places of other parts.

    Attributes
    ----------
    runs
        Names of the runs that formulas name.
    outputs
        Names of the columns of every run; any other name is that of a start value.
    nodes
        The records.
    columns
        Columns that formulas need of each run.
    """

    runs: Collection[str]
    outputs: Collection[str]
    nodes: list[list[Any]] = field(default_factory=list)
    columns: dict[str, list[str]] = field(default_factory=dict)
    _places: dict[tuple[Any, ...], int] = field(default_factory=dict)

    def place(self, text: str, run: str = SHOWN) -> int:
        """Add a formula, and return the place of its value.

        Parameters
        ----------
        run
            Run of the names without a run.

        Raises
        ------
        FormulaError
            If the text is no formula.
        TypeError
            If the script cannot compute a part of it.
        """
        reader = _PageReader(text)
        tree = scalar(reader.inner(ast.parse(text, mode="eval").body), _elements)
        return self._placed(tree, run)

    def number(self, value: float) -> int:
        """The place of a number."""
        return self._add("number", value)

    def compared(self, left: int, comparison: str, right: int) -> int:
        """The place of a comparison (``<``, ``<=``, ``>``, ``>=``) of two parts; the first two are turned round."""
        if comparison.startswith(">"):
            return self._add(comparison, left, right)
        return self._add(comparison.replace("<", ">"), right, left)

    def both(self, one: int, two: int) -> int:
        """The place of whether two conditions hold: their product, as they are 1 or 0."""
        return self._add("*", one, two)

    def _placed(self, tree: Expression, run: str) -> int:
        """The place of a part of a formula of a run, and before it those of its own parts."""
        placed = partial(self._placed, run=run)
        match tree:
            case Column(name):
                return self._named(name, run)
            case Number(value):
                return self.number(value)
            case Time():
                return self._column(run, "time")
            case Unary("-" | "not" as op, of):  # of 1 and 0, not x is 1 - x
                return self._add("-", self.number(0.0 if op == "-" else 1.0), placed(of))
            case Unary(op, of):
                return self._add(op, placed(of))
            case Binary("and", left, right):
                return self.both(placed(left), placed(right))
            case Binary(op, left, right) if op in _COMPARISONS:
                return self.compared(placed(left), op, placed(right))
            case Binary(op, left, right) if op in ARITHMETIC:
                return self._add(op, placed(left), placed(right))
            case Norm((one, two)):
                return self._add("norm", placed(one), placed(two))
            case Reduction("rms", value, where):
                return self._add("sqrt", placed(Reduction("mean", Binary("*", value, value), where)))
            case Reduction("first_time" | "last_time" as kind, value, None):
                return self._add("initial" if kind == "first_time" else "final", placed(Time()), placed(value))
            case Reduction(kind, value, where) if kind in _REDUCTIONS:
                chosen = [] if where is None else [placed(where)]
                return self._add("mean" if kind == "share" else kind, placed(value), *chosen)
        msg = f"{tree!r} is no part of a formula of the page."
        raise TypeError(msg)

    def _named(self, name: str, run: str) -> int:
        """The place of a measure, a column or a start value, of the run that the name begins with if it does."""
        first, _, rest = name.partition(".")
        if first in self.runs:
            run, name = first, rest
        if name in MEASURES:
            return self.place(MEASURES[name], run)
        return self._column(run, name) if name in self.outputs else self._add("start", run, name)

    def _column(self, run: str, name: str) -> int:
        needed = self.columns.setdefault(run, [])
        if name not in (*needed, "time"):
            needed.append(name)
        return self._add("column", run, name, int(name.partition(".")[0] in SAMPLED))

    def _add(self, *record: Any) -> int:
        """The place of a record, which is added unless it is there."""
        place = self._places.setdefault(record, len(self.nodes))
        if place == len(self.nodes):
            self.nodes.append(list(record))
        return place

    def runs_of(self, place: int) -> set[str]:
        """Names of the runs that a part needs rows of."""
        op, *operands = self.nodes[place]
        if op in ("column", "start"):
            return {operands[0]} if op == "column" else set()
        return set() if op == "number" else {run for operand in operands for run in self.runs_of(operand)}


def _elements(name: str) -> tuple[str, ...]:
    """Names of the elements of a pair, or the name itself."""
    return tuple(f"{name}[{i}]" for i in (1, 2)) if name.rpartition(".")[2] in PAIRS else (name,)
