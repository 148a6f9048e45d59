"""Connections between components of an SSP package, through the connectors of nested systems.

A value goes from a source to a target. Sources are the outputs of components and of inner systems, and the inputs
of the surrounding system. All other connectors are targets. SSP 1.0 allows a connection to be written in either
direction.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.fmi.units import AS_IS, Linear, UnitDefinition, conversion
from orchestration.ssp.schema import Package, Xml, boolean, ssd, transformation
from orchestration.ssp.value_maps import is_identity
from orchestration.system.component import Component, Connection

Place = tuple[tuple[str, ...], str]
"""Path of a component or system, and the name of a connector there."""

_INWARD, _OUTWARD = ("input", "parameter"), ("output", "calculatedParameter")


@dataclass(frozen=True)
class Home:
    """The package that describes an element, and the units that its .ssd file defines, by name."""

    package: Package
    units: dict[str, UnitDefinition]


@dataclass
class Element:
    """A component of a package, or a system with its inner elements.

    Attributes
    ----------
    path
        Names from the outermost system to the element.
    xml
        XML element.
    component
        Component of the flat system; None if the element is a system.
    connectors
        Kind and unit of each connector, by name.
    bindings
        XML elements with the parameter bindings, in the order in which they apply, and where these are described.
    children
        Inner elements, by name.
    """

    path: tuple[str, ...]
    xml: Xml
    component: Component | None
    connectors: dict[str, tuple[str, UnitDefinition | None]]
    bindings: list[tuple[Xml, Home]]
    children: dict[str, "Element"] = field(default_factory=dict)

    def walk(self) -> Iterator["Element"]:
        """Iterate over the element and all inner elements, from outside inwards."""
        yield self
        for child in self.children.values():
            yield from child.walk()


@dataclass(frozen=True)
class _Wire:
    """A connection in the direction of the value."""

    start: Place
    end: Place
    scale: Linear
    suppressed: bool

    def __str__(self) -> str:
        """Both ends as text with dots, for messages."""
        return f"{_text(self.start)} -> {_text(self.end)}"


@dataclass(frozen=True)
class Arrival:
    """The variable of a component at the end of a chain of connections.

    Attributes
    ----------
    component, variable
        Component and name of the variable.
    scale
        Linear function from the start of the chain to the variable.
    """

    component: Component
    variable: str
    scale: Linear


class Wiring:
    """All connections of a package.

    Parameters
    ----------
    where
        Path of the package, for messages.
    outer
        Outermost system.

    Raises
    ------
    SystemDescriptionError
        If an end of a connection does not exist, or both ends give or take a value.
    """

    def __init__(self, where: str, outer: Element) -> None:
        self.where, self.outer = where, outer
        self._elements = {element.path: element for element in outer.walk()}
        self._wires = [
            self._wire(element, xml)
            for element in outer.walk()
            if element.component is None
            for xml in element.xml.iterfind(ssd("Connections/Connection"))
        ]
        self._starting: dict[Place, list[_Wire]] = {}
        for wire in self._wires:
            self._starting.setdefault(wire.start, []).append(wire)

    def connections(self) -> Iterator[Connection]:
        """Iterate over the connections between components, in the order of the file.

        Raises
        ------
        SystemDescriptionError
            If units of a connection have different dimensions, or connectors form a circle.
        """
        for wire in self._wires:
            source = self._elements[wire.start[0]].component
            if source is not None:
                source.variable(wire.start[1])
                for end in self._along(wire, AS_IS, self._unit(wire.start), ()):
                    scale = end.scale
                    yield Connection(
                        source.name, wire.start[1], end.component.name, end.variable, scale.factor, scale.offset
                    )

    def arrivals(self, path: tuple[str, ...], connector: str) -> list[Arrival]:
        """Return the variables that a value at a connector of a system reaches; an output reaches none."""
        if self._elements[path].connectors[connector][0] in _OUTWARD:
            return []
        return list(self._onward((path, connector), AS_IS, self._unit((path, connector)), ()))

    def unit(self, component: Component, path: tuple[str, ...], variable: str) -> UnitDefinition | None:
        """Return the unit of a variable: the unit of the FMU, or of the connector if the FMU gives no definition.

        Raises
        ------
        SystemDescriptionError
            If FMU and connector give different units.
        """
        declared = component.description.unit(component.variable(variable))
        drawn = self._elements[path].connectors.get(variable, ("", None))[1]
        if drawn is None or declared == drawn:
            return declared
        if declared is None or declared.meaning is None:
            return drawn
        if drawn.meaning is None and drawn.name == declared.name:
            return declared
        if not drawn.equivalent(declared):
            msg = (
                f"{self.where}: the connector {'.'.join(path)}.{variable} has unit {drawn.name}, but the"
                f" variable of the FMU has unit {declared.name}, which has another definition."
            )
            raise SystemDescriptionError(msg)
        return declared

    def undriven(self) -> list[str]:
        """Return notices of inputs that only a connector of the outermost system could drive."""
        notices = []
        for wire in self._wires:
            path, connector = wire.start
            if path == () and self.outer.connectors[connector][0] != "parameter":
                ends = self._along(wire, AS_IS, self._unit(wire.start), ())
                names = ", ".join(f"{end.component.name}.{end.variable}" for end in ends)
                if names:
                    what = f"Nothing drives the connector {connector} of the system"
                    notices.append(f"{what}, so these inputs are unconnected: {names}.")
        return notices

    def _along(
        self, wire: _Wire, scale: Linear, unit: UnitDefinition | None, trail: tuple[Place, ...]
    ) -> Iterator[Arrival]:
        """Variables that a value reaches over a connection; the value starts with a scale and a unit."""
        there = self._unit(wire.end)
        converted = (1.0, 0.0) if wire.suppressed else conversion(unit, there, relative=self._relative(wire))
        if converted is None:
            msg = f"Connection {wire}: units {unit and unit.name} and {there and there.name} differ."
            raise SystemDescriptionError(msg)
        scale = scale.then(Linear(*converted)).then(wire.scale)
        carried = there if there is not None or wire.suppressed else unit
        path, connector = wire.end
        component = self._elements[path].component
        if component is not None:
            yield Arrival(component, connector, scale)
        else:
            yield from self._onward(wire.end, scale, carried, trail)

    def _onward(
        self, place: Place, scale: Linear, unit: UnitDefinition | None, trail: tuple[Place, ...]
    ) -> Iterator[Arrival]:
        """Variables that a value reaches from a connector of a system; `trail` are all connectors before."""
        if place in trail:
            circle = " -> ".join(_text(p) for p in (*trail[trail.index(place) :], place))
            msg = f"{self.where}: connectors are connected in a circle without a component: {circle}."
            raise SystemDescriptionError(msg)
        for wire in self._starting.get(place, ()):
            yield from self._along(wire, scale, unit, (*trail, place))

    def _unit(self, place: Place) -> UnitDefinition | None:
        """Unit of a connector; None if there is no unit."""
        path, name = place
        component = self._elements[path].component
        if component is not None:
            return self.unit(component, path, name)
        return self._elements[path].connectors[name][1]

    def _relative(self, wire: _Wire) -> bool:
        """Whether the value is a difference, so that offsets of units do not apply."""
        ends = [(self._elements[path].component, name) for path, name in (wire.start, wire.end)]
        return any(component.variable(name).relative for component, name in ends if component is not None)

    def _wire(self, system: Element, xml: Xml) -> _Wire:
        """Read a connection, and turn it into the direction of the value."""
        places, gives = [], []
        for end in ("start", "end"):
            place, giving = self._end(system, xml.get(f"{end}Element"), xml.attrib[f"{end}Connector"])
            places.append(place)
            gives.append(giving)
        where = f"{self.where}: connection {_text(places[0])} -> {_text(places[1])}"
        if gives == [False, True]:
            places.reverse()
        elif gives[0] is not None and gives[0] == gives[1]:
            components = [self._elements[path].component for path, _ in places]
            if None in components:
                both = "give" if gives[0] else "take"
                msg = f"{where}: both ends {both} a value."
                raise SystemDescriptionError(msg)
        scale = AS_IS if is_identity(xml) else transformation(xml, where)
        return _Wire(places[0], places[1], scale, boolean(xml.get("suppressUnitConversion")))

    def _end(self, system: Element, name: str | None, connector: str) -> tuple[Place, bool | None]:
        """Connector at an end of a connection, and whether the connector gives a value; None if both are possible."""
        element = system.children.get(name) if name else system
        if element is None:
            help_ = suggestion(str(name), system.children)
            msg = f"{self.where}: system {system.xml.get('name')} has no component {name}; {help_}"
            raise SystemDescriptionError(msg)
        place = (element.path, connector)
        if element.component is not None:
            return place, element.component.variable(connector).causality in _OUTWARD
        if connector not in element.connectors:
            msg = (
                f"{self.where}: system {element.xml.get('name')} has no connector {connector};"
                f" {suggestion(connector, element.connectors)}"
            )
            raise SystemDescriptionError(msg)
        kind = element.connectors[connector][0]
        if kind not in (*_INWARD, *_OUTWARD):
            return place, None
        return place, (kind in _INWARD) == (element is system)


def _text(place: Place) -> str:
    """Connector as text with dots, for messages."""
    return ".".join((*place[0], place[1]))
