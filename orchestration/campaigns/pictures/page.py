"""A study as one page: what varied, what was measured, a picture of each measure, the runs that failed.

The page is one file of HTML with its pictures inside. It needs no network and no JavaScript.
"""

import base64
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.campaigns.columns import MESSAGE, SYSTEM
from orchestration.campaigns.pictures.plot_table import BOUNDARY, best_kind, plot_table
from orchestration.campaigns.view import View, measures_in
from orchestration.errors import StudyError, printable
from orchestration.fmi.given import short

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

PAGE = "index.html"
MOST_FAILURES = 100  # rows of failed runs; the table of the study has all
_DIGITS = 5
_LONGEST = 100  # characters of a picture's name
_CAPTIONS = {
    "marginals": "{} over each factor; the band and the median are over everything else that varies.",
    "heat-map": "{} over two factors.",
    "boundary": "Where {} keeps within its limit.",
    "seeds": "Spread of {} over the seeds.",
    "sensitivity": "How much of the variance of {} comes from each factor.",
}


@dataclass(frozen=True)
class _Picture:
    path: Path
    caption: str

    @property
    def data(self) -> str:
        return base64.b64encode(self.path.read_bytes()).decode()


def write_page(
    table: "xr.Dataset | pd.DataFrame",
    folder: str | Path,
    *,
    command: str = "",
    limits: Mapping[str, float] | None = None,
) -> list[Path]:
    """Write a picture of each measure, and a page with all of them.

    Parameters
    ----------
    table
        Table of a `Study`.
    folder
        Folder for ``index.html`` and a PNG file for each picture; it is made if it is missing.
    command
        What makes the study again, such as a command or a TOML file; the page shows it.
    limits
        Largest good value by the name of a measure; such a measure gets a picture of its boundary, too.

    Returns
    -------
    list of Path
        The pictures, and the page as the last.

    Raises
    ------
    StudyError
        If the table is not one of a study, or a file cannot be written.
    UnknownNameError
        If there is a limit for what is no measure.
    """
    place = Path(folder)
    names = measures_in(table)
    views = {name: View.of(table, name) for name in names}
    if not views:
        msg = "The table has no measure, so there is nothing to draw; give the study a measure."
        raise StudyError(msg)
    for name in limits or {}:
        View.of(table, name)
    pictures = _pictures(table, views, place, limits or {})
    first = views[names[0]]
    content = (
        _environment()
        .get_template("page.html.jinja")
        .render(
            title=f"Study of {table.attrs.get('system', 'a system')}",
            summary=_summary(table, first),
            command=command,
            factors=[_factor(first, name) for name in first.every_factor],
            measures=[_measure(view) for view in views.values()],
            pictures=pictures,
            **_failures(first),
        )
    )
    try:
        write_whole(place / PAGE, content.encode())
    except OSError as error:
        msg = f"{place / PAGE}: the page cannot be written: {error.strerror or error}; choose another folder."
        raise StudyError(msg) from error
    return [*(picture.path for picture in pictures), place / PAGE]


def _pictures(table: Any, views: Mapping[str, View], folder: Path, limits: Mapping[str, float]) -> list[_Picture]:
    """Draw the pictures of all measures."""
    found: dict[Path, _Picture] = {}
    for name, view in views.items():
        kinds = [best_kind(view)]
        kinds += [BOUNDARY] if name in limits and len(view.ordered) > 1 else []
        for kind in kinds:
            path = _free(folder, f"{name}-{kind}", found)
            plot_table(table, name, path, kind=kind, limit=limits.get(name) if kind == BOUNDARY else None)
            found[path] = _Picture(path, _CAPTIONS[kind].format(name))
    return list(found.values())


def _free(folder: Path, name: str, taken: Collection[Path]) -> Path:
    """A path for a picture that no other one of the page has, of letters that every system takes."""
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "_", name).strip("_")[:_LONGEST]
    path, number = folder / f"{stem}.png", 1
    while path in taken:
        number += 1
        path = folder / f"{stem}-{number}.png"
    return path


def _summary(table: Any, view: View) -> str:
    failed = int((~view.complete).sum())
    about = [f"{len(view.frame)} runs", f"{failed} failed" if failed else "none failed"]
    words = {"algorithm": "algorithm {}", "stop_time": "until {} s"}
    about += [words[key].format(_text(table.attrs[key])) for key in words if key in table.attrs]
    return f"{', '.join(about)}."


def _text(value: Any) -> str:
    return short(float(value)) if isinstance(value, float | np.floating) else str(value)


def _number(value: float) -> str:
    return f"{value:.{_DIGITS}g}"


def _factor(view: View, name: str) -> dict[str, Any]:
    levels = list(dict.fromkeys(view.frame[name])) if name == SYSTEM else view.levels(name).tolist()
    ends = [str(level) if name == SYSTEM else _number(level) for level in (levels[0], levels[-1])]
    unit, sets = view.units.get(name, ""), view.sets.get(name, "")
    return {"name": name, "unit": unit, "count": len(levels), "first": ends[0], "last": ends[1], "sets": sets}


def _measure(view: View) -> dict[str, Any]:
    values = view.values[np.isfinite(view.values)]
    quantiles = np.quantile(values, (0, 0.1, 0.5, 0.9, 1)) if values.size else np.full(5, np.nan)
    numbers = [_number(value) for value in quantiles]
    return {"name": view.measure, "unit": view.units.get(view.measure, ""), "count": values.size, "numbers": numbers}


def _failures(view: View) -> dict[str, Any]:
    """Rows of the runs that failed, with their sentences."""
    failed = view.frame[~view.complete]
    columns = {str(name): failed[name].tolist()[:MOST_FAILURES] for name in failed.columns}
    records = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    rows = [
        {
            "cells": [str(row[name]) if name == SYSTEM else _number(float(row[name])) for name in view.every_factor],
            "message": printable(row.get(MESSAGE, ""), 500),
        }
        for row in records
    ]
    return {
        "failures": rows,
        "failed_columns": view.every_factor,
        "more_failures": max(0, len(failed) - MOST_FAILURES),
    }


def _environment() -> Any:
    import jinja2

    return jinja2.Environment(
        loader=jinja2.PackageLoader("orchestration.campaigns"),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
