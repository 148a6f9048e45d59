"""Connections of an SSP package, followed through the connectors of its systems.

Values go from what gives one (an output of a component or of an inner system, an input of the system
itself) to what takes one. SSP 1.0 lets a connection be written from either end.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.units import AS_IS, Linear, UnitDefinition, conversion
from orchestration.ssp.schema import boolean, ssd, transformation
from orchestration.system.component import Component, Connection

Place = tuple[tuple[str, ...], str]  # path of a component or system, and the connector
_INWARD, _OUTWARD = ("input", "parameter"), ("output", "calculatedParameter")


@dataclass
class Element:
    """A component, or a system with what is in it.

    Attributes
    ----------
    connectors
        Kind and unit by name.
    """

    path: tuple[str, ...]
    xml: Any
    component: Component | None
    connectors: dict[str, tuple[str, UnitDefinition | None]]
    children: dict[str, "Element"] = field(default_factory=dict)

    def walk(self) -> Iterator["Element"]:
        """All elements, the outer before the inner."""
        yield self
        for child in self.children.values():
            yield from child.walk()


@dataclass(frozen=True)
class _Wire:
    """From a place that gives a value to one that takes it."""

    start: Place
    end: Place
    scale: Linear
    suppressed: bool

    def __str__(self) -> str:
        return f"{_text(self.start)} -> {_text(self.end)}"


@dataclass(frozen=True)
class Arrival:
    """Where a value arrives, and what happened to it on the way."""

    component: Component
    variable: str
    scale: Linear


class Wiring:
    """All connections of a package.

    Parameters
    ----------
    where
        The package, for messages.
    outer
        The outermost system.
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

    def connections(self) -> Iterator[Connection]:
        """Connections between components, in the order of the file."""
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
        """Where a value that is given to a connector of a system arrives; nowhere if it is an output."""
        if self._elements[path].connectors[connector][0] in _OUTWARD:
            return []
        return list(self._onward((path, connector), AS_IS, self._unit((path, connector)), ()))

    def unit(self, component: Component, path: tuple[str, ...], variable: str) -> UnitDefinition | None:
        """The unit of a component's variable: the FMU's, or its connector's if that says more."""
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
                f"{self.where}: the connector {'.'.join(path)}.{variable} has unit {drawn.name}, the variable"
                f" of the FMU {declared.name}, which is defined otherwise."
            )
            raise SystemDescriptionError(msg)
        return declared

    def undriven(self) -> list[str]:
        """Notices of inputs that nothing but the outermost system's own connectors could drive."""
        notices = []
        for wire in self._wires:
            path, connector = wire.start
            if path == () and self.outer.connectors[connector][0] != "parameter":
                ends = self._along(wire, AS_IS, self._unit(wire.start), ())
                names = ", ".join(f"{end.component.name}.{end.variable}" for end in ends)
                if names:
                    notices.append(
                        f"Nothing drives the connector {connector} of the system: {names} as if unconnected."
                    )
        return notices

    def _along(
        self, wire: _Wire, scale: Linear, unit: UnitDefinition | None, trail: tuple[Place, ...]
    ) -> Iterator[Arrival]:
        """Where a value arrives that sets out on a wire in a unit."""
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
        if place in trail:
            circle = " -> ".join(_text(p) for p in (*trail[trail.index(place) :], place))
            msg = f"{self.where}: connectors are connected in a circle without a component: {circle}."
            raise SystemDescriptionError(msg)
        for wire in self._wires:
            if wire.start == place:
                yield from self._along(wire, scale, unit, (*trail, place))

    def _unit(self, place: Place) -> UnitDefinition | None:
        path, name = place
        component = self._elements[path].component
        if component is not None:
            return self.unit(component, path, name)
        return self._elements[path].connectors[name][1]

    def _relative(self, wire: _Wire) -> bool:
        ends = [(self._elements[path].component, name) for path, name in (wire.start, wire.end)]
        return any(component.variable(name).relative for component, name in ends if component is not None)

    def _wire(self, system: Element, xml: Any) -> _Wire:
        """A connection, in the direction of the value."""
        places, gives = [], []
        for end in ("start", "end"):
            place, giving = self._end(system, xml.get(f"{end}Element"), xml.get(f"{end}Connector"))
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
        return _Wire(*places, transformation(xml, where), boolean(xml.get("suppressUnitConversion")))

    def _end(self, system: Element, name: str | None, connector: str) -> tuple[Place, bool | None]:
        """The place of a connection's end, and whether it gives a value; None if it may do either."""
        element = system if name is None else system.children.get(name)
        if element is None:
            known = _names(system.children)
            msg = f"{self.where}: system {system.xml.get('name')} has no component {name}; it has {known}."
            raise SystemDescriptionError(msg)
        place = (element.path, connector)
        if element.component is not None:
            return place, element.component.variable(connector).causality in _OUTWARD
        if connector not in element.connectors:
            msg = (
                f"{self.where}: system {element.xml.get('name')} has no connector {connector};"
                f" it has {_names(element.connectors)}."
            )
            raise SystemDescriptionError(msg)
        kind = element.connectors[connector][0]
        if kind not in (*_INWARD, *_OUTWARD):
            return place, None
        return place, (kind in _INWARD) == (element is system)


def _text(place: Place) -> str:
    return ".".join((*place[0], place[1]))


def _names(known: dict[str, Any]) -> str:
    return ", ".join(known) or "none"
