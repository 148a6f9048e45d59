"""Geometry in an SSP package: where graphical editors draw components, connectors and connections.

The layout is that of `orchestration.ssp.diagram`. SSP's axis y points up, that of the layout down.
"""

from collections.abc import Sequence

from lxml import etree

from orchestration.ssp.diagram import Box, Diagram, Point
from orchestration.ssp.schema import SSD, Xml

_NOTE = 40.0  # height of the note below the diagram, as the numbers of the layout


def place_component(element: Xml, layout: Diagram, name: str) -> None:
    """Add the geometry of a component to an element ``ssd:Component``, after its connectors."""
    box = layout.boxes[name]
    top, bottom = layout.height - box.y, layout.height - box.y - box.height
    corners = {"x1": box.x, "y1": bottom, "x2": box.x + box.width, "y2": top}
    etree.SubElement(element, f"{{{SSD}}}ElementGeometry", _texts(corners))


def place_connector(connector: Xml, box: Box, name: str) -> None:
    """Add the geometry of a connector: inputs are on the left side of the box, outputs on the right side."""
    side, height = (0.0, box.inputs[name]) if name in box.inputs else (1.0, box.outputs[name])
    place = {"x": side, "y": round(1 - (height - box.y) / box.height, 6)}
    etree.SubElement(connector, f"{{{SSD}}}ConnectorGeometry", _texts(place))


def place_connection(connection: Xml, layout: Diagram, route: Sequence[Point]) -> None:
    """Add the corners of a connection between its connectors."""
    inner = route[1:-1]
    points = {
        "pointsX": " ".join(_text(x) for x, _ in inner),
        "pointsY": " ".join(_text(layout.height - y) for _, y in inner),
    }
    etree.SubElement(connection, f"{{{SSD}}}ConnectionGeometry", points)


def place_system(outer: Xml, layout: Diagram, order: Sequence[str]) -> None:
    """Add the extent of the diagram, and a note that names the order in which the components step."""
    extent = {"x1": 0.0, "y1": -_NOTE, "x2": layout.width, "y2": layout.height}
    etree.SubElement(outer, f"{{{SSD}}}SystemGeometry", _texts(extent))
    graphics = etree.SubElement(outer, f"{{{SSD}}}GraphicalElements")
    text = f"Order of the steps: {', '.join(order)}"
    corners = {"x1": 0.0, "y1": -_NOTE, "x2": layout.width, "y2": 0.0}
    etree.SubElement(graphics, f"{{{SSD}}}Note", {**_texts(corners), "text": text})


def _texts(values: dict[str, float]) -> dict[str, str]:
    return {name: _text(value) for name, value in values.items()}


def _text(value: float) -> str:
    """A coordinate as a text of type xs:double."""
    return repr(value).removesuffix(".0")
