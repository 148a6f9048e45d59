"""Tests of the layout of a system: no box on a box, no line through a box, no two signals on one line."""

import zipfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from orchestration import System, scenario
from orchestration.ssp.diagram import Diagram, Point, diagram
from orchestration.system.component import Connection

SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"


@pytest.fixture(scope="module")
def fig5() -> System:
    return scenario("fig5")


def tangled(fig5: System, n: int, seed: int) -> System:
    """Components in a random net, with links to themselves, back, and across several columns."""
    rng = np.random.default_rng(seed)
    components = tuple(replace(fig5["actuator"], name=f"component_{i}") for i in range(n))
    driven = [(i, k) for i in range(n) for k in (1, 2)]
    connections = tuple(
        Connection(f"component_{rng.integers(n)}", f"tau[{k}]", f"component_{i}", f"tau_cmd[{k}]") for i, k in driven
    )
    return System("tangled", components, connections)


@pytest.fixture(params=["fig5", "one", "pair", *(f"tangle {seed}" for seed in range(6))])
def system(request: pytest.FixtureRequest, fig5: System) -> System:
    """The paper's loop, and nets that nobody has drawn."""
    if request.param == "fig5":
        return fig5
    if request.param.startswith("tangle"):
        return tangled(fig5, 12, int(request.param[-1]))
    return tangled(fig5, {"one": 1, "pair": 2}[request.param], 0)


def segments(layout: Diagram) -> Iterator[tuple[int, Point, Point]]:
    """Straight parts of all routes, with the number of the route."""
    for number, route in enumerate(layout.routes):
        for begin, end in pairwise(route):
            yield number, begin, end


def test_boxes_lie_apart_and_in_the_picture(system: System) -> None:
    layout = diagram(system)
    for a, b in combinations(layout.boxes.values(), 2):
        assert a.x + a.width < b.x or b.x + b.width < a.x or a.y + a.height < b.y or b.y + b.height < a.y
    for box in layout.boxes.values():
        assert 0 < box.x < box.x + box.width < layout.width
        assert 0 < box.y < box.y + box.height < layout.height
        assert all(box.y < height < box.y + box.height for height in (*box.inputs.values(), *box.outputs.values()))
    points = [point for route in layout.routes for point in route]
    assert all(0 < x < layout.width and 0 < y < layout.height for x, y in points)


def test_routes_lead_from_connector_to_connector_at_right_angles(system: System) -> None:
    layout = diagram(system)
    for connection, route in zip(system.connections, layout.routes, strict=True):
        source, target = layout.boxes[connection.source], layout.boxes[connection.target]
        assert route[0] == (source.x + source.width, source.outputs[connection.output])
        assert route[-1] == (target.x, target.inputs[connection.input])
        assert all((x0 == x1) != (y0 == y1) for (x0, y0), (x1, y1) in pairwise(route))


def test_no_line_crosses_a_box(system: System) -> None:
    layout = diagram(system)
    for _, (x0, y0), (x1, y1) in segments(layout):
        for box in layout.boxes.values():
            beside = max(x0, x1) <= box.x or min(x0, x1) >= box.x + box.width
            assert beside or max(y0, y1) < box.y or min(y0, y1) > box.y + box.height


def test_only_lines_between_the_same_components_share_a_way(system: System) -> None:
    """Two outputs of one component may leave together, since they are told apart at the box."""
    layout = diagram(system)
    for (a, *first), (b, *second) in combinations(segments(layout), 2):
        one, other = system.connections[a], system.connections[b]
        if one.source == other.source and (one.output == other.output or one.target == other.target):
            continue
        for along, across in ((0, 1), (1, 0)):
            if first[0][across] == first[1][across] == second[0][across] == second[1][across]:
                spans = [sorted(point[along] for point in part) for part in (first, second)]
                assert min(spans[0][1], spans[1][1]) <= max(spans[0][0], spans[1][0]), (one, other)


def test_loop_runs_from_left_to_right(fig5: System) -> None:
    boxes = diagram(fig5).boxes
    columns = [boxes[name].x for name in ("trajectory", "controller", "actuator", "plant")]
    assert columns == sorted(set(columns))


def part(element: etree._Element, name: str) -> etree._Element:
    """The child of a name, which must be there."""
    child = element.find(f"{SSD}{name}")
    assert child is not None, name
    return child


def test_package_holds_the_layout(fig5: System, tmp_path: Path) -> None:
    """Connector and connection, read back by the standard's rules, meet: y points up, connectors are relative."""
    layout = diagram(fig5)
    with zipfile.ZipFile(fig5.write(tmp_path / "fig5.ssp")) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    ends: dict[tuple[str, str], Point] = {}
    for component in root.iter(f"{SSD}Component"):
        place = part(component, "ElementGeometry")
        x1, y1, x2, y2 = (float(place.attrib[name]) for name in ("x1", "y1", "x2", "y2"))
        assert x1 < x2
        assert y1 < y2, "nothing is mirrored"
        for connector in component.iter(f"{SSD}Connector"):
            at = part(connector, "ConnectorGeometry")
            x, y = (float(at.attrib[axis]) for axis in "xy")
            assert x == (0 if connector.attrib["kind"] == "input" else 1)
            ends[component.attrib["name"], connector.attrib["name"]] = (x1 + x * (x2 - x1), y1 + y * (y2 - y1))
    connections = list(root.iter(f"{SSD}Connection"))
    assert len(connections) == len(layout.routes)
    for connection, route in zip(connections, layout.routes, strict=True):
        place = part(connection, "ConnectionGeometry")
        xs, ys = ([float(text) for text in place.attrib[f"points{axis}"].split()] for axis in "XY")
        begin = ends[connection.attrib["startElement"], connection.attrib["startConnector"]]
        end = ends[connection.attrib["endElement"], connection.attrib["endConnector"]]
        # Connectors are written to a millionth of the box's height, which is below 400.
        assert begin[1] == pytest.approx(ys[0], abs=4e-4)
        assert end[1] == pytest.approx(ys[-1], abs=4e-4)
        assert xs == [x for x, _ in route[1:-1]]
    note = next(root.iter(f"{SSD}Note"))
    assert "trajectory, sensor, controller, actuator, plant" in note.attrib["text"]
