"""How results look in a notebook: short HTML tables."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from orchestration.fmi.names import arrays, base_name
from orchestration.results.columns import COMPLETE

if TYPE_CHECKING:
    from orchestration.results.result import Result

MOST_ROWS = 24
"""Rows that a table shows; the others are counted."""


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], most: int = MOST_ROWS) -> str:
    """A small table; texts are escaped, numbers aligned right."""
    rows = list(rows)
    cells = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows[:most])
    rest = f"<tr><td colspan={len(head)}>and {len(rows) - most} more</td></tr>" if len(rows) > most else ""
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}{rest}</tbody></table>"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f'<td align="right">{value:.6g}</td>'
    return f"<td>{escape(str(value))}</td>"


def result_html(result: "Result") -> str:
    """Rows, time span, and every column or array with unit, smallest and largest value."""
    whole = arrays(result.names)
    names = dict.fromkeys(base_name(name) if base_name(name) in whole else name for name in result.names)
    rows = [(f"{name}{_shape(result[name])}", result.unit(name), *_extremes(result[name])) for name in names]
    span = f", t = {result.time[0]:g} to {result.time[-1]:g} s" if len(result.time) else ""
    state = "" if result.status == COMPLETE else f"<p>{escape(result.status)}: {escape(result.message)}</p>"
    head = f"<b>Result</b>: {len(result.time)} rows{span}"
    return f"<div>{head}{state}{html_table(('column', 'unit', 'min', 'max'), rows)}</div>"


def _shape(values: np.ndarray) -> str:
    return f" [{', '.join(map(str, values.shape[1:]))}]" if values.ndim > 1 else ""


def _extremes(values: np.ndarray) -> tuple[float, float]:
    return (float(values.min()), float(values.max())) if values.size else (float("nan"), float("nan"))
