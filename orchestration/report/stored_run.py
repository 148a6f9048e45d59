"""A run as a page stores it: as many of its rows as fit, each column packed, and what its plots need besides."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from orchestration.report.encoding import SIZES, Packed, extremes, pack
from orchestration.results.result import Result

COARSEST = 1000  # bins that every column has at least: as many as a plot has pixels
WIDER = 4  # by which bins become wider
SHORT, SHORTEST = (
    25_000,
    2_000,
)  # rows: of which all columns may be finer, and of which numbers are stored with all digits


@dataclass(frozen=True)
class StoredRun:
    """A run with its packed columns.

    Attributes
    ----------
    time
        For JSON: the packed communication points, or start, step and count where they are even.
    columns
        Packed columns by name.
    bins
        Rows of a bin, by column; a column that is not named has all its rows.
    phases
        Begin and end, s, of the intervals of each phase, by its name.
    held
        Sampled components, whose row k + 1 holds from row k on.
    extra
        What modules of sections need besides, for JSON.
    """

    label: str
    time: Mapping[str, Any]
    columns: Mapping[str, Packed]
    units: Mapping[str, str]
    bins: Mapping[str, int]
    held: Sequence[str]
    phases: Mapping[str, Sequence[Sequence[float]]] = field(default_factory=dict)
    extra: Mapping[str, Any] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """The run for JSON."""
        plain = {name: getattr(self, name) for name in ("label", "time", "units", "bins", "held", "phases", "extra")}
        return {**plain, "columns": {name: asdict(packed) for name, packed in self.columns.items()}}

    def note(self) -> str:
        """How the stored numbers differ from those of the run, in a sentence or two."""
        rounding = [packed.rounding / span for packed in self.columns.values() if (span := packed.span) > 0]
        said = f"{self.label}: {self.time['count']} rows"
        if rounding:
            said += f"; each number is rounded to {max(rounding):.1g} of the range of its column, or better"
        if not self.bins:
            return f"{said}. All rows are stored."
        rows = sorted(set(self.bins.values()))
        sizes = f"{rows[0]}" if len(rows) == 1 else f"{rows[0]} to {rows[-1]}"
        return f"{said}. Of {len(self.bins)} columns the least and the largest value of {sizes} rows are stored each."

    @property
    def size(self) -> int:
        """Bytes of the packed columns."""
        return sum(len(packed.data) for packed in self.columns.values())


def store(label: str, result: Result, budget: int, first: Sequence[str] = (), **views: Any) -> StoredRun:
    """Pack a result into about so many bytes.

    Each column has all its rows, in two bytes, if that fits; else the last columns get bins of 4, 16 or more rows, in
    turn, until it does. What is left over makes the first columns finer: three bytes, or six for a short run.

    Parameters
    ----------
    label
        Name of the run on the page.
    budget
        Bytes of the packed columns; the coarsest form, `COARSEST` bins of each column, may need more.
    first
        Columns that are coarsened last and refined first.
    views
        The attributes ``phases`` and ``extra`` of the stored run.
    """
    names = [*(name for name in first if name in result.names), *(n for n in result.names if n not in first)]
    columns = {name: pack(result[name], SIZES[-1]) for name in names}
    bins = dict.fromkeys(names, 1)
    used = sum(len(packed.data) for packed in columns.values())
    while used > budget and (coarser := [n for n in names if len(result.time) > WIDER * COARSEST * bins[n]]):
        name = max(reversed(coarser), key=lambda n: (-bins[n], names.index(n)))
        bins[name] *= WIDER
        used -= len(columns[name].data)
        columns[name] = pack(extremes(result[name], bins[name]), SIZES[-1])
        used += len(columns[name].data)
    refined = names if len(result.time) <= SHORT else [name for name in names if name in first]
    for name in (name for name in refined if bins[name] == 1):
        for size in SIZES[:-1] if len(result.time) <= SHORTEST else SIZES[1:-1]:
            finer = pack(result[name], size)
            more = len(finer.data) - len(columns[name].data)
            if used + more <= budget:
                used, columns[name] = used + more, finer
                break
    units = {name: result.unit(name) for name in names}
    sizes = {name: rows for name, rows in bins.items() if rows > 1}
    return StoredRun(label, _time(result.time), columns, units, sizes, sorted(result.sample_times), **views)


def _time(time: np.ndarray) -> dict[str, Any]:
    """Communication points for JSON: even ones by start and step, which give the same bits."""
    if len(time) > 1:
        start, step = float(time[0]), (float(time[-1]) - float(time[0])) / (len(time) - 1)
        for candidate in (step, float(f"{step:.12g}"), float(time[1]) - start):
            if np.array_equal(start + np.arange(len(time)) * candidate, time):
                return {"start": start, "step": candidate, "count": len(time)}
    return asdict(pack(time, SIZES[0]))
