"""Icons of FMUs: white strokes on a coloured block, written as PNG files without a library of images.

Coordinates run from (0, 0) at the bottom left of the block to (1, 1) at its top right. Only additions,
products, quotients and square roots are used, which every machine rounds alike: same icon, same bytes.
"""

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SIZE = 128  # pixels
MARGIN, CORNER = 0.03, 0.14  # of the block: outside, and radius of its corners
SIGNATURE = b"\x89PNG\r\n\x1a\n"
_RGBA_8_BIT = (8, 6, 0, 0, 0)  # bits, colour type, compression, filter, interlace
_UNFILTERED = b"\0"


@dataclass(frozen=True)
class Stroke:
    """A line through points, with round ends; one point is a disc.

    Attributes
    ----------
    points
        Coordinates (x, y).
    width
        Share of the block's side.

    Examples
    --------
    >>> from adaptimp_fmu import Icon, Stroke
    >>> spring = Stroke([(0.1, 0.5), (0.3, 0.8), (0.5, 0.2), (0.7, 0.8), (0.9, 0.5)])
    >>> icon = Icon(colour=(150, 60, 40), strokes=[spring, Stroke([(0.9, 0.5)], width=0.15)])
    """

    points: Sequence[tuple[float, float]]
    width: float = 0.06


@dataclass(frozen=True)
class Icon:
    """Strokes on a block of a colour (red, green, blue), each 0 to 255.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, Icon, Stroke
    >>> model = ContinuousModel("Cart", "A cart")
    >>> model.icon = Icon((40, 90, 140), [Stroke([(0.2, 0.3), (0.8, 0.3)]), Stroke([(0.5, 0.6)], width=0.3)])
    """

    colour: tuple[int, int, int] = (70, 80, 95)
    strokes: Sequence[Stroke] = ()


def png(icon: Icon) -> bytes:
    """The icon as a PNG file of `SIZE` x `SIZE` pixels."""
    header = struct.pack(">II5B", SIZE, SIZE, *_RGBA_8_BIT)
    rows = b"".join(_UNFILTERED + row.tobytes() for row in _pixels(icon))
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    return SIGNATURE + b"".join(_chunk(name, content) for name, content in chunks)


def _chunk(name: bytes, content: bytes) -> bytes:
    """Length, name, content, checksum."""
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def _pixels(icon: Icon) -> np.ndarray:
    """Red, green, blue and opacity, shape (SIZE, SIZE, 4), uint8."""
    centres = (np.arange(SIZE) + 0.5) / SIZE
    x, y = centres[np.newaxis, :], 1 - centres[:, np.newaxis]
    ink = np.zeros((SIZE, SIZE))
    for stroke in icon.strokes:
        ink = np.maximum(ink, _covered(_distance(x, y, stroke.points) - stroke.width / 2))
    colour = np.array(icon.colour, dtype=float)
    shades = colour + ink[..., np.newaxis] * (255 - colour)
    opacity = 255 * _covered(_block_distance(x, y))
    return np.rint(np.concatenate([shades, opacity[..., np.newaxis]], axis=2)).astype(np.uint8)


def _covered(distance: np.ndarray) -> np.ndarray:
    """Share of each pixel inside an outline, from its signed distance: smooth over one pixel."""
    return np.clip(0.5 - distance * SIZE, 0, 1)


def _distance(x: np.ndarray, y: np.ndarray, points: Sequence[tuple[float, float]]) -> np.ndarray:
    """Distance of each pixel from the line through the points, shape (SIZE, SIZE)."""
    nearest = np.full((SIZE, SIZE), np.inf)
    for (x0, y0), (x1, y1) in zip(points, [*points[1:], points[-1]], strict=True):
        dx, dy = x1 - x0, y1 - y0
        length_squared = dx * dx + dy * dy
        along = ((x - x0) * dx + (y - y0) * dy) / length_squared if length_squared > 0 else 0 * (x + y)
        along = np.clip(along, 0, 1)
        ex, ey = x - x0 - along * dx, y - y0 - along * dy
        nearest = np.minimum(nearest, np.sqrt(ex * ex + ey * ey))
    return nearest


def _block_distance(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Signed distance of each pixel from the rounded block, negative inside."""
    half = 0.5 - MARGIN - CORNER
    beyond_x, beyond_y = np.abs(x - 0.5) - half, np.abs(y - 0.5) - half
    outside_x, outside_y = np.maximum(beyond_x, 0), np.maximum(beyond_y, 0)
    inside = np.minimum(np.maximum(beyond_x, beyond_y), 0)
    return np.sqrt(outside_x * outside_x + outside_y * outside_y) + inside - CORNER
