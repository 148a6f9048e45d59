"""A quick look at a result: columns over time, those of one unit in one panel."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from adaptimp_fmu.files.cache_folder import let_matplotlib_write
from orchestration.errors import OrchestrationError, UnknownNameError
from orchestration.fmi.given import shown
from orchestration.fmi.names import chosen, suggestion
from orchestration.results.texts import text_column

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from orchestration.results.result import Result

WIDTH, HEIGHT = 8.0, 2.4  # inches of a panel
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
    if ax is not None and len(by_unit) > 1:
        units = ", ".join(unit or "none" for unit in by_unit)
        msg = f"The columns have the units {units}; one panel takes one unit. Leave ax out for a panel each."
        raise OrchestrationError(msg)
    panels = _new_panels(max(1, len(by_unit))) if ax is None else np.array([ax])
    for panel, (unit, group) in zip(panels, by_unit.items(), strict=False):
        _draw(panel, result, group, unit)
    panels[-1].set_xlabel("time (s)")
    return panels


def _new_panels(number: int) -> np.ndarray:
    """Panels one above the other in a new figure of pyplot, which notebooks and plt.show() display."""
    let_matplotlib_write()
    import matplotlib.pyplot as plt

    size = (WIDTH, 0.6 + HEIGHT * number)
    return plt.subplots(number, 1, sharex=True, squeeze=False, figsize=size, layout="constrained")[1][:, 0]


def _draw(ax: "Axes", result: "Result", columns: Sequence[str], unit: str) -> None:
    for column in columns:
        ax.plot(result.time, result[column], label=column, lw=1.2)
    shared = {column.rpartition("[")[0] or column for column in columns}
    quantity = shared.pop() if len(shared) == 1 else ""
    ax.set_ylabel(f"{quantity} ({unit})" if unit and quantity else f"({unit})" if unit else quantity)
    ax.grid(visible=True, alpha=0.3)
    if len(result.time) > 1:
        ax.set_xlim(float(np.min(result.time)), float(np.max(result.time)))
    if len(columns) <= MOST_LABELS:
        ax.legend(loc="best", fontsize="small")
