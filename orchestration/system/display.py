"""How systems look: one line of text, and for notebooks tables with a drawing of the loop."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from orchestration.errors import printable
from orchestration.fmi.display import escaped, html_table, listed, variables_html
from orchestration.fmi.names import base_name

if TYPE_CHECKING:
    from orchestration.system.component import Component, Connection
    from orchestration.system.system import System

WIDTH, HEIGHT, GAP, MARGIN = 124, 44, 76, 16  # px of a box, between boxes, around the drawing
RISE, LIFT = 26, 15  # px by which a curve rises for each box that it passes, and more for each further curve
MOST_IN_DRAWING = 12
MOST_LABEL = 26  # characters
HEAD = (
    '<defs><marker id="tip" markerWidth="8" markerHeight="8" refX="7" refY="3" orient="auto">'
    '<path d="M0,0 L7,3 L0,6 z" fill="currentColor"/></marker></defs>'
)


def component_line(component: "Component") -> str:
    """A component in one line: its name, its FMU, its numbers of inputs and outputs, start values that differ."""
    description = component.description
    counts = ", ".join(f"{len(description.of_causality(kind))} {kind}s" for kind in ("input", "output"))
    start = [
        f"{name} = {value!r}" if isinstance(value, str) else f"{name} = {value:g}"
        for name, value in component.start.items()
    ]
    given = f", {listed(start)}" if start else ""
    return printable(f"<Component {component.name}: {description.model_name}, {counts}{given}>")


def component_html(component: "Component") -> str:
    """The variables of a component with unit, causality, and the start value that is in force."""
    head = f"<b>{escaped(component.name)}</b>: {escaped(component.description.model_name)}, {_sampling(component)}"
    return f"<div><p>{head}</p>{variables_html(component.description.variables, component.start)}</div>"


def system_line(system: "System") -> str:
    """A system in one line: its components with their models, and the number of connections."""
    names = [f"{c.name}: {c.description.model_name}" for c in system.components]
    times = [
        f"{what} {value:g} s"
        for what, value in (("step", system.step), ("stop time", system.stop_time))
        if value is not None
    ]
    given = f", {', '.join(times)}" if times else ""
    counts = f"{len(names)} components ({listed(names, 6)}), {len(system.connections)} connections"
    return printable(f"<System {system.name}: {counts}{given}>")


def system_html(system: "System") -> str:
    """A drawing of the loop, and tables of components, start values that differ from the FMUs' own, connections."""
    components = [(c.name, c.description.model_name, _sampling(c)) for c in system.components]
    start = [
        (f"{c.name}.{name}", value, c.variable(name).unit, "" if (own := c.variable(name).start) is None else own)
        for c in system.components
        for name, value in c.start.items()
        if value != c.variable(name).start
    ]
    parts = [
        f"<p><b>System {escaped(system.name)}</b></p>",
        system_svg(system.components, system.connections),
        html_table(("component", "model", "sampling"), components),
        html_table(("start value", "value", "unit", "FMU's own"), start) if start else "",
        html_table(("connections", "signals"), _grouped(system.connections)),
    ]
    return f"<div>{''.join(parts)}</div>"


def system_svg(components: "Sequence[Component]", connections: "Sequence[Connection]") -> str:
    """The loop as an SVG drawing: boxes in the order of stepping, an arrow for each pair that is connected.

    Arrows forwards run above the boxes, arrows backwards below. A system of more components than fit is not drawn.
    """
    if len(components) > MOST_IN_DRAWING:
        return ""
    places = {component.name: i for i, component in enumerate(components)}
    pairs = _pairs(connections)
    heights = [_rise(places[target] - places[source]) for source, target in pairs]
    above = max((h for h in heights if h > 0), default=0) + LIFT
    below = max((-h for h in heights if h < 0), default=0) + LIFT
    width = 2 * MARGIN + len(components) * (WIDTH + GAP) - GAP
    top = MARGIN + above
    parts = [HEAD, *(_box(component, MARGIN + i * (WIDTH + GAP), top) for i, component in enumerate(components))]
    for (source, target), names in pairs.items():
        parts.append(_arrow((places[source], places[target]), names, top))
    height = top + HEIGHT + below + MARGIN
    size = f'width="{width}" height="{height}" viewBox="0 0 {width} {height}"'  # so that a narrow page can shrink it
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif">{"".join(parts)}</svg>'


def _box(component: "Component", x: float, y: float) -> str:
    middle = x + WIDTH / 2
    name, model = escaped(component.name[:16]), escaped(component.description.model_name[:24])
    return (
        f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="5" fill="#e8eef7" stroke="#8796a8"/>'
        f'<text x="{middle}" y="{y + 18}" text-anchor="middle" font-size="13" fill="#1d2733">{name}</text>'
        f'<text x="{middle}" y="{y + 34}" text-anchor="middle" font-size="9" fill="#55606e">{model}</text>'
    )


def _arrow(ends: tuple[int, int], names: Sequence[str], top: float) -> str:
    source, target = ends
    forwards, rise = target > source, _rise(target - source)
    label = ", ".join(names)
    label = label if len(label) <= MOST_LABEL else f"{label[: MOST_LABEL - 1]}…"
    if target == source + 1:
        x, y = MARGIN + source * (WIDTH + GAP) + WIDTH, top + HEIGHT / 2
        path, middle, text = f"M{x},{y} L{x + GAP},{y}", x + GAP / 2, y - 5
        label = label if len(label) <= GAP // 6 else f"{label[: GAP // 6 - 1]}…"
    else:
        y = top if forwards else top + HEIGHT
        shift = 12 if forwards else -12
        x1, x2 = (MARGIN + place * (WIDTH + GAP) + WIDTH / 2 for place in (source, target))
        x1, x2 = x1 + shift, x2 - shift
        path, middle, text = f"M{x1},{y} C{x1},{y - 1.3 * rise} {x2},{y - 1.3 * rise} {x2},{y}", (x1 + x2) / 2, y - rise
        text += -3 if forwards else 11
    return (
        f'<path d="{path}" fill="none" stroke="currentColor" opacity="0.7" marker-end="url(#tip)"/>'
        f'<text x="{middle}" y="{text}" text-anchor="middle" font-size="10" fill="currentColor">{escaped(label)}</text>'
    )


def _rise(distance: int) -> float:
    """Height of a curve over the boxes in px; negative below them."""
    return 0.0 if distance == 1 else RISE * (distance - 1) if distance > 1 else RISE * (min(distance, -1))


def _pairs(connections: "Sequence[Connection]") -> Mapping[tuple[str, str], list[str]]:
    """Names of the signals between two components, arrays once."""
    found: dict[tuple[str, str], dict[str, None]] = {}
    for connection in connections:
        found.setdefault((connection.source, connection.target), {})[base_name(connection.output)] = None
    return {pair: list(names) for pair, names in found.items()}


def _grouped(connections: "Sequence[Connection]") -> list[tuple[str, str]]:
    return [(f"{source} -> {target}", ", ".join(names)) for (source, target), names in _pairs(connections).items()]


def _sampling(component: "Component") -> str:
    period = component.sample_time
    return "continuous" if component.continuous else "sampled" if period is None else f"every {period:g} s"
