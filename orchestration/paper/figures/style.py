"""How the figures look: colours, sizes, empty figures, legends beside the data, and curves thinned to what is seen.

Figures are drawn without pyplot, each on an Agg canvas of its own: a caller's backend and settings stay as they are.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from orchestration.results.picture_file import HASH_SALT

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

# Okabe & Ito (2008): colours that people with any kind of colour blindness tell apart.
BLUE, VERMILLION, GREEN, SKY, ORANGE = "#0072B2", "#D55E00", "#009E73", "#56B4E9", "#E69F00"
LIGHT = "#A9D6F0"  # of what is behind a blue curve
BLACK, GREY, WALL, SHADE = "#000000", "#8C8C8C", "#C4C4C4", "#E3E3E3"
STYLE: "dict[RcKeyType, Any]" = {
    "font.size": 10,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 21,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "legend.borderpad": 0,
    "legend.borderaxespad": 0.25,
    "legend.columnspacing": 1.1,
    "legend.handlelength": 1.5,
    "legend.handletextpad": 0.45,
    "lines.linewidth": 1.3,
    "savefig.dpi": 150,
    "svg.hashsalt": HASH_SALT,
    "svg.fonttype": "none",
}
BINS = 1000  # of a time axis: more than the pixels on which it is drawn
LEGEND_WIDTH = 1.3  # of a line in a legend, at least
WIDTH, ROW, HEAD, FOOT = 9.0, 3.55, 0.72, 0.5  # in: of a figure, of a row of panels, and above and below the panels


def new_figure(rows: int, columns: int, title: str, row: float = ROW, head: float = 0.0) -> tuple[Figure, np.ndarray]:
    """An empty figure with a title, and its axes, shape (rows, columns); a row is so many inches high.

    Below the title so many inches `head` are left free.
    """
    height = rows * row + 0.2 + head
    figure = Figure(figsize=(WIDTH, height))
    FigureCanvasAgg(figure)
    # Fixed: a computed layout draws every figure twice.
    figure.subplots_adjust(
        left=0.085, right=0.98, bottom=FOOT / height, top=1 - (HEAD + head) / height, hspace=0.42, wspace=0.21
    )
    figure.suptitle(title, x=0.01, y=1 - 0.09 / height, ha="left", va="top", fontsize=12)
    return figure, figure.subplots(rows, columns, squeeze=False)


def legend_above(axis: Axes, labels: Sequence[str] | None = None, *, gap: float = 0.0) -> None:
    """Put the legend in one row between the title of an axis and its frame, where it covers no data.

    Parameters
    ----------
    labels
        Labels to show; all if None.
    gap
        Free height between the frame and the legend, of the height of the axis.
    """
    handles, found = axis.get_legend_handles_labels()
    shown = {label: handle for handle, label in zip(handles, found, strict=True) if labels is None or label in labels}
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1 + gap), "ncols": max(1, len(shown))}
    for line in axis.legend(list(shown.values()), list(shown), **place).get_lines():
        line.set_linewidth(max(LEGEND_WIDTH, line.get_linewidth()))


def envelope(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve thinned to what a picture shows: the least and the largest value of each of `BINS` pieces.

    Parameters
    ----------
    t, y
        The curve, shape (n,).
    """
    size = t.size // BINS
    if size <= 2:
        return t, y
    pieces = y[: size * BINS].reshape(BINS, size)
    ends = np.sort(np.stack([pieces.argmin(axis=1), pieces.argmax(axis=1)], axis=1), axis=1)
    kept = (ends + size * np.arange(BINS)[:, None]).ravel()
    kept = np.concatenate([kept, np.arange(size * BINS, t.size)])
    return t[kept], y[kept]


def thinned(points: np.ndarray) -> np.ndarray:
    """A smooth path, thinned to about 5 `BINS` points, shape (2, n)."""
    return points[:: max(1, len(points) // (5 * BINS))].T
