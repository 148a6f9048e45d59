"""Line drawings as SVG, which stand in the text of a page and take its colours, light or dark.

Coordinates are pixels from the top left. Texts may have subscripts: ``F_ext`` is an F with the subscript ext; a blank
or a comma ends the subscript. The page's style sheet defines the colours; elsewhere they are those for light paper.
"""

import math
import re
from collections.abc import Sequence
from html import escape

INK, SOFT, FAINT = "var(--ink, #222)", "var(--soft, #6b7280)", "var(--faint, #d7dae0)"
BLUE, RUST, GREEN = "var(--blue, #1f5fa8)", "var(--rust, #a8481a)", "var(--green, #2f7a3f)"
PAPER, MARK = "var(--paper, #fff)", "var(--mark, #fbe9dd)"

Point = tuple[float, float]
_SUBSCRIPT = re.compile(r"_([^\s,]+)")


class Picture:
    """A drawing that grows element by element.

    Parameters
    ----------
    width, height
        Size, pixels.
    title
        What the drawing shows, for those who cannot see it.
    """

    def __init__(self, width: float, height: float, title: str) -> None:
        self.width, self.height, self.title = width, height, title
        self._elements: list[str] = []

    def line(self, points: Sequence[Point], colour: str = INK, width: float = 1.6, dashes: str = "") -> None:
        """Draw a line through points."""
        path = " ".join(f"{_number(x)},{_number(y)}" for x, y in points)
        dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
        style = f"stroke:{colour};stroke-width:{_number(width)}"
        self._elements.append(f'<polyline points="{path}" fill="none" style="{style}"{dashed}/>')

    def arrow(self, points: Sequence[Point], colour: str = INK, width: float = 1.6) -> None:
        """Draw a line through points with a head at its end."""
        (x0, y0), (x1, y1) = points[-2:]
        length = math.hypot(x1 - x0, y1 - y0)
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        size = 4 + 2.2 * width
        base = (x1 - size * ux, y1 - size * uy)
        wing = 0.42 * size
        self.line([*points[:-1], base], colour, width)
        corners = [(x1, y1), (base[0] - wing * uy, base[1] + wing * ux), (base[0] + wing * uy, base[1] - wing * ux)]
        path = " ".join(f"{_number(x)},{_number(y)}" for x, y in corners)
        self._elements.append(f'<polygon points="{path}" style="fill:{colour}"/>')

    def arc(self, centre: Point, radius: float, span: tuple[float, float], colour: str = INK) -> None:
        """Draw an arrow along a circle, between two angles in rad that count counter-clockwise from the right."""
        begin, end = span
        steps = max(8, round(abs(end - begin) * 16))
        angles = [begin + (end - begin) * i / steps for i in range(steps + 1)]
        points = [(centre[0] + radius * math.cos(a), centre[1] - radius * math.sin(a)) for a in angles]
        self.arrow([*points[:-2], points[-1]], colour, 1.2)

    def circle(self, centre: Point, radius: float, colour: str = INK, fill: str = PAPER) -> None:
        """Draw a circle."""
        where = f'cx="{_number(centre[0])}" cy="{_number(centre[1])}" r="{_number(radius)}"'
        self._elements.append(f'<circle {where} style="fill:{fill};stroke:{colour};stroke-width:1.6"/>')

    def box(self, corner: Point, size: Point, *, colour: str = INK, fill: str = PAPER, width: float = 1.4) -> None:
        """Draw a rectangle from its top left corner."""
        where = f'x="{_number(corner[0])}" y="{_number(corner[1])}"'
        extent = f'width="{_number(size[0])}" height="{_number(size[1])}" rx="4"'
        style = f"fill:{fill};stroke:{colour};stroke-width:{_number(width)}"
        self._elements.append(f'<rect {where} {extent} style="{style}"/>')

    def text(
        self,
        at: Point,
        text: str,
        *,
        anchor: str = "start",
        colour: str = INK,
        size: float = 14,
        bold: bool = False,
        lowered: bool = True,
    ) -> None:
        """Write a line of text; `anchor` is start, middle or end. With `lowered` a ``_`` begins a subscript."""
        where = f'x="{_number(at[0])}" y="{_number(at[1])}" text-anchor="{anchor}"'
        style = f"fill:{colour};font-size:{_number(size)}px{';font-weight:600' if bold else ''}"
        self._elements.append(
            f'<text {where} style="{style}">{_with_subscripts(text) if lowered else escape(text)}</text>'
        )

    def svg(self) -> str:
        """Return the drawing as an ``svg`` element."""
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_number(self.width)} {_number(self.height)}"'
        size = f'width="{_number(self.width)}" height="{_number(self.height)}"'
        said = escape(self.title)
        opening = f'{head} {size} role="img" aria-label="{said}" font-family="sans-serif">'
        return "\n".join([opening, f"<title>{said}</title>", *self._elements, "</svg>"])


def _number(value: float) -> str:
    """A coordinate to a hundredth of a pixel, the same text on every machine."""
    return f"{value + 0.0:.2f}".rstrip("0").rstrip(".") if abs(value) >= 5e-3 else "0"


def _with_subscripts(text: str) -> str:
    """The text, escaped, with ``_abc`` lowered; what follows stands on the line again."""
    parts, at, lowered = [], 0, 0.0
    for match in _SUBSCRIPT.finditer(text):
        plain = escape(text[at : match.start()])
        parts.append(f'<tspan dy="{_number(-lowered)}">{plain}</tspan>' if lowered and plain else plain)
        lowered = 4.0 if not lowered or plain else lowered
        parts.append(f'<tspan dy="{_number(lowered)}" font-size="75%">{escape(match[1])}</tspan>')
        at = match.end()
    rest = escape(text[at:])
    parts.append(f'<tspan dy="{_number(-lowered)}">{rest}</tspan>' if lowered and rest else rest)
    return "".join(parts)
