"""What of a system other tools would lose: start values, types, units, and inputs without a source."""

from collections.abc import Iterator

from orchestration.analysis.doctor.finding import Finding, Severity, counted, listed
from orchestration.fmi.codes import REAL
from orchestration.system.component import Component
from orchestration.system.system import Connection, System


def portability_findings(system: System) -> Iterator[Finding]:
    """Findings on what other tools read in another way; docs/interop.md says which tools."""
    for check in (_unconnected, _relative, _without_unit, _converted, _discrete, _input_starts, _parameters):
        yield from check(system)


def _unconnected(system: System) -> Iterator[Finding]:
    free = system.unconnected_inputs()
    if free:
        given = [f"{path} = {_shown(system, path)}" for path in free]
        yield Finding(
            "unconnected-inputs",
            Severity.WARNING,
            free[0],
            f"Inputs without a source keep their start values: {listed(given)}; other tools may take 0.",
            {"inputs": free},
            "Connect them, or give them a time series.",
        )


def _start(system: System, path: str) -> float | str:
    """Start value of a variable that is in force; 0 if it has none."""
    component, variable = system.resolve(path)
    value = component.start.get(variable.name, variable.start)
    return 0.0 if value is None else value


def _shown(system: System, path: str) -> str:
    value = _start(system, path)
    return repr(value) if isinstance(value, str) else f"{value:g}"


def _relative(system: System) -> Iterator[Finding]:
    """Connections of a difference to an absolute value in units with different offsets."""
    for c, source, target in _ends(system):
        output, input_ = source.variable(c.output), target.variable(c.input)
        units = [source.description.unit(output), target.description.unit(input_)]
        offsets = {unit.meaning.offset for unit in units if unit is not None and unit.meaning is not None}
        if output.relative == input_.relative or not offsets - {0.0}:
            continue
        ends = [f"{c.source}.{c.output}", f"{c.target}.{c.input}"]
        difference, absolute = ends if output.relative else reversed(ends)
        yield Finding(
            "relative-quantity",
            Severity.WARNING,
            f"{c.source}.{c.output}",
            f"{difference} is declared as a difference (relativeQuantity) and {absolute} as an absolute value, so"
            f" {output.unit} becomes {input_.unit} without the offset.",
            {"output_unit": output.unit, "input_unit": input_.unit},
            "Declare both ends alike, or give the Connection a factor and an offset.",
        )


def _without_unit(system: System) -> Iterator[Finding]:
    found = [
        str(c)
        for c, source, target in _ends(system)
        if source.variable(c.output).type == REAL
        and bool(source.variable(c.output).unit) != bool(target.variable(c.input).unit)
    ]
    if found:
        yield Finding(
            "missing-units",
            Severity.NOTE,
            found[0],
            f"One end of {counted(len(found), 'connection')} declares a unit and the other does not, so nothing"
            f" is checked or converted: {listed(found)}.",
            {"connections": found},
            "Declare the units, if one of these is wrong by a factor.",
        )


def _converted(system: System) -> Iterator[Finding]:
    found = [str(c) for c in system.connections if not c.scale.trivial]
    if found:
        yield Finding(
            "conversions",
            Severity.NOTE,
            found[0],
            f"{counted(len(found), 'connection', 'changes', 'change')} the number on its way: {listed(found)};"
            " most other tools pass numbers on as they are.",
            {"connections": found},
            "Use the same unit at both ends for other tools.",
        )


def _discrete(system: System) -> Iterator[Finding]:
    found = [str(c) for c, source, _ in _ends(system) if source.variable(c.output).type != REAL]
    if found:
        yield Finding(
            "discrete-connections",
            Severity.NOTE,
            found[0],
            f"{counted(len(found), 'connection', 'carries', 'carry')} Integers, Booleans or texts: {listed(found)};"
            " tools that move every variable as a Real refuse them.",
            {"connections": found},
        )


def _input_starts(system: System) -> Iterator[Finding]:
    found = [path for path in system.sources if _start(system, path) not in (0, "")]
    if found:
        yield Finding(
            "input-starts",
            Severity.NOTE,
            found[0],
            f"{counted(len(found), 'connected input', 'starts', 'start')} away from 0: {listed(found)}; tools"
            " that let inputs start with 0 show other values before the first step, or fail.",
            {"inputs": found},
        )


def _parameters(system: System) -> Iterator[Finding]:
    found = [f"{component.name}.{name}" for component in system.components for name in component.start]
    if found:
        yield Finding(
            "start-values",
            Severity.NOTE,
            found[0],
            f"{counted(len(found), 'start value', 'belongs', 'belong')} to the system and not to its FMUs; tools that"
            " read no parameter sets of SSP packages run with the FMUs' own.",
            {"values": len(found)},
        )


def _ends(system: System) -> Iterator[tuple[Connection, Component, Component]]:
    for c in system.connections:
        yield c, system.component(c.source), system.component(c.target)
