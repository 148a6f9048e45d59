"""The picture of a measure of a study: the kind that shows it best, or the one that is asked for."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from orchestration.campaigns.pictures.boundary import draw_boundary
from orchestration.campaigns.pictures.heat_map import draw_heat_map
from orchestration.campaigns.pictures.indices import draw_indices
from orchestration.campaigns.pictures.marginals import draw_marginals
from orchestration.campaigns.pictures.seeds import draw_seeds
from orchestration.campaigns.pictures.style import save, settings
from orchestration.campaigns.sensitivity import has_indices, sensitivity
from orchestration.campaigns.stability import GROWTH_RATE
from orchestration.campaigns.view import View
from orchestration.errors import StudyError
from orchestration.fmi.given import a_number, a_path, shown
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

MARGINALS, HEAT_MAP, BOUNDARY, SEEDS, SENSITIVITY = "marginals", "heat-map", "boundary", "seeds", "sensitivity"
KINDS = (MARGINALS, HEAT_MAP, BOUNDARY, SEEDS, SENSITIVITY)


def plot_table(
    table: "xr.Dataset | pd.DataFrame",
    measure: str,
    path: str | Path | None = None,
    *,
    kind: str | None = None,
    limit: float | None = None,
    stability: "xr.Dataset | None" = None,
) -> "Figure":
    """Draw a measure over the factors of a study.

    Parameters
    ----------
    table
        Table of a `Study`.
    measure
        Name of the measure.
    path
        File for the picture, ``.png``, ``.svg`` or ``.pdf``; None writes nothing.
    kind
        ``"marginals"``: the measure over each factor, median and quantiles over the rest. ``"heat-map"``: over two
        factors. ``"boundary"``: where runs succeed and keep within the limit. ``"seeds"``: quantiles over seeds.
        ``"sensitivity"``: indices of `sensitivity`. Default: boundary if there is a limit or a prediction, else what
        suits the table.
    limit
        Largest value of the measure that is good, for a boundary.
    stability
        What `Study.stability` predicts for a grid of the same factors; its border is drawn into a boundary.

    Returns
    -------
    Figure
        Figure of matplotlib that belongs to no window.

    Raises
    ------
    StudyError
        If the kind is unknown or does not suit the table, or the file cannot be written.
    UnknownNameError
        If there is no such measure.

    Examples
    --------
    >>> from orchestration import Study, plot_table, scenario
    >>> study = Study(scenario("fig2"), measure="worst = max(norm(controller.e))", stop_time=0.1)
    >>> table = study.grid({"controller.K": "1e3:1e5:3log", "plant.m[2]": [0.9, 1.0, 1.1]}).run()
    >>> figure = plot_table(table, "worst", "worst.png")
    >>> [axes.get_xlabel() for axes in figure.axes][0]
    'K (N/m)'
    """
    view = View.of(table, measure)
    limit = None if limit is None else a_number("The limit", limit, StudyError, view.units.get(measure, ""))
    chosen = kind or (best_kind(view) if limit is stability is None else BOUNDARY)
    growth = None if stability is None else View.of(stability, GROWTH_RATE)
    draw: Mapping[str, Callable[[], Figure]] = {
        MARGINALS: lambda: draw_marginals(view),
        HEAT_MAP: lambda: draw_heat_map(view),
        BOUNDARY: lambda: draw_boundary(view, limit, growth),
        SEEDS: lambda: draw_seeds(view),
        SENSITIVITY: lambda: draw_indices(sensitivity(table, measure)),
    }
    if chosen not in draw:
        msg = f"There is no picture of the kind {shown(kind)}; {suggestion(str(kind), KINDS)}"
        raise StudyError(msg)
    with settings():
        figure = draw[chosen]()
    if path is not None:
        save(figure, a_path("The path of a picture", path))
    return figure


def best_kind(view: View) -> str:
    """The kind of picture that suits a table."""
    if view.grid:
        if len(view.ordered) == 2:
            return HEAT_MAP
        return SEEDS if view.seeds and len(view.ordered) <= 1 else MARGINALS
    return SENSITIVITY if has_indices(view) else MARGINALS
