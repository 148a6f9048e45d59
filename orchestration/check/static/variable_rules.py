"""Checks rules 2, 3 and 5: what variables of a description must not have together."""

from collections import defaultdict
from collections.abc import Iterator

from orchestration.check.findings import Finding, error, listed, shown, warning
from orchestration.check.static.archive_rules import Package
from orchestration.fmi.codes import REAL
from orchestration.fmi.document import Declared, Document

FOR_EXCHANGE = ("reinit", "canHandleMultipleSetPerTimeInstant")
"""Attributes of variables that only FMUs for model exchange have."""


def time_is_one_variable(package: Package) -> Iterator[Finding]:
    """Check rule 2: at most one variable is independent, and it is a Real."""
    times = package.document.of_causality("independent")
    if len(times) > 1:
        yield error("2", f"{listed([v.name for v in times])} are independent variables; there is one time only.")
    for variable in times:
        if variable.type != REAL:
            yield error(
                "2", f"{shown(variable.name)} is an independent variable of type {variable.type}; time is a Real."
            )


def aliases_agree(package: Package) -> Iterator[Finding]:
    """Check rules 3 and 5: variables that share a value reference have one start value and one unit."""
    for alike in _alias_sets(package.document):
        first, reference = alike[0], alike[0].reference
        names = listed([v.name for v in alike])
        started = [v for v in alike if v.start is not None]
        texts = dict.fromkeys(v.start for v in started)
        if first.variability == "constant" and len(texts) > 1:
            yield error("3", f"{names} are one constant (valueReference {reference}), but have several values.")
        elif first.variability != "constant" and len(started) > 1:
            values = ", ".join(f"{shown(v.name)} = {shown(v.start)}" for v in started[:4])
            yield error(
                "3", f"{names} are one variable (valueReference {reference}) with several start values: {values}."
            )
        units = dict.fromkeys(v.unit for v in alike)
        if len(units) > 1:
            said = ", ".join(shown(unit) or "none" for unit in list(units)[:4])
            yield error("5", f"{names} are one variable (valueReference {reference}), but have several units: {said}.")


def attributes_are_for_co_simulation(package: Package) -> Iterator[Finding]:
    """Check rule 3: a description without model exchange has no attribute that only model exchange has."""
    if package.document.root.find("ModelExchange") is not None:
        return
    for attribute in FOR_EXCHANGE:
        rows = package.document.root.findall("ModelVariables/ScalarVariable")
        names = [row.get("name") for row in rows if attribute in row.attrib or any(attribute in c.attrib for c in row)]
        if names:
            yield warning("3", f"{listed(names)} have the attribute {attribute}, which is for model exchange only.")


def _alias_sets(document: Document) -> Iterator[list[Declared]]:
    """Yield the variables that share a value reference, where there is more than one."""
    found = defaultdict[tuple[str, int], list[Declared]](list)
    for variable in document.variables:
        found[variable.type, variable.reference].append(variable)
    yield from (alike for alike in found.values() if len(alike) > 1)
