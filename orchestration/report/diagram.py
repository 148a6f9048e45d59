"""Draws a system as SVG: boxes from top to bottom in the order of stepping, and an arrow for each pair connected.

Arrows downwards run on the right, arrows upwards on the left. An arrow bears a number, which a table explains. A dashed
arrow carries the value of the step before.
"""

from collections.abc import Sequence

from markupsafe import Markup

from orchestration.fmi.display import escaped
from orchestration.report.markup import marked, table
from orchestration.report.origin import Link, Origin

WIDTH, HEIGHT, GAP = 168, 46, 30  # units of a box, and between boxes
LANE, MARGIN = 17, 12  # units between arrows, and at the edge
MOST_BOXES = 30
MOST_LETTERS = 22
DELAYS = {True: "one step", False: "none", None: "iterated or not known"}


def diagram(origin: Origin) -> Markup:
    """The drawing with its table; only the table for a system of very many components."""
    models = {component["name"]: component["model"] for component in origin.components}
    rows = [
        (str(number), link.source, link.target, ", ".join(link.signals), DELAYS[link.delayed])
        for number, link in enumerate(origin.links, 1)
    ]
    explained = table(("arrow", "from", "to", "signals", "delay"), rows)
    if not 0 < len(origin.order) <= MOST_BOXES:
        return explained
    return marked(f'<div class="diagram">{_svg(origin.order, models, origin.links)}</div>') + explained


def _svg(order: Sequence[str], models: dict[str, str], links: Sequence[Link]) -> str:
    places = {name: place for place, name in enumerate(order)}
    drawn = [(number, link) for number, link in enumerate(links, 1) if {link.source, link.target} <= places.keys()]
    sides = {
        side: [n for n, link in drawn if (places[link.source] < places[link.target]) is side] for side in (True, False)
    }
    left = MARGIN + LANE * (len(sides[False]) + 1)
    width = left + WIDTH + MARGIN + LANE * (len(sides[True]) + 1)
    height = 2 * MARGIN + len(order) * (HEIGHT + GAP) - GAP
    boxes = [_box(name, models.get(name, ""), left, MARGIN + place * (HEIGHT + GAP)) for name, place in places.items()]
    ends = _ends(drawn, places)
    arrows = []
    for number, link in drawn:
        right = places[link.source] < places[link.target]
        lane = sides[right].index(number) + 1
        edge, turn = (left + WIDTH, left + WIDTH + LANE * lane) if right else (left, left - LANE * lane)
        arrows.append(_arrow(number, link, (edge, turn), ends[number]))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" style="width: {width}px"'
        ' aria-label="The system: components in the order of stepping, and their connections" font-family="sans-serif">'
        '<defs><marker id="arrow" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" orient="auto">'
        f'<path d="M0 0L10 5L0 10z" fill="var(--ink)"/></marker></defs>{"".join(boxes)}{"".join(arrows)}</svg>'
    )


def _ends(drawn: Sequence[tuple[int, Link]], places: dict[str, int]) -> dict[int, tuple[float, float]]:
    """Heights at which each arrow leaves and enters a box; those of one side of a box are spread over its height."""
    uses: dict[tuple[str, bool], list[tuple[int, int]]] = {}
    for number, link in drawn:
        right = places[link.source] < places[link.target]
        uses.setdefault((link.source, right), []).append((number, 0))
        uses.setdefault((link.target, right), []).append((number, 1))
    heights: dict[int, list[float]] = {number: [0.0, 0.0] for number, _ in drawn}
    for (name, _), found in uses.items():
        for i, (number, end) in enumerate(sorted(found, key=lambda use: use[1] == 0)):
            heights[number][end] = MARGIN + places[name] * (HEIGHT + GAP) + HEIGHT * (i + 1) / (len(found) + 1)
    return {number: (pair[0], pair[1]) for number, pair in heights.items()}


def _box(name: str, model: str, x: float, y: float) -> str:
    place = f'x="{x + WIDTH / 2}" text-anchor="middle"'
    return (
        f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="5" fill="var(--panel)" stroke="var(--soft)"/>'
        f'<text {place} y="{y + 20}" font-size="14" fill="var(--ink)">{_cut(name)}</text>'
        f'<text {place} y="{y + 36}" font-size="10" fill="var(--soft)">{_cut(model, 28)}</text>'
    )


def _cut(text: str, most: int = MOST_LETTERS) -> str:
    return escaped(text if len(text) <= most else f"{text[: most - 1]}…")


def _arrow(number: int, link: Link, across: tuple[float, float], ends: tuple[float, float]) -> str:
    (edge, turn), (leave, enter) = across, ends
    dashes = ' stroke-dasharray="5 3"' if link.delayed else ""
    middle = (leave + enter) / 2
    return (
        f'<path d="M{edge} {leave:.1f}H{turn}V{enter:.1f}H{edge}" fill="none" stroke="var(--ink)"'
        f' stroke-width="1.2"{dashes} marker-end="url(#arrow)"/>'
        f'<circle cx="{turn}" cy="{middle:.1f}" r="7.5" fill="var(--paper)"/>'
        f'<text x="{turn}" y="{middle + 4:.1f}" text-anchor="middle" font-size="11" fill="var(--ink)">{number}</text>'
    )
