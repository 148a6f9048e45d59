"""A quick look at a result: columns over time, those of one unit in one panel."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from adaptimp_fmu.files.cache_folder import let_matplotlib_write
from orchestration.errors import OrchestrationError, UnknownNameError
from orchestration.fmi.given import shown
from orchestration.fmi.names import chosen, suggestion
from orchestration.results.texts import text_column

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orchestration.results.result import Result

WIDTH, HEIGHT = 8.0, 2.4  # inches of a panel
LEGEND = 2.0  # inches beside a panel
WIDTH_OF_LINE, WIDER = 1.2, 0.9  # points: of the last of several results, and by how much each before it is wider
FAINT = 0.45  # opacity of all results but the last
DASHES = ("-", "--", ":", "-.")
MOST_LABELS = 12


def plot(result: "Result", names: Sequence[str], ax: "Axes | None") -> np.ndarray:
    """Draw columns; see `Result.plot`."""
    for name in names:
        if not isinstance(name, str):
            msg = f"The result has no column {shown(name)}; give names, as texts, such as 'plant.x'."
            raise UnknownNameError(msg)
    if ax is not None and not hasattr(ax, "plot"):
        msg = f"ax is {shown(ax)}; give Axes of matplotlib, or leave ax out for a new figure."
        raise OrchestrationError(msg)
    by_unit = _by_unit(result, names)
    if ax is not None and len(by_unit) > 1:
        units = ", ".join(unit or "none" for unit in by_unit)
        msg = f"The columns have the units {units}; one panel takes one unit. Leave ax out for a panel each."
        raise OrchestrationError(msg)
    panels = _new_panels(max(1, len(by_unit))) if ax is None else np.array([ax])
    for panel, (unit, group) in zip(panels, by_unit.items(), strict=False):
        _draw(panel, result, group, unit)
        _limit_time(panel, [result])
        if len(group) <= MOST_LABELS:
            panel.legend(loc="best", fontsize="small")
    panels[-1].set_xlabel("time (s)")
    return panels


def figure_by_unit(results: Mapping[str, "Result"], names: Sequence[str], title: str) -> "Figure":
    """Draw columns of one or several results over time into a figure that belongs to no window.

    Parameters
    ----------
    results
        By their labels, which stand before the names of columns if there are several.
    names
        As of `Result.plot`.

    Raises
    ------
    OrchestrationError
        Those of `Result.plot`.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = {label: _by_unit(result, names) for label, result in results.items()}
    units = list(dict.fromkeys(unit for by_unit in columns.values() for unit in by_unit))
    figure = Figure(figsize=(WIDTH + LEGEND, 0.6 + HEIGHT * max(1, len(units))), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(max(1, len(units)), 1, sharex=True, squeeze=False)[:, 0]
    figure.suptitle(title, x=0.01, ha="left")
    for panel, unit in zip(panels, units, strict=False):
        for label, result in results.items():
            several = partial(_looks, label, list(results)) if len(results) > 1 else None
            _draw(panel, result, columns[label].get(unit, []), unit, several)
        if len(panel.get_lines()) <= MOST_LABELS:
            panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))  # where it hides nothing
    _limit_time(panels[0], list(results.values()))
    panels[-1].set_xlabel("time (s)")
    return figure


def _looks(label: str, labels: Sequence[str], place: int) -> dict[str, Any]:
    """A colour for each column, dashes for each result; of equal curves the wider ones below are still seen."""
    run = labels.index(label)
    width = WIDTH_OF_LINE + WIDER * (len(labels) - 1 - run)
    alpha = 1.0 if run == len(labels) - 1 else FAINT
    return {
        "prefix": f"{label}: ",
        "color": f"C{place}",
        "ls": DASHES[run % len(DASHES)],
        "lw": width,
        "alpha": alpha,
    }


def _by_unit(result: "Result", names: Sequence[str]) -> dict[str, list[str]]:
    """The columns that names choose, by unit."""
    for name in names:
        if text_column(result.texts, name) is not None:
            msg = f"{name} is a column of texts, which cannot be drawn; give columns of numbers."
            raise OrchestrationError(msg)
    columns, missing = chosen(names or result.names, result.names)
    if missing:
        msg = f"The result has no column {missing[0]}; {suggestion(missing[0], result.names)}"
        raise UnknownNameError(msg)
    by_unit: dict[str, list[str]] = {}
    for column in columns:
        by_unit.setdefault(result.unit(column), []).append(column)
    return by_unit


def _new_panels(number: int) -> np.ndarray:
    """Panels one above the other in a new figure of pyplot, which notebooks and plt.show() display."""
    let_matplotlib_write()
    import matplotlib.pyplot as plt

    size = (WIDTH, 0.6 + HEIGHT * number)
    return plt.subplots(number, 1, sharex=True, squeeze=False, figsize=size, layout="constrained")[1][:, 0]


def _draw(
    ax: "Axes",
    result: "Result",
    columns: Sequence[str],
    unit: str,
    looks: Callable[[int], dict[str, Any]] | None = None,
) -> None:
    """Draw columns of one unit; a row of a sampled component shows the value that was held until its time.

    The looks of a curve follow from the place of its column, and from its label; without them the colours differ.
    """
    for place, column in enumerate(columns):
        held = "steps-pre" if column.partition(".")[0] in result.sample_times else "default"
        look: dict[str, Any] = {"lw": WIDTH_OF_LINE} if looks is None else looks(place)
        ax.plot(result.time, result[column], label=look.pop("prefix", "") + column, drawstyle=held, **look)
    shared = {column.rpartition("[")[0] or column for column in columns}
    quantity = shared.pop() if len(shared) == 1 else ""
    ax.set_ylabel(f"{quantity} ({unit})" if unit and quantity else f"({unit})" if unit else quantity)
    ax.grid(visible=True, alpha=0.3)


def _limit_time(ax: "Axes", results: Sequence["Result"]) -> None:
    """Let the axis of time end with the rows."""
    times = [result.time for result in results if len(result.time) > 1]
    if times:
        ax.set_xlim(min(float(np.min(time)) for time in times), max(float(np.max(time)) for time in times))
