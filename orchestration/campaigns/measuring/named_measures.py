"""Measures as users give them: names of ready ones, formulas, functions; and their fit to a system."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from orchestration.campaigns.columns import RESERVED
from orchestration.campaigns.measuring.measure import Measure
from orchestration.campaigns.measuring.registry import ready_measures
from orchestration.errors import StudyError
from orchestration.fmi.given import shown
from orchestration.fmi.names import suggestion
from orchestration.results.measures.parser import parse_formula
from orchestration.system.system import System

_NAMED = re.compile(r"\s*([A-Za-z_]\w*)\s*=(?!=)(.*)", re.DOTALL)


def measures_of(given: Any, systems: Sequence[System]) -> tuple[Measure, ...]:
    """Measures that names, formulas and functions mean.

    Parameters
    ----------
    given
        One or a sequence of: the name of a ready measure, a formula, ``name = formula``, a function of a `Result`,
        ``(name, unit, function)``, a `Measure`. Or a mapping from a name to a formula or a function.
    systems
        Systems that must have all columns of formulas; the first one tells the units.

    Raises
    ------
    StudyError
        If a measure is unknown, or two have the same name.
    FormulaError
        If a formula cannot be read.
    SystemDescriptionError
        If a system lacks a column.
    """
    if isinstance(given, Mapping):
        items = [_named(name, item, systems) for name, item in given.items()]
    else:
        items = [_measure(item, systems) for item in _items(given)]
    if not items:
        msg = 'A study needs a measure; give one, such as "max(plant.penetration)", or a function of a Result.'
        raise StudyError(msg)
    names = [name for measure in items for name in measure.names]
    for name in names:
        if names.count(name) > 1 or name in RESERVED:
            msg = f"The measure {name} is given twice, or has a name of its own meaning; give it another name."
            raise StudyError(msg)
    for system in systems:
        for measure in items:
            fitted(measure, system)
    return tuple(items)


def functions_of(given: Any) -> list[Measure]:
    """The functions among measures as a user gives them; formulas and names of ready measures are left out."""
    if isinstance(given, Mapping):
        return [Measure.of(item, name) for name, item in given.items() if not isinstance(item, str)]
    items = [_measure(item, ()) for item in _items(given) if not isinstance(item, str)]
    return [measure for measure in items if measure.function is not None]


def fitted(measure: Measure, system: System) -> Measure:
    """A measure with the names of a system's scalars in its formula, after a check that the system has them.

    Raises
    ------
    SystemDescriptionError
        If the system lacks a column.
    """
    for column in measure.needed:
        for path in system.elements(column):
            system.resolve(path)
    return measure.expanded(system.elements)


def _items(given: Any) -> Sequence[Any]:
    """Measures one by one, of which a user may give one alone."""
    alone = isinstance(given, str | Measure) or callable(given) or _is_triple(given)
    return [given] if alone or not isinstance(given, Sequence) else given


def _is_triple(given: Any) -> bool:
    """Whether it is one measure as ``(name, unit, function)``."""
    return isinstance(given, tuple) and len(given) == 3 and callable(given[2])


def _measure(given: Any, systems: Sequence[System]) -> Measure:
    if isinstance(given, Measure):
        return given
    if isinstance(given, str):
        return _of_text(given, systems)
    if _is_triple(given):
        return Measure.of(given[2], given[0], given[1])
    if callable(given):
        return Measure.of(given)
    msg = f"A measure is {shown(given)}; give a formula, the name of a ready measure, or a function of a Result."
    raise StudyError(msg)


def _named(name: str, given: Any, systems: Sequence[System]) -> Measure:
    """A measure with a name of its own."""
    if isinstance(given, str):
        return _formula(name, given, systems)
    return Measure.of(given, name)


def _of_text(text: str, systems: Sequence[System]) -> Measure:
    if match := _NAMED.fullmatch(text):
        return _formula(match[1], match[2].strip(), systems)
    if text.strip().isidentifier():
        ready = ready_measures()
        if text.strip() not in ready:
            advice = suggestion(text.strip(), ready)
            msg = f"There is no ready measure {text.strip()}; {advice} A formula is one, too, such as max(plant.gap)."
            raise StudyError(msg)
        return _formula(text.strip(), ready[text.strip()][0], systems)
    return _formula(text.strip(), text, systems)


def _formula(name: str, text: str, systems: Sequence[System]) -> Measure:
    formula = parse_formula(text)
    system = systems[0]
    expanded = fitted(Measure((name,), ("",), formula), system).formula or formula
    unit = expanded.unit(lambda path: system.resolve(path)[1].unit)
    return Measure((name,), (unit,), formula)
