"""What all pictures of tables share: colours that colour-blind people can tell apart, scales, and files."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from adaptimp_fmu.files.cache_folder import let_matplotlib_write
from orchestration.campaigns.view import View
from orchestration.errors import StudyError
from orchestration.results import picture_file
from orchestration.results.picture_file import HASH_SALT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Colours of Okabe and Ito (2008), which people with any colour vision can tell apart."""
DASHES, MARKERS = ("-", "--", ":", "-."), ("o", "s", "^", "D")
"""Lines and signs of the variants of a system, which can be seen where their curves coincide."""
GOOD, BAD, FAILED, GREY = COLOURS[0], COLOURS[4], COLOURS[1], "0.35"
SCALE = "viridis"
"""Colours of values: their lightness increases, so the picture can be read in grey, too."""
HATCH = "////"
_RC: Any = {
    "font.size": 9,
    "axes.titlesize": 9.5,
    "legend.fontsize": 8.5,
    "savefig.dpi": 150,
    "svg.hashsalt": HASH_SALT,
}
_LETTERS, _HANDLE = 15, 8  # letters of a legend in an inch, and how many the sign before a text takes
_DECADES = 2.0  # decades of values from which on their axis is logarithmic


def new_figure(width: float, height: float) -> "Figure":
    """Return an empty figure, in inches; it belongs to no window and leaves a caller's settings as they are."""
    let_matplotlib_write()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def settings() -> Any:
    """Return the context in which pictures are drawn and saved."""
    let_matplotlib_write()
    from matplotlib import rc_context

    return rc_context(_RC)


def save(figure: "Figure", path: Path) -> None:
    """Write a figure; the same figure gives the same bytes.

    Raises
    ------
    StudyError
        If the suffix is unknown, or the file cannot be written.
    """
    with settings():
        picture_file.save(figure, path, StudyError)


def looks(view: View) -> "list[tuple[str, View, dict[str, Any]]]":
    """Return the variants of the system, each with how its curve is drawn."""
    found = enumerate(view.variants().items())
    return [
        (
            f"{name}: " if name else "",
            some,
            {
                "color": COLOURS[place % len(COLOURS)],
                "ls": DASHES[place % len(DASHES)],
                "marker": MARKERS[place % len(MARKERS)],
                "mfc": "none" if place else COLOURS[0],
                "ms": 4 + 1.5 * (place % len(MARKERS)),
                "lw": 1.4,
            },
        )
        for place, (name, some) in found
    ]


def wide_span(values: np.ndarray) -> bool:
    """Whether finite values are all positive and span so many decades that their axis should be logarithmic."""
    found = values[np.isfinite(values)]
    return bool(found.size and found.min() > 0 and np.log10(found.max() / found.min()) >= _DECADES)


def set_scale(axes: "Axes", view: View, *, x: str | None = None, y: str | None = None) -> None:
    """Label the axes of factors with their units, and make logarithmic those whose values are spread by ratio."""
    if x is not None:
        axes.set_xlabel(view.label(x))
        axes.set_xscale("log" if view.logarithmic(x) else "linear")
    if y is not None:
        axes.set_ylabel(view.label(y))
        axes.set_yscale("log" if view.logarithmic(y) else "linear")


def legend_outside(figure: "Figure", axes: "Iterable[Axes]", further: Sequence[Any] = ()) -> None:
    """Put one legend of all panels above them, where it hides nothing."""
    handles: dict[str, Any] = {}
    for panel in axes:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    handles |= {handle.get_label(): handle for handle in further}
    if handles:
        longest = max(map(len, handles)) + _HANDLE
        columns = max(1, min(len(handles), int(figure.get_figwidth() * _LETTERS / longest)))
        figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=columns, frameon=False)


def strongest(view: View, number: int = 2) -> tuple[str, ...]:
    """The factors whose levels move the measure's median most, at most `number`, in the order of the table.

    Many values of a factor are put into ten groups of equal size.
    """
    if len(view.ordered) <= number:
        return view.ordered

    def moved(name: str) -> float:
        medians = [np.median(values) for _, values in groups(view, name)[0] if values.size]
        return float(np.ptp(medians)) if medians else 0.0

    chosen = sorted(view.ordered, key=moved, reverse=True)[:number]
    return tuple(name for name in view.ordered if name in chosen)


MOST_LEVELS = 24
GROUPS, FEWEST_IN_GROUP = 10, 8


def groups(view: View, name: str) -> tuple[list[tuple[float, np.ndarray]], bool]:
    """The measure's finite values by the level of a factor.

    Returns
    -------
    list of tuple
        Level, and the values of the runs with it. Of more than `MOST_LEVELS` levels, groups of neighbours with
        equal numbers of runs take their place, each at the median of its levels: `GROUPS` of them, or fewer if a group
        would have less than `FEWEST_IN_GROUP` runs.
    bool
        Whether there are such groups.
    """
    at, values = view.column(name), view.values
    levels = np.unique(at)
    if len(levels) <= MOST_LEVELS:
        found = [(float(level), values[at == level]) for level in levels]
    else:
        parts = np.array_split(np.argsort(at, kind="stable"), max(1, min(GROUPS, len(at) // FEWEST_IN_GROUP)))
        found = [(float(np.median(at[part])), values[part]) for part in parts]
    return [(level, some[np.isfinite(some)]) for level, some in found], len(levels) > MOST_LEVELS
