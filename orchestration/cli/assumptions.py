"""Prints the assumed values of a system with the reasons for them: ``adaptimp run --assumptions``."""

import json as formats

from orchestration.cli.output import output, width
from orchestration.cli.tables import side_by_side
from orchestration.errors import printable
from orchestration.fmi.codes import BOOLEAN
from orchestration.system.system import System


def print_assumptions(system: System, *, json: bool) -> None:
    """Print the assumed values of a system; values with the same reason are printed together.

    Parameters
    ----------
    json
        Whether to print an object with the reasons by ``component.variable`` instead.
    """
    if json:
        output.data(formats.dumps(dict(system.assumptions), indent=2))
        return
    reasons: dict[str, list[str]] = {}
    for path in sorted(system.assumptions):
        reasons.setdefault(system.assumptions[path], []).append(f"{path} = {_value(system, path)}")
    if not reasons:
        output.data(f"{printable(system.name)}: nothing is marked as assumed.")
        return
    rows = [(values, reason.removeprefix("assumed: ")) for reason, values in reasons.items()]
    output.data(side_by_side(rows, width()) + "\n")
    output.data(f"{printable(system.name)}: {len(system.assumptions)} assumed values")


def _value(system: System, path: str) -> str:
    """Return the start value of a variable with its unit, as text."""
    component, variable = system.resolve(path)
    value = component.start.get(variable.name, variable.start)
    if value is None:
        return "unknown"
    if variable.type == BOOLEAN:
        return "true" if value else "false"
    return f"{value:g} {variable.unit}".rstrip()
