"""Writes reductions of a run as C: what is computed at each row and at each step, and what remains at the end.

    begin          accumulators
    for k = 0, ..., n:   t = t_k
        at_rows        what needs the values of row k only
        before_steps   the same where the length of step k is needed      (k < n)
        step k
        behind_steps   what needs the values that sampled components hold over step k

Each part of a formula is computed once, however often it occurs. The arithmetic is that of
`orchestration.results.measures.reduction`, operation by operation, so that both give the same bits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from orchestration.containers.c_text import c_number
from orchestration.results.measures.expression import (
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
    walk,
)

_NONE = "real_nan()"
_LOGIC = {"and": "&", "or": "|"}
_LENGTH = "const double h = time_of(s, start_time, k + 1) - t;"


@dataclass(frozen=True)
class Shown:
    """A variable of the program as C.

    Attributes
    ----------
    text
        Its present value.
    sampled
        Whether its component is sampled, so that its value behind a step is the one held over the step.
    """

    text: str
    sampled: bool


@dataclass
class ReductionText:
    """Lines of C for reductions, by the place where they stand, and the values at the end.

    Parameters
    ----------
    shown
        Gives the variable of a name; raises an error if the program does not show it.
    """

    shown: Callable[[str], Shown]
    begin: list[str] = field(default_factory=list)
    at_rows: list[str] = field(default_factory=list)
    before_steps: list[str] = field(default_factory=list)
    behind_steps: list[str] = field(default_factory=list)
    end: list[str] = field(default_factory=list)
    values: list[str] = field(default_factory=list)
    _names: dict[object, str] = field(default_factory=dict)

    def add(self, reduction: Reduction) -> None:
        """Write one more reduction."""
        if reduction not in self._names:
            by_steps = self._is_sampled(reduction)
            self._names[reduction] = self._reduced(reduction, by_steps)
        self.values.append(self._names[reduction])

    def _is_sampled(self, node: Expression) -> bool:
        return any(isinstance(part, Column) and self.shown(part.name).sampled for part in walk(node))

    def _name(self, letter: str) -> str:
        """A new name in C."""
        name = f"{letter}{len(self._names)}"
        self._names[name] = name
        return name

    # ---- parts of formulas ----

    def _computed(self, node: Expression) -> str:
        """The name of a part of a formula in C, which is computed where its values are known."""
        match node:
            case Number(value):
                return c_number(value)
            case Time():
                return "t"
            case _ if node in self._names:
                return self._names[node]
            case Before(condition) | Since(condition):
                return self._ever(node, condition)
        text = self._text(node)
        kind, letter = ("int", "c") if is_condition(node) else ("double", "x")
        name = self._name(letter)
        self._lines(node).append(f"const {kind} {name} = {text};")
        self._names[node] = name
        return name

    def _lines(self, node: Expression) -> list[str]:
        return self.behind_steps if self._is_sampled(node) else self.at_rows

    def _text(self, node: Expression) -> str:
        match node:
            case Column(name):
                return self.shown(name).text
            case Unary("abs", of):
                return f"real_fabs({self._computed(of)})"
            case Unary("sqrt", of):
                return f"REAL_SQRT({self._computed(of)})"
            case Unary(op, of):
                return f"{'!' if op == 'not' else op}{self._computed(of)}"
            case Binary(">", Norm((_, _, *_) as of), Number(0.0)):  # a root is positive if its radicand is
                return f"{self._computed(_squares(of))} > 0.0"
            case Binary(op, left, right):
                return f"{self._computed(left)} {_LOGIC.get(op, op)} {self._computed(right)}"
            case Norm((only,)):
                return f"real_fabs({self._computed(only)})"
            case Norm(of):
                return f"REAL_SQRT({self._computed(_squares(of))})"
            case _:
                msg = f"{node!r} is no number and no condition at an instant."
                raise TypeError(msg)

    def _ever(self, node: Expression, condition: Expression) -> str:
        """A condition about what has happened so far: a flag that is raised once."""
        flag = self._names.get(("flag", condition))
        if flag is None:
            flag = self._name("f")
            self._names["flag", condition] = flag
            self.begin.append(f"int {flag} = 0;")
            self._lines(condition).append(f"{flag} |= {self._computed(condition)};")
        self._names[node] = f"(!{flag})" if isinstance(node, Before) else flag
        return self._names[node]

    # ---- reductions ----

    def _reduced(self, reduction: Reduction, by_steps: bool) -> str:
        """Write a reduction; return its value at the end of the run."""
        match reduction.kind:
            case "max" | "min":
                return self._extreme(reduction, by_steps)
            case "time_of_max" | "time_of_min":
                return self._time_of_extreme(reduction, by_steps)
            case "initial" | "first_time":
                return self._first(reduction, by_steps)
            case "final" | "last_time":
                return self._last(reduction, by_steps)
            case "integral" | "duration":
                return self._summed_over_time(reduction, by_steps)
            case _:
                return self._averaged(reduction, by_steps)

    def _where(self, reduction: Reduction) -> str:
        return "" if reduction.where is None else self._computed(reduction.where)

    def _count(self, where: Expression | None, by_steps: bool, *also: str) -> str:
        """The number of instants at which a condition holds, those of all rows or of all steps, as an integer in C."""
        conditions = [name for name in ("" if where is None else self._computed(where), *also) if name]
        if not conditions:
            return "n" if by_steps else "(n + 1)"
        key = ("count", by_steps, *conditions)
        if key not in self._names:
            name = self._name("n")
            self._names[key] = name
            self.begin.append(f"int64_t {name} = 0;")
            self._at_instants(by_steps).append(f"{name} += {' & '.join(conditions)};")
        return self._names[key]

    def _at_instants(self, by_steps: bool) -> list[str]:
        return self.behind_steps if by_steps else self.at_rows

    def _accumulator(self, letter: str, start: str) -> str:
        name = self._name(letter)
        self.begin.append(f"double {name} = {start};")
        return name

    def _extreme(self, reduction: Reduction, by_steps: bool) -> str:
        """The largest or smallest value. A NaN stays, as numpy has it.

        A root grows with its radicand, rounding included, so the extreme of a norm is the root of the extreme of the
        sums of squares.
        """
        value = reduction.value
        root = isinstance(value, Norm) and len(value.of) > 1
        sign, start = (">", "-REAL_INFINITY") if reduction.kind == "max" else ("<", "REAL_INFINITY")
        x = self._computed(_squares(value.of) if isinstance(value, Norm) and root else value)
        where = self._where(reduction)
        m = self._accumulator("m", start)
        newer = f"{x} {sign} {m}" if _is_a_number(value) else f"!({x} {_not(sign)} {m}) && !real_is_nan({m})"
        self._at_instants(by_steps).append(_if(where, f"if ({newer}) {m} = {x};"))
        found = f"REAL_SQRT({m})" if root else m
        return self._or_none(reduction, by_steps, found)

    def _time_of_extreme(self, reduction: Reduction, by_steps: bool) -> str:
        sign, start = (">", "-REAL_INFINITY") if reduction.kind == "time_of_max" else ("<", "REAL_INFINITY")
        x, where = self._computed(reduction.value), self._where(reduction)
        m, at = self._accumulator("m", start), self._accumulator("a", _NONE)
        newer = f"if ((!({x} {_not(sign)} {m}) && !real_is_nan({m})) || real_is_nan({at})) {m} = {x}, {at} = t;"
        self._at_instants(by_steps).append(_if(where, newer))
        return at

    def _first(self, reduction: Reduction, by_steps: bool) -> str:
        """The value at the first instant, or the first time at which a condition holds."""
        timed = reduction.kind == "first_time"
        x, where = self._computed(reduction.value), self._where(reduction)
        first, found = self._accumulator("a", _NONE), self._name("f")
        self.begin.append(f"int {found} = 0;")
        condition = _all(f"!{found}", where, x if timed else "")
        self._at_instants(by_steps).append(_if(condition, f"{first} = {'t' if timed else x}, {found} = 1;"))
        return first

    def _last(self, reduction: Reduction, by_steps: bool) -> str:
        timed = reduction.kind == "last_time"
        x, where = self._computed(reduction.value), self._where(reduction)
        last = self._accumulator("a", _NONE)
        condition = _all(where, x if timed else "")
        self._at_instants(by_steps).append(_if(condition, f"{last} = {'t' if timed else x};"))
        return last

    def _summed_over_time(self, reduction: Reduction, by_steps: bool) -> str:
        """A sum over the steps, to which the last row of a continuous value does not belong."""
        x, where = self._computed(reduction.value), self._where(reduction)
        total = self._accumulator("z", "0")
        if _LENGTH not in self.before_steps:
            self.before_steps.insert(0, _LENGTH)
        lines = self.behind_steps if by_steps else self.before_steps
        if reduction.kind == "integral":
            lines.append(_if(where, f"{total} += {x} * h;"))
        else:
            lines.append(_if(_all(where, x), f"{total} += h;"))
        return total

    def _averaged(self, reduction: Reduction, by_steps: bool) -> str:
        x, where = self._computed(reduction.value), self._where(reduction)
        count = f"(double){self._count(reduction.where, by_steps)}"
        if reduction.kind == "share":
            total = f"(double){self._count(reduction.where, by_steps, x)}"
            return self._or_none(reduction, by_steps, f"{total} / {count}")
        total = self._accumulator("z", "0")
        term = f"{x} * {x}" if reduction.kind == "rms" else x
        self._at_instants(by_steps).append(_if(where, f"{total} += {term};"))
        found = f"{total} / {count}"
        return self._or_none(reduction, by_steps, f"REAL_SQRT({found})" if reduction.kind == "rms" else found)

    def _or_none(self, reduction: Reduction, by_steps: bool, found: str) -> str:
        """A value at the end, or NaN if there was no instant."""
        if reduction.where is None:
            return found
        return f"{self._count(reduction.where, by_steps)} > 0 ? {found} : {_NONE}"


def reduction_text(reductions: Sequence[Reduction], shown: Callable[[str], Shown]) -> ReductionText:
    """Write reductions of a run as C; see the head of this file."""
    text = ReductionText(shown)
    for reduction in reductions:
        text.add(reduction)
    return text


def _squares(of: Sequence[Expression]) -> Expression:
    """The sum of squares, from left to right."""
    total: Expression = Binary("*", of[0], of[0])
    for part in of[1:]:
        total = Binary("+", total, Binary("*", part, part))
    return total


def _is_finite(node: Expression) -> bool:
    """Whether a number is certainly finite; a run in which a column is not finite fails."""
    match node:
        case Number() | Column() | Time():
            return True
        case Unary("-" | "abs", of):
            return _is_finite(of)
        case _:
            return False


def _is_a_number(node: Expression) -> bool:
    """Whether a number is certainly not NaN."""
    match node:
        case Unary("-" | "abs", of):
            return _is_a_number(of)
        case Binary("+" | "-" | "*", left, right):
            return _is_finite(left) and _is_finite(right)
        case Norm(of):
            return all(map(_is_a_number, of))
        case _:
            return _is_finite(node)


def _not(sign: str) -> str:
    return "<=" if sign == ">" else ">="


def _all(*conditions: str) -> str:
    return " && ".join(condition for condition in conditions if condition)


def _if(condition: str, line: str) -> str:
    return f"if ({condition}) {{ {line} }}" if condition else line
