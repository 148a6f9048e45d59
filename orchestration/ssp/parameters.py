"""Parameter sets of an SSP package: which value goes to which variable.

Bindings of a component come first, then those of the systems around it, the outermost last: later
values win (SSP 1.0, 5.3.2). A set may be mapped to other names, with a linear transformation; a value
in another unit is converted first.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isnan, nan
from typing import Any

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import REAL
from orchestration.fmi.units import AS_IS, Linear, UnitDefinition, conversion, defined
from orchestration.ssp.connectors import Arrival, Element, Wiring
from orchestration.ssp.schema import (
    MAPPING,
    PARAMETER_MAPPING_TYPE,
    PARAMETER_SET_TYPE,
    SSM,
    SSV,
    VALUES,
    Package,
    boolean,
    read_units,
    ssd,
    transformation,
)

Starts = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class _Parameter:
    """A value under a name of the system or component that it is for."""

    name: str
    text: str
    unit: UnitDefinition | None
    scale: Linear = AS_IS
    suppressed: bool = False


def start_values(package: Package, wiring: Wiring, units: dict[str, UnitDefinition]) -> tuple[Starts, list[str]]:
    """Values by component and variable, and notices of what was ignored.

    Raises
    ------
    ArchiveError
        If a parameter set or mapping is missing or invalid.
    SystemDescriptionError
        If a component has no such variable, or a unit cannot be converted.
    """
    reading = _Bindings(package, wiring, units)
    reading.read(wiring.outer)
    return reading.start, reading.notices


class _Bindings:
    def __init__(self, package: Package, wiring: Wiring, units: dict[str, UnitDefinition]) -> None:
        self.package, self.wiring, self.units = package, wiring, units
        self.start: Starts = {}
        self.notices: list[str] = []

    def read(self, element: Element) -> None:
        """Read the bindings in an element, then its own."""
        for child in element.children.values():
            self.read(child)
        for binding in element.xml.iterfind(ssd("ParameterBindings/ParameterBinding")):
            for parameter in self._mapped(element, binding):
                self._assign(element, parameter)

    def _assign(self, element: Element, parameter: _Parameter) -> None:
        found = False
        for arrival, unit in self._targets(element, parameter.name):
            found = True
            name = arrival.variable
            variable = arrival.component.variable(name)
            value: Any = parameter.text
            if variable.type == REAL:
                value = self._converted(parameter, unit, arrival, relative=variable.relative)
            elif not (parameter.scale.trivial and arrival.scale.trivial):
                path = f"{arrival.component.name}.{name}"
                msg = f"{self.package.path}: {path} is of type {variable.type}; only Reals can be scaled."
                raise SystemDescriptionError(msg)
            self.start.setdefault(arrival.component.name, {})[name] = value
        if not found:
            where = ".".join(element.path) or "the system"
            self.notices.append(f"The parameter {parameter.name} of {where} is ignored: it leads to no variable.")

    def _targets(self, element: Element, name: str) -> Iterator[tuple[Arrival, UnitDefinition | None]]:
        """Where a value goes, and the unit that it must have to set out.

        A component must have the variable; names in a system lead to a connector, or on into an element.
        """
        if element.component is not None:
            element.component.variable(name)
            unit = self.wiring.unit(element.component, element.path, name)
            yield Arrival(element.component, name, AS_IS), unit
        elif name in element.connectors:
            for arrival in self.wiring.arrivals(element.path, name):
                yield arrival, element.connectors[name][1]
        else:
            head, dot, rest = name.partition(".")
            if dot and head in element.children:
                child = element.children[head]
                if child.component is None or rest in child.component.description.variables:
                    yield from self._targets(child, rest)

    def _converted(
        self, parameter: _Parameter, unit: UnitDefinition | None, arrival: Arrival, *, relative: bool
    ) -> float | str:
        """The value in the unit of the variable; a text that is no number is left to be refused."""
        try:
            value = float(parameter.text)
        except ValueError:
            value = nan
        if isnan(value):
            return parameter.text
        found = (1.0, 0.0) if parameter.suppressed else conversion(parameter.unit, unit, relative=relative)
        if found is None:
            name = f"{arrival.component.name}.{arrival.variable}"
            given, has = parameter.unit and parameter.unit.name, unit and unit.name
            msg = f"{self.package.path}: {name} is given in {given}, the FMU has {has}."
            raise SystemDescriptionError(msg)
        return arrival.scale(parameter.scale(Linear(*found)(value)))

    def _mapped(self, element: Element, binding: Any) -> Iterator[_Parameter]:
        """Parameters of a binding under the names that they are mapped to."""
        parameters = list(self._parameters(element, binding))
        mapping = binding.find(ssd("ParameterMapping"))
        if mapping is None:
            yield from parameters
            return
        where = f"{self.package.path}: the parameter mapping of {'.'.join(element.path) or 'the system'}"
        root = self._content(element, mapping, (f"{{{SSM}}}ParameterMapping", MAPPING, PARAMETER_MAPPING_TYPE))
        by_name = {parameter.name: parameter for parameter in parameters}
        entries = list(root.iterfind(f"{{{SSM}}}MappingEntry"))
        for entry in entries:
            parameter = by_name.get(entry.get("source"))
            if parameter is None:
                known = ", ".join(by_name) or "none"
                msg = f"{where} has no parameter {entry.get('source')} to map; it has {known}."
                raise SystemDescriptionError(msg)
            scale = transformation(entry, f"{where}, {entry.get('source')} -> {entry.get('target')}")
            suppressed = boolean(entry.get("suppressUnitConversion"))
            yield _Parameter(entry.get("target"), parameter.text, parameter.unit, scale, suppressed)
        used = {entry.get("source") for entry in entries}
        self.notices += [f"{where} does not map {name}, which is ignored." for name in by_name if name not in used]

    def _parameters(self, element: Element, binding: Any) -> Iterator[_Parameter]:
        """Parameters of a binding, with its prefix."""
        values = binding.find(ssd("ParameterValues"))
        holder = binding if values is None else values
        kind = (f"{{{SSV}}}ParameterSet", VALUES, PARAMETER_SET_TYPE)
        root = self._content(element, holder, kind, binding.get("type"))
        units, names = {**self.units, **read_units(root)}, set()
        for parameter in root.iterfind(f"{{{SSV}}}Parameters/{{{SSV}}}Parameter"):
            name = (binding.get("prefix") or "") + parameter.get("name")
            if name in names:
                msg = f"{self.package.path}: the parameter set {root.get('name')} has two parameters {name}."
                raise SystemDescriptionError(msg)
            names.add(name)
            typed = next(child for child in parameter if isinstance(child.tag, str))
            yield _Parameter(name, typed.get("value"), defined(typed.get("unit"), units))

    def _content(self, element: Element, holder: Any, kind: tuple[str, str, str], stated: str | None = None) -> Any:
        """The document that an element has inside or refers to; `kind` is its tag, schema and MIME type."""
        tag, schema, mime = kind
        stated = stated or holder.get("type") or mime
        if stated != mime:
            msg = f"{self.package.path}: parameters of type {stated} are not supported; {mime} is."
            raise SystemDescriptionError(msg)
        inline = holder.find(tag)
        if inline is not None:
            return self.package.validated(inline, f"{tag.rpartition('}')[2]} in SystemStructure.ssd", schema)
        fmu = element.component.description.path if element.component is not None else None
        return self.package.document(holder, schema, fmu)
