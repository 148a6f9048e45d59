"""Start values of variables from the parameter sets of an SSP package.

A binding connects a parameter set with a component or system. The bindings of a component apply first, then the
bindings of the systems around the component, the outermost system last. A later value replaces an earlier value
(SSP 1.0, 5.3.2). A parameter mapping may give other names to parameters, with a linear transformation. Before
the transformation, a value is converted to the unit of its target.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isnan, nan

from lxml import etree

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import REAL
from orchestration.fmi.names import near, suggestion
from orchestration.fmi.units import AS_IS, Linear, UnitDefinition, conversion, defined
from orchestration.ssp.connectors import Arrival, Element, Home, Wiring
from orchestration.ssp.schema import (
    MAPPING,
    PARAMETER_MAPPING_TYPE,
    PARAMETER_SET_TYPE,
    SSM,
    SSV,
    VALUES,
    Package,
    Xml,
    boolean,
    read_units,
    ssd,
    transformation,
)
from orchestration.ssp.value_maps import mapped_value, value_map

Starts = dict[str, dict[str, float | str]]
"""Start values by component and variable; a text still needs a check by its variable."""


@dataclass(frozen=True)
class _Parameter:
    """A parameter of a set, under its name in the component or system of the binding."""

    name: str
    text: str
    type: str
    unit: UnitDefinition | None
    scale: Linear = AS_IS
    suppressed: bool = False


def start_values(wiring: Wiring) -> tuple[Starts, list[str]]:
    """Read the start values of all components of a package.

    Parameters
    ----------
    wiring
        Connections and elements of the package.

    Returns
    -------
    start
        Start values by component and variable, in the units of the FMUs.
    notices
        Sentences on parameters that have no effect.

    Raises
    ------
    ArchiveError
        If a parameter set or mapping is missing or invalid.
    SystemDescriptionError
        If a component has no such variable, or a unit cannot be converted.
    """
    reading = _Bindings(wiring)
    reading.read(wiring.outer)
    return reading.start, reading.notices


class _Bindings:
    """Reader of all parameter bindings of a package."""

    def __init__(self, wiring: Wiring) -> None:
        self.wiring, self.where = wiring, wiring.where
        self.start: Starts = {}
        self.notices: list[str] = []

    def read(self, element: Element) -> None:
        """Read the bindings of all inner elements, then the bindings of the element itself."""
        for child in element.children.values():
            self.read(child)
        for xml, home in element.bindings:
            for binding in xml.iterfind(ssd("ParameterBindings/ParameterBinding")):
                for parameter in self._mapped(element, binding, home):
                    self._assign(element, parameter)

    def _assign(self, element: Element, parameter: _Parameter) -> None:
        """Set all variables that a parameter reaches."""
        found = False
        for arrival, unit in self._targets(element, parameter.name):
            found = True
            name = arrival.variable
            variable = arrival.component.variable(name)
            value: float | str = parameter.text
            if variable.type == REAL:
                value = self._converted(parameter, unit, arrival, relative=variable.relative)
            elif not (parameter.scale.trivial and arrival.scale.trivial):
                path = f"{arrival.component.name}.{name}"
                msg = f"{self.where}: {path} is of type {variable.type}; only Reals can have a transformation."
                raise SystemDescriptionError(msg)
            self.start.setdefault(arrival.component.name, {})[name] = value
        if not found:
            where, known = ".".join(element.path) or "the system", element.component
            close = near(parameter.name, known.description.variables) if known is not None else []
            meant = f"; did you mean {' or '.join(close)}?" if close else "."
            self.notices.append(
                f"The parameter {parameter.name} of {where} is ignored, because no variable has that name{meant}"
            )

    def _targets(self, element: Element, name: str) -> Iterator[tuple[Arrival, UnitDefinition | None]]:
        """Variables that a parameter sets, each with the unit in which the parameter must be given.

        A name in a component is a variable. A name in a system is a connector, or an element and a name in that
        element, such as ``motor.K``. A name that means nothing is ignored (SSP 1.0, section 5.3.2).
        """
        if element.component is not None:
            if name not in element.component.description.variables:
                return
            unit = self.wiring.unit(element.component, element.path, name)
            yield Arrival(element.component, name, AS_IS), unit
        elif name in element.connectors:
            for arrival in self.wiring.arrivals(element.path, name):
                yield arrival, element.connectors[name][1]
        else:
            for head, child in element.children.items():  # a name of an element may have dots, too
                if name.startswith(f"{head}."):
                    yield from self._targets(child, name.removeprefix(f"{head}."))

    def _converted(
        self, parameter: _Parameter, unit: UnitDefinition | None, arrival: Arrival, *, relative: bool
    ) -> float | str:
        """Value in the unit of the variable; a text that is not a number is returned as it is, for a later error."""
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
            msg = f"{self.where}: {name} is given in {given}, but the unit in the FMU is {has}."
            raise SystemDescriptionError(msg)
        return arrival.scale(parameter.scale(Linear(*found)(value)))

    def _mapped(self, element: Element, binding: Xml, home: Home) -> Iterator[_Parameter]:
        """Parameters of a binding, after its parameter mapping."""
        parameters = list(self._parameters(element, binding, home))
        mapping = binding.find(ssd("ParameterMapping"))
        if mapping is None:
            yield from parameters
            return
        where = f"{self.where}: the parameter mapping of {'.'.join(element.path) or 'the system'}"
        kind = (f"{{{SSM}}}ParameterMapping", MAPPING, PARAMETER_MAPPING_TYPE)
        root = self._content(element, mapping, home.package, kind)
        by_name = {parameter.name: parameter for parameter in parameters}
        entries = list(root.iterfind(f"{{{SSM}}}MappingEntry"))
        for entry in entries:
            parameter = by_name.get(entry.attrib["source"])
            if parameter is None and not entry.attrib["source"]:
                target = entry.get("target")
                self.notices.append(f"{where}: the entry for {target} is ignored, because its source is empty.")
                continue
            if parameter is None:
                source = entry.attrib["source"]
                msg = f"{where} has no parameter {source} to map; {suggestion(source, by_name)}"
                raise SystemDescriptionError(msg)
            line = f"{where}, {entry.get('source')} -> {entry.get('target')}"
            scale = AS_IS if value_map(entry) is not None else transformation(entry, line)
            text = mapped_value(entry, parameter.text, parameter.type, line)
            suppressed = boolean(entry.get("suppressUnitConversion"))
            yield _Parameter(entry.attrib["target"], text, parameter.type, parameter.unit, scale, suppressed)
        used = {entry.get("source") for entry in entries}
        self.notices += [f"{where} does not map {name}, so {name} is ignored." for name in by_name if name not in used]

    def _parameters(self, element: Element, binding: Xml, home: Home) -> Iterator[_Parameter]:
        """Parameters of a binding, with the prefix of the binding before their names."""
        values = binding.find(ssd("ParameterValues"))
        holder = binding if values is None else values
        kind = (f"{{{SSV}}}ParameterSet", VALUES, PARAMETER_SET_TYPE)
        root = self._content(element, holder, home.package, kind, stated=binding.get("type"))
        units, names = {**home.units, **read_units(root)}, set[str]()
        for parameter in root.iterfind(f"{{{SSV}}}Parameters/{{{SSV}}}Parameter"):
            name = (binding.get("prefix") or "") + parameter.attrib["name"]
            if name in names:
                msg = f"{self.where}: the parameter set {root.get('name')} has two parameters {name}."
                raise SystemDescriptionError(msg)
            names.add(name)
            typed = next(child for child in parameter if isinstance(child.tag, str))
            kind = etree.QName(typed).localname
            yield _Parameter(name, typed.attrib["value"], kind, defined(typed.get("unit"), units))

    def _content(
        self, element: Element, holder: Xml, package: Package, kind: tuple[str, str, str], *, stated: str | None = None
    ) -> Xml:
        """Document of a tag, schema and MIME type (`kind`) that an element contains or refers to."""
        tag, schema, mime = kind
        stated = stated or holder.get("type") or mime
        if stated != mime:
            msg = f"{self.where}: parameters of type {stated} are not supported; use {mime}."
            raise SystemDescriptionError(msg)
        inline = holder.find(tag)
        if inline is not None:
            return package.validated(inline, f"{tag.rpartition('}')[2]} in SystemStructure.ssd", schema)
        fmu = element.component.description.path if element.component is not None else None
        return package.document(holder, schema, fmu)
