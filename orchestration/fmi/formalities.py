"""Rules of form that FMI 2.0 gives for a description, and that no step needs.

An FMU that breaks one of them runs all the same: its values do not depend on the rule. A run warns, and
`orchestration.check` reports an error.
"""

from collections.abc import Callable, Iterator
from re import ASCII
from re import compile as pattern

from orchestration.fmi.codes import REAL
from orchestration.fmi.document import APPROX, CALCULATED, EXACT, Declared, Document

IDENTIFIER = pattern(r"[A-Za-z_]\w*", ASCII)
"""What a model identifier must match by the standard, because it begins the names of functions in C."""

Sentences = Iterator[str]

_ANY = frozenset({EXACT, APPROX, CALCULATED})
_COMPUTED = frozenset({APPROX, CALCULATED})
# FMI 2.0.5, section 2.2.7: `initial` by causality and variability; what is not listed is illegal.
LEGAL: dict[tuple[str, str], frozenset[str]] = {
    ("parameter", "fixed"): frozenset({EXACT}),
    ("parameter", "tunable"): frozenset({EXACT}),
    ("calculatedParameter", "fixed"): _COMPUTED,
    ("calculatedParameter", "tunable"): _COMPUTED,
    ("input", "discrete"): frozenset(),
    ("input", "continuous"): frozenset(),
    ("output", "constant"): frozenset({EXACT}),
    ("output", "discrete"): _ANY,
    ("output", "continuous"): _ANY,
    ("local", "constant"): frozenset({EXACT}),
    ("local", "fixed"): _COMPUTED,
    ("local", "tunable"): _COMPUTED,
    ("local", "discrete"): _ANY,
    ("local", "continuous"): _ANY,
    ("independent", "continuous"): frozenset(),
}


def combinations(document: Document, shown: Callable[[str], str] = str) -> Sentences:
    """Give a sentence for each variable whose causality, variability and `initial` do not go together.

    Parameters
    ----------
    shown
        Makes a name fit for a message.
    """
    for variable in document.variables:
        pair = (variable.causality, variable.variability)
        name = shown(variable.name)
        if variable.type != REAL and variable.variability == "continuous":
            how = "declares" if "variability" in variable.given else "has, by default,"
            yield f"{name} {how} variability continuous, which only a Real can have; declare discrete."
        elif pair not in LEGAL:
            yield f"{name}: causality {pair[0]} and variability {pair[1]} exclude each other."
        elif LEGAL[pair] and variable.initial not in LEGAL[pair]:
            legal = " or ".join(sorted(LEGAL[pair]))
            yield f"{name}: initial {variable.initial} is illegal for a {pair[1]} {pair[0]}; {legal} is."


def starts(document: Document, shown: Callable[[str], str] = str) -> Sentences:
    """Give a sentence for each variable that lacks a start value, or has one that FMI does not allow."""
    for variable in document.variables:
        name, kind = shown(variable.name), variable.causality
        needed = needs_start(variable)
        if needed and variable.start is None:
            why = "is an input" if kind == "input" else f"has initial {variable.initial}"
            yield f"{name} {why}, but no start value."
        elif variable.start is not None and not needed:
            why = "is the independent variable" if kind == "independent" else "has initial calculated"
            yield f"{name} {why}, but a start value."


def units(document: Document, shown: Callable[[str], str] = str) -> Sentences:
    """Give a sentence for each variable whose unit is not defined."""
    for variable in document.variables:
        if variable.unit and variable.unit not in document.units:
            yield f"{shown(variable.name)}: the unit {shown(variable.unit)} is not declared in UnitDefinitions."


def identifier(document: Document, shown: Callable[[str], str] = str) -> Sentences:
    """Give a sentence if the model identifier could not begin the name of a function."""
    if not IDENTIFIER.fullmatch(document.identifier):
        yield f"The modelIdentifier {shown(document.identifier)!r} is not a C identifier."


RULES = (identifier, combinations, starts, units)
"""The rules that a run warns of."""


def needs_start(variable: Declared) -> bool:
    """Whether FMI demands a start value of a variable."""
    known = variable.initial in (EXACT, APPROX)
    return variable.causality == "input" or (variable.causality != "independent" and known)
