"""Smallest, largest and last value of each column of a result, also of files that do not fit into memory."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np

from orchestration.results.columns import Columns
from orchestration.results.formats import parts_of


@dataclass(frozen=True)
class Extremes:
    """What a result holds, in a few numbers.

    Attributes
    ----------
    names, units, metadata, status, message
        As of `orchestration.results.columns.Columns`.
    rows
        Number of rows.
    span
        First and last time, s; None without rows.
    smallest, largest, last
        Values of the columns, float64, shape (n_columns,); NaN without rows.
    texts
        Last text of each column of texts, by name; empty without rows.
    """

    names: tuple[str, ...]
    units: Mapping[str, str]
    metadata: Mapping[str, str]
    status: str
    message: str
    rows: int
    span: tuple[float, float] | None
    smallest: np.ndarray
    largest: np.ndarray
    last: np.ndarray
    texts: Mapping[str, str] = field(default_factory=dict)


def extremes(parts: Iterable[Columns]) -> Extremes:
    """Find the extremes of one result that comes in parts, at least one of them, in the order of time."""
    rest = iter(parts)
    first = next(rest)
    smallest = largest = last = np.full(len(first.names), np.nan)
    rows, span, texts = 0, None, dict.fromkeys(first.texts, "")
    for part in chain([first], rest):
        if len(part.time):
            rows += len(part.time)
            span = (span[0] if span else float(part.time[0]), float(part.time[-1]))
            smallest = np.fmin(smallest, np.fmin.reduce(part.rows))
            largest = np.fmax(largest, np.fmax.reduce(part.rows))
            last = part.rows[-1]
            texts = {name: str(column[-1]) for name, column in part.texts.items()}
    about = (first.names, first.units, first.metadata, first.status, first.message)
    return Extremes(*about, rows, span, smallest, largest, last, texts)


def extremes_of_file(path: Path) -> Extremes:
    """Find the extremes of a CSV or Parquet file; of a Parquet file, no more than a group of rows is in memory.

    Raises
    ------
    OrchestrationError
        If the suffix is unknown, or the file does not hold a result.
    """
    return extremes(parts_of(path))
