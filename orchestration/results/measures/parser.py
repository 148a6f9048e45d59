"""Reads the text of a formula with Python's own reader; whatever is not part of a formula is refused."""

import ast
import warnings

from orchestration.errors import FormulaError
from orchestration.fmi.given import require_type, shown
from orchestration.results.measures.expression import Reduction, is_condition, walk
from orchestration.results.measures.formula import Formula
from orchestration.results.measures.reader import Reader

LONGEST = 4000  # characters


def parse_formula(text: str) -> Formula:
    """Read the text of a measure.

    Parameters
    ----------
    text
        Reductions such as ``max(...)``, of which `Reduction` lists all, joined by arithmetic. Within: ``+ - * /``,
        ``**2``, comparisons, ``and``, ``or``, ``not``, ``abs``, ``sqrt``, ``norm``, ``before(condition)``,
        ``since(condition)``, numbers, ``time``, and columns such as ``plant.F_ext[1]``. A name that Python could not
        read stands in quotes. Every reduction takes ``where=condition``.

    Raises
    ------
    FormulaError
        If the text is no formula; the message shows the place.

    Examples
    --------
    >>> from orchestration import scenario, simulate
    >>> from orchestration.results.measures.parser import parse_formula
    >>> largest = parse_formula("max(norm(plant.F_ext), where=time < 1)")
    >>> result = simulate(scenario("fig2"))
    >>> round(largest.evaluate(result)), largest.unit(result.unit)
    (57, 'N')
    """
    require_type("A measure", text, str, "give a text, such as 'max(norm(plant.F_ext))'", FormulaError)
    line = " ".join(text.split("\n")).strip()
    reader = Reader(line)
    if len(line) > LONGEST:
        msg = f"A measure has {len(line)} characters; {LONGEST} are the most. Give several measures instead."
        raise FormulaError(msg)
    try:
        tree = reader.outer(_python(line))
    except (RecursionError, MemoryError) as error:
        msg = f"Measure {shown(line)}: its parentheses or operators lie too deep; give several measures instead."
        raise FormulaError(msg) from error
    if is_condition(tree):
        msg = f"Measure {line}: a measure is a number, and this is a condition; write share(...) or duration(...)."
        raise FormulaError(msg)
    if not any(isinstance(node, Reduction) for node in walk(tree)):
        msg = f"Measure {line}: nothing of a run is reduced; write a reduction such as max(norm(plant.F_ext))."
        raise FormulaError(msg)
    return Formula(tree)


def _python(line: str) -> ast.expr:
    """The text as Python reads it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python warns of what the reader below refuses
            return ast.parse(line, mode="eval").body
    except (SyntaxError, ValueError) as error:
        place = f", character {error.offset}" if isinstance(error, SyntaxError) and error.offset else ""
        reason = error.msg if isinstance(error, SyntaxError) else str(error)
        msg = (
            f"Measure {line or repr(line)}{place}: {reason}; write a formula such as max(norm(plant.F_ext)), and a"
            ' name that is no name in Python in quotes, such as max("Drive 1.w").'
        )
        raise FormulaError(msg) from error
