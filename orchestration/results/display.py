"""How results look in a notebook: short HTML tables."""

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from orchestration.fmi.display import html_table
from orchestration.fmi.names import arrays, base_name
from orchestration.results.columns import COMPLETE

if TYPE_CHECKING:
    from orchestration.results.result import Result


def result_html(result: "Result") -> str:
    """Rows, time span, and every column or array with unit, smallest and largest value."""
    whole = arrays(result.names)
    names = dict.fromkeys(base_name(name) if base_name(name) in whole else name for name in result.names)
    rows: list[tuple[object, ...]] = [
        (f"{name}{_shape(result[name])}", result.unit(name), *_extremes(result[name])) for name in names
    ]
    rows += [(name, "", "", f"last: {texts[-1]}" if len(texts) else "") for name, texts in result.texts.items()]
    span = f", t = {result.time[0]:g} to {result.time[-1]:g} s" if len(result.time) else ""
    state = "" if result.status == COMPLETE else f"<p>{escape(result.status)}: {escape(result.message)}</p>"
    head = f"<p><b>Result</b>: {len(result.time)} rows{span}</p>"
    return f"<div>{head}{state}{html_table(('column', 'unit', 'min', 'max'), rows)}</div>"


def _shape(values: np.ndarray) -> str:
    return f" [{', '.join(map(str, values.shape[1:]))}]" if values.ndim > 1 else ""


def _extremes(values: np.ndarray) -> tuple[float, float]:
    return (float(values.min()), float(values.max())) if values.size else (float("nan"), float("nan"))
