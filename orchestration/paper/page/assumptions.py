"""The section of a page with what the paper leaves open: assumed values of a run, each with the reason for it."""

from collections.abc import Mapping

from markupsafe import Markup

from orchestration.fmi.names import arrays
from orchestration.paper.scenarios import ALL_SCENARIOS
from orchestration.report.markup import for_run, table
from orchestration.report.origin import origin_of
from orchestration.report.page import Section
from orchestration.report.tables import paragraph
from orchestration.results.result import Result
from orchestration.system.system import System

ASSUMED = "assumed: "
Assumptions = Mapping[str, tuple[float | str | None, str]]
"""Value and reason by ``component.variable``."""


def assumptions_of(result: Result, system: System | None) -> Assumptions:
    """Assumed values of a run: those that its system marks, or those of the scenario whose values it has kept."""
    origin = origin_of(result)
    if origin is None:
        return {}
    values = {f"{component}.{name}": value for component, own in origin.start.items() for name, value in own.items()}
    if system is not None:
        return {path: (values.get(path), text) for path, text in system.assumptions.items()}
    scenario = ALL_SCENARIOS.get(origin.system)
    if scenario is None:
        return {}
    marked = {path: value for path, value in scenario.values.items() if value.assumed}
    return {path: (v.number, v.origin) for path, v in marked.items() if values.get(path) == v.number}


def assumptions_section(results: Mapping[str, Result], systems: Mapping[str, System]) -> Section | None:
    """The assumed values of runs; None if nothing is marked as assumed."""
    parts = []
    for label, result in results.items():
        found = assumptions_of(result, systems.get(label))
        if not found:
            continue
        parts.append(for_run(label, table(("values", "reason"), _by_reason(found)), len(results)))
    if not parts:
        return None
    lead = paragraph("The paper does not state these values; each was chosen for the reason beside it.")
    return Section("assumptions", "What the paper leaves open", lead + Markup().join(parts))


def _by_reason(found: Assumptions) -> list[tuple[Markup, str]]:
    """One row for each reason; elements of an array with one value share a line."""
    reasons: dict[str, dict[str, float | str | None]] = {}
    for path, (value, reason) in found.items():
        reasons.setdefault(reason.removeprefix(ASSUMED), {})[path] = value
    return [(_lines(values), reason) for reason, values in reasons.items()]


def _lines(values: Mapping[str, float | str | None]) -> Markup:
    names = tuple(values)
    whole = {base: [names[i] for i in places.ravel()] for base, places in arrays(names).items()}
    equal = {base: group for base, group in whole.items() if len({values[name] for name in group}) == 1}
    grouped = {name: base for base, group in equal.items() for name in group}
    shown = {grouped.get(name, name): values[name] for name in names}
    lines = [
        f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}" for name, value in shown.items()
    ]
    return Markup("<br>").join(Markup("<code>{}</code>").format(line) for line in lines)
