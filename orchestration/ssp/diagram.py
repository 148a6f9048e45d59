"""Layout of a coupled system as a block diagram: boxes from left to right, connections as lines at right angles.

The layout is a pure function of names and connections. Components stand in columns in the order of the system, each to
the right of those before it that feed it. Inputs are on the left side of a box, outputs on the right side. A connection
to the next column runs through the gap between the columns. Every other connection runs below all boxes. All
connections from one component to another share one way, which no other connection runs on, so no line crosses a box and
lines of different components meet at right angles only.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from orchestration.system.component import Connection
from orchestration.system.system import System

PITCH = 12.0
"""Distance between connectors, and between neighbouring lines."""
_MARGIN, _WIDTH, _ROW_GAP = 24.0, 140.0, 48.0
_HEAD = 30.0  # part of a box above its first connector, where the name stands
_LETTER = 8.0  # width of a letter of a component's name

Point = tuple[float, float]
Port = tuple[str, str]
"""A component and a variable."""


@dataclass(frozen=True)
class Box:
    """A component in the diagram: its top left corner, its size, and its connectors.

    Attributes
    ----------
    x, y, width, height
        Place in pixels from the top left of the diagram.
    inputs, outputs
        Heights of the connectors, pixels from the top of the diagram, by variable.
    """

    x: float
    y: float
    width: float
    height: float
    inputs: Mapping[str, float]
    outputs: Mapping[str, float]


@dataclass(frozen=True)
class Diagram:
    """A block diagram.

    Attributes
    ----------
    width, height
        Size, pixels.
    boxes
        One box for each component, by name.
    routes
        Corners of the line of each connection with both ends, in the order of the system's connections; pixels from
        the top left.
    """

    width: float
    height: float
    boxes: Mapping[str, Box]
    routes: Sequence[Sequence[Point]]


def diagram(system: System) -> Diagram:
    """Lay out a system.

    Examples
    --------
    >>> from orchestration import scenario
    >>> from orchestration.ssp.diagram import diagram
    >>> layout = diagram(scenario("fig2"))
    >>> layout.boxes["controller"].x < layout.boxes["plant"].x
    True
    """
    names = [component.name for component in system.components]
    columns = _columns(names, system.connections)
    ways = _ways(columns, system.connections)
    lanes = _lanes(columns, ways)
    boxes, floor = _boxes(system, columns, lanes)
    routes = [_route(connection, boxes, columns, (lanes, floor)) for connection in system.connections]
    below = sum(1 for way in ways if not _adjacent(columns, way))
    right = max((box.x + box.width for box in boxes.values()), default=0.0)
    ends = max((x for route in routes for x, _ in route), default=0.0)
    return Diagram(max(right, ends) + _MARGIN, floor + below * PITCH + _MARGIN, boxes, routes)


def _columns(names: Sequence[str], connections: Sequence[Connection]) -> dict[str, int]:
    """Column of each component: right of all components before it in the system that feed it."""
    place = {name: i for i, name in enumerate(names)}
    column = dict.fromkeys(names, 0)
    for name in names:
        feeding = [c.source for c in connections if c.target == name and place[c.source] < place[name]]
        column[name] = max((column[source] + 1 for source in feeding), default=0)
    return column


def _ways(columns: Mapping[str, int], connections: Sequence[Connection]) -> list[tuple[str, str]]:
    """Pairs of components that are connected, the nearest first, each once."""
    pairs = dict.fromkeys((c.source, c.target) for c in connections)
    return sorted(pairs, key=lambda pair: abs(columns[pair[1]] - columns[pair[0]] - 1))


def _adjacent(columns: Mapping[str, int], way: tuple[str, str]) -> bool:
    """Whether a way leads from a column to the next one."""
    return columns[way[1]] == columns[way[0]] + 1


@dataclass(frozen=True)
class _Lanes:
    """Numbers of the vertical lanes in the gaps between columns, and of the tracks below the boxes.

    Attributes
    ----------
    leaving, arriving
        Lane of each way in the gap on the right of its source, and on the left of its target.
    tracks
        Track of each way that runs below the boxes.
    counts
        Number of lanes in the gap on the left of each column, and on the right of the last one.
    """

    leaving: Mapping[tuple[str, str], int]
    arriving: Mapping[tuple[str, str], int]
    tracks: Mapping[tuple[str, str], int]
    counts: Sequence[int]


def _lanes(columns: Mapping[str, int], ways: Sequence[tuple[str, str]]) -> _Lanes:
    """Give each way lanes and a track of its own."""
    counts = [0] * (max(columns.values(), default=-1) + 2)
    leaving, arriving, tracks = {}, {}, {}
    far = [way for way in ways if not _adjacent(columns, way)]
    for way in [*far, *(way for way in ways if _adjacent(columns, way))]:
        gap = columns[way[0]] + 1
        leaving[way] = counts[gap]
        counts[gap] += 1
        if _adjacent(columns, way):
            arriving[way] = leaving[way]
        else:
            tracks[way] = len(tracks)
    for way in far:
        gap = columns[way[1]]
        arriving[way] = counts[gap]
        counts[gap] += 1
    return _Lanes(leaving, arriving, tracks, counts)


def _boxes(system: System, columns: Mapping[str, int], lanes: _Lanes) -> tuple[dict[str, Box], float]:
    """Boxes by name, and the height below which no box is."""
    lefts, widths = [], []
    x = _MARGIN
    for column, lanes_before in enumerate(lanes.counts[:-1]):
        x += (lanes_before + 1) * PITCH + (PITCH if column else 0)
        members = [name for name, c in columns.items() if c == column]
        widths.append(max(_WIDTH, *(_LETTER * len(name) + 2 * PITCH for name in members)))
        lefts.append(x)
        x += widths[-1]
    shapes = {name: _connectors(system, name) for name in columns}
    heights = {name: _height(*shape) for name, shape in shapes.items()}
    total = [sum(heights[n] + _ROW_GAP for n, c in columns.items() if c == i) - _ROW_GAP for i in range(len(lefts))]
    tallest = max(total, default=0.0)
    # Columns are centred, on the grid of the connectors, so that no two lines come to lie on each other.
    tops = [_MARGIN + PITCH * round((tallest - height) / 2 / PITCH) for height in total]
    boxes = {}
    for name, column in columns.items():
        y, (inputs, outputs) = tops[column], shapes[name]
        boxes[name] = Box(
            *(lefts[column], y, widths[column], heights[name]),
            {variable: y + _HEAD + PITCH * i for i, variable in enumerate(inputs)},
            {variable: y + _HEAD + PITCH * (i + 0.5) for i, variable in enumerate(outputs)},
        )
        tops[column] += heights[name] + _ROW_GAP
    return boxes, _MARGIN + tallest + PITCH


def _connectors(system: System, name: str) -> tuple[list[str], list[str]]:
    """Connected inputs and outputs of a component, in the order of the connections; the FMU's own order is not kept."""
    inputs = dict.fromkeys(c.input for c in system.connections if c.target == name)
    outputs = dict.fromkeys(c.output for c in system.connections if c.source == name)
    return list(inputs), list(outputs)


def _height(inputs: Sequence[str], outputs: Sequence[str]) -> float:
    """Height of a box, a whole number of pitches."""
    return PITCH * (3 + max(len(inputs), len(outputs), 1))


def _route(
    connection: Connection, boxes: Mapping[str, Box], columns: Mapping[str, int], ways: tuple[_Lanes, float]
) -> list[Point]:
    """Corners of a connection, from connector to connector."""
    (lanes, floor), way = ways, (connection.source, connection.target)
    source, target = boxes[connection.source], boxes[connection.target]
    begin = (source.x + source.width, source.outputs[connection.output])
    end = (target.x, target.inputs[connection.input])
    right = _right_of(boxes, columns, columns[connection.source])
    leaving = right + PITCH * (lanes.leaving[way] + 1)
    if way not in lanes.tracks:
        return [begin, (leaving, begin[1]), (leaving, end[1]), end]
    gap = columns[connection.target]
    arriving = target.x - PITCH * (lanes.counts[gap] - lanes.arriving[way] + 1)
    track = floor + PITCH * lanes.tracks[way]
    return [begin, (leaving, begin[1]), (leaving, track), (arriving, track), (arriving, end[1]), end]


def _right_of(boxes: Mapping[str, Box], columns: Mapping[str, int], column: int) -> float:
    """Right side of the boxes of a column."""
    return max(box.x + box.width for name, box in boxes.items() if columns[name] == column)
