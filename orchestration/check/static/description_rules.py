"""Checks rules 2, 3, 5 and 6: variables, units, limits and capabilities that an FMU's description declares."""

import math
import re
from collections.abc import Iterator

from orchestration.check.findings import Finding, error, shown, warning
from orchestration.check.static.archive_rules import Package
from orchestration.fmi import formalities
from orchestration.fmi.codes import SERIALIZES_STATE
from orchestration.fmi.document import Declared

_ELEMENT = r"""(?:[A-Za-z_]\w*|'(?:[ !#-&(-\[\]-~]|\\['"?\\abfnrtv])+')(?:\[\d+(?:,\d+)*\])?"""
_PATH = rf"{_ELEMENT}(?:\.{_ELEMENT})*"
_STRUCTURED = re.compile(rf"{_PATH}|der\({_PATH}(?:,\d+)?\)", re.ASCII)  # section 2.2.9


def combinations_are_legal(package: Package) -> Iterator[Finding]:
    """Check rule 2: causality, variability and `initial` of each variable go together."""
    for sentence in formalities.combinations(package.document, shown):
        yield error("2", sentence)


def starts_are_where_needed(package: Package) -> Iterator[Finding]:
    """Check rule 3: variables have a start value where FMI demands one, and only where FMI allows one."""
    for variable in package.document.variables:
        if variable.causality in ("input", "independent") and "initial" in variable.given:
            said = f"{shown(variable.name)} has initial {variable.initial}, but is an {variable.causality}"
            yield warning("3", f"{said}, which has none.")
    for sentence in formalities.starts(package.document, shown):
        yield error("3", sentence)


def names_are_unique_and_structured(package: Package) -> Iterator[Finding]:
    """Check rule 5: names are unique and follow the grammar of structured names."""
    seen: set[str] = set()
    for variable in package.document.variables:
        if variable.name in seen:
            yield error("5", f"The name {shown(variable.name)} is used more than once.")
        seen.add(variable.name)
        if package.document.structured and not _STRUCTURED.fullmatch(variable.name):
            yield warning("5", f"The name {shown(variable.name)} breaks the grammar of structured names.")


def units_are_declared(package: Package) -> Iterator[Finding]:
    """Check rule 5: units, display units and types are declared, and every unit has a BaseUnit that converts."""
    document = package.document
    for name, unit in document.units.items():
        if unit is None:
            yield warning("5", f"The unit {shown(name)} has no BaseUnit; importers cannot compare it.")
        elif not unit.convertible:
            yield error("5", f"The unit {shown(name)} has factor {unit.factor:g} and offset {unit.offset:g}.")
    for sentence in formalities.units(document, shown):
        yield error("5", sentence)
    for variable in document.variables:
        name, unit = shown(variable.name), variable.unit
        if variable.declared_type and variable.declared_type not in document.types:
            yield error("5", f"{name}: the type {shown(variable.declared_type)} is not declared.")
        elif (
            unit in document.units
            and variable.display_unit
            and variable.display_unit not in document.display_units.get(unit, ())
        ):
            yield error("5", f"{name}: the display unit {shown(variable.display_unit)} is not one of {shown(unit)}.")


def limits_hold(package: Package) -> Iterator[Finding]:
    """Check rule 5: start values lie within the limits of their variables."""
    for variable in package.document.variables:
        low, high = (bound if bound is not None else default for bound, default in _bounds(variable))
        start, name = variable.number, shown(variable.name)
        if not low <= high:
            yield warning("5", f"{name}: min {low:g} exceeds max {high:g}.")
        elif start is not None and variable.type != "Boolean" and not low <= start <= high:
            yield warning("5", f"{name}: start {start:g} is outside of [{low:g}, {high:g}].")


def experiment_makes_sense(package: Package) -> Iterator[Finding]:
    """Check rule 5: times and tolerance of the default experiment make sense."""
    names = ("startTime", "stopTime", "stepSize", "tolerance")
    start, stop, step, tolerance = map(package.document.experiment, names)
    first = 0.0 if start is None else start
    if not math.isfinite(first) or (stop is not None and not first < stop < math.inf):
        yield error("5", f"DefaultExperiment: stopTime {stop} must be later than startTime {first}, both finite.")
    if step is not None and not 0 < step < math.inf:
        yield error("5", f"DefaultExperiment: stepSize {step:g} must be positive.")
    if tolerance is not None and not 0 < tolerance < math.inf:
        yield error("5", f"DefaultExperiment: tolerance {tolerance:g} must be positive.")


def capabilities_agree(package: Package) -> Iterator[Finding]:
    """Check rule 6: capability flags and identifiers agree with each other."""
    document = package.document
    if document.flag(SERIALIZES_STATE) and not document.flag("canGetAndSetFMUstate"):
        yield error("6", f"{SERIALIZES_STATE} is true, but canGetAndSetFMUstate false: there is no state to serialize.")
    for sentence in formalities.identifier(document, shown):
        yield error("6", sentence)
    exchange = document.root.find("ModelExchange")
    other = document.identifier if exchange is None else exchange.get("modelIdentifier")
    if other != document.identifier:
        yield warning("6", f"The modelIdentifiers {shown(document.identifier)} and {shown(other)} differ.")
    if not document.guid.strip():
        yield error("1", "The guid is empty: importers refuse the FMU, or cannot tell versions apart.")
    seen: set[str] = set()
    for category in document.root.iterfind("LogCategories/Category"):
        name = category.get("name")
        if name in seen:
            yield warning("6", f"The log category {shown(name)} is declared more than once.")
        seen.add(name)


def _bounds(variable: Declared) -> tuple[tuple[float | None, float], tuple[float | None, float]]:
    return (variable.limits[0], -math.inf), (variable.limits[1], math.inf)
