"""Prints the assumed values of a system with the reasons for them: ``adaptimp run --assumptions``."""

from rich.table import Column, Table

from orchestration.cli.output import output
from orchestration.fmi.codes import BOOLEAN
from orchestration.system.system import System


def print_assumptions(system: System) -> None:
    """Print the assumed values of a system; values with the same reason are printed together."""
    reasons: dict[str, list[str]] = {}
    for path in sorted(system.assumptions):
        reasons.setdefault(system.assumptions[path], []).append(f"{path} = {_value(system, path)}")
    if not reasons:
        output.say(f"{system.name}: nothing is marked as assumed.")
        return
    widest = max(len(value) for values in reasons.values() for value in values)
    table = Table(Column("value", min_width=widest), "why", show_edge=False, show_lines=True)
    for reason, values in reasons.items():
        table.add_row("\n".join(values), reason.removeprefix("assumed: "))
    output.show(table)
    output.say(f"{system.name}: {len(system.assumptions)} assumed values")


def _value(system: System, path: str) -> str:
    """Return the start value of a variable with its unit, as text."""
    component, variable = system.resolve(path)
    value = component.start.get(variable.name, variable.start)
    if value is None:
        return "unknown"
    if variable.type == BOOLEAN:
        return "true" if value else "false"
    return f"{value:g} {variable.unit}".rstrip()
