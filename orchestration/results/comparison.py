"""Two results side by side: how far columns differ, and where they differ first."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.fmi.given import require_type
from orchestration.fmi.names import MOST_NEAR
from orchestration.results.columns import Columns

if TYPE_CHECKING:
    import pandas as pd

SAME_INSTANT = 1e-9
"""Two communication points are one if they differ by less than this, relative to the larger of 1 s and the time."""

MOST_LISTED = 4  # names in a sentence


@dataclass(frozen=True)
class ColumnDifference:
    """How a column of one result differs from that of another.

    Attributes
    ----------
    largest
        Largest absolute difference, in the unit of the column. Texts that differ count as infinitely different.
    at
        Time of the largest difference, s.
    relative
        The largest difference over the range of the first result's column; infinite if that is constant.
    rms
        Root of the mean square of the difference, in the unit of the column.
    first
        Time of the first row in which a bit differs, s; None if all bits agree.

    Examples
    --------
    >>> from orchestration import compare, scenario, simulate
    >>> system = scenario("fig2")
    >>> comparison = compare(simulate(system, 0.5), simulate(system, 0.5, algorithm="jacobi"))
    >>> tip = next(d for d in comparison.differences if d.name == "plant.x[2]")
    >>> f"{tip.largest:.1e} {tip.unit} at {tip.at:g} s, first at {tip.first:g} s"
    '2.8e-04 m at 0.1204 s, first at 0.0002 s'
    """

    name: str
    unit: str
    largest: float
    at: float
    relative: float
    rms: float
    first: float | None


@dataclass(frozen=True)
class Comparison:
    """The outcome of `compare`.

    Attributes
    ----------
    differences
        One entry for each column that both results have, the largest relative difference first.
    n_rows
        Number of communication points that both results have.
    only_in_first, only_in_second
        Columns that the other result lacks.

    Examples
    --------
    >>> from orchestration import compare, scenario, simulate
    >>> system = scenario("fig2")
    >>> reference = simulate(system, stop_time=0.1)
    >>> compare(reference, simulate(system, stop_time=0.1)).identical
    True
    >>> comparison = compare(reference, simulate(system, stop_time=0.1, algorithm="jacobi"))
    >>> comparison.identical, comparison.worst.name
    (False, 'actuator.tau[2]')
    >>> float(comparison.to_pandas()["largest"]["plant.x[1]"].round(6))  # m
    0.000142
    """

    differences: tuple[ColumnDifference, ...]
    n_rows: int
    only_in_first: tuple[str, ...] = ()
    only_in_second: tuple[str, ...] = ()

    @property
    def identical(self) -> bool:
        """Whether both have the same columns, and all bits of all common rows agree."""
        alone = self.only_in_first or self.only_in_second
        return not alone and all(difference.first is None for difference in self.differences)

    @property
    def worst(self) -> ColumnDifference:
        """The column with the largest relative difference.

        Raises
        ------
        OrchestrationError
            If the results have no common column.
        """
        if not self.differences:
            names = f"{_some(self.only_in_first)}, and {_some(self.only_in_second)}"
            msg = f"The results have no common column: {names}; record the same outputs in both runs."
            raise OrchestrationError(msg)
        return self.differences[0]

    def to_pandas(self) -> "pd.DataFrame":
        """One row for each column, with the attributes of `ColumnDifference`."""
        import pandas as pd

        columns = ("unit", "largest", "at", "relative", "rms", "first")
        rows = [[getattr(d, column) for column in columns] for d in self.differences]
        return pd.DataFrame(rows, index=[d.name for d in self.differences], columns=list(columns))

    def __repr__(self) -> str:
        """One line: identical, or the worst column."""
        head = f"<Comparison: {len(self.differences)} columns, {self.n_rows} rows"
        if self.identical or not self.differences:
            return f"{head}, {'all bits agree' if self.identical else 'no common column'}>"
        worst = self.worst
        size = f"{worst.largest:.3g} {worst.unit}".strip()
        return f"{head}; worst: {worst.name} by {size} at t = {worst.at:.6g} s ({worst.relative:.2g} of its range)>"

    def _repr_html_(self) -> str:
        from orchestration.fmi.display import html_table

        head = ("column", "unit", "largest difference", "at (s)", "of its range", "first differs (s)")
        rows = [
            (d.name, d.unit, d.largest, d.at, d.relative, "-" if d.first is None else d.first) for d in self.differences
        ]
        return html_table(head, rows)


def compare(first: Columns, second: Columns) -> Comparison:
    """Compare two results at the communication points that both have.

    Parameters
    ----------
    first, second
        Results; the second is measured against the first.

    Raises
    ------
    OrchestrationError
        If no communication point is common.

    Examples
    --------
    >>> import numpy as np
    >>> from orchestration import Result, compare
    >>> time, names = np.array([0.0, 0.1]), ("a.y",)
    >>> compare(Result(time, names, np.array([[0.0], [1.0]])), Result(time, names, np.array([[0.0], [1.5]])))
    <Comparison: 1 columns, 2 rows; worst: a.y by 0.5 at t = 0.1 s (0.5 of its range)>
    """
    for which, columns in (("first", first), ("second", second)):
        require_type(f"The {which} result to compare", columns, Columns, "give a Result", OrchestrationError)
    rows, others = common_rows(first.time, second.time)
    if not len(rows):
        spans = " and ".join(
            f"{c.time[0]:g} to {c.time[-1]:g} s" if len(c.time) else "no rows" for c in (first, second)
        )
        msg = f"The results have no common communication point: {spans}; compare runs over the same time."
        raise OrchestrationError(msg)
    places = {name: j for j, name in enumerate(second.names)}
    found = [
        _difference(name, first, (first.rows[rows, i], second.rows[others, places[name]]), first.time[rows])
        for i, name in enumerate(first.names)
        if name in places
    ]
    both = [name for name in first.texts if name in second.texts]
    found += [_of_texts(name, first.texts[name][rows], second.texts[name][others], first.time[rows]) for name in both]
    return Comparison(
        tuple(sorted(found, key=lambda d: -d.relative if d.relative == d.relative else -np.inf)),
        len(rows),
        _missing(first, second),
        _missing(second, first),
    )


def verdict_of(found: Comparison, rows: Sequence[int]) -> str:
    """Say in one sentence whether two results agree.

    Parameters
    ----------
    rows
        Number of rows of both results.
    """
    differing = [difference for difference in found.differences if difference.first is not None]
    apart = []
    if differing:
        worst, first = differing[0], min(differing, key=_first_time)
        many = f"{len(differing)} of {len(found.differences)} common columns differ"
        share = f", {worst.relative:.2g} of its range" if math.isfinite(worst.relative) else ""
        size = f"{worst.largest:.3g} {worst.unit}".rstrip()
        apart.append(f"{many}, {worst.name} most, by {size}{share}, and {first.name} first, at t = {first.first:.9g} s")
    for which, names in (("first", found.only_in_first), ("second", found.only_in_second)):
        if names:
            listed = ", ".join(names[:MOST_LISTED]) + (" ..." if len(names) > MOST_LISTED else "")
            apart.append(f"only the {which} has {listed}")
    if set(rows) != {found.n_rows}:
        apart.append(f"{found.n_rows} rows are common to the {rows[0]} and {rows[1]} of the two")
    if apart and found.differences and not differing:
        apart.append("in what both have, all bits agree")
    if apart:
        return f"The results differ: {'; '.join(apart)}."
    return f"The results agree in all bits: {len(found.differences)} columns, {found.n_rows} rows."


def _first_time(difference: ColumnDifference) -> float:
    return math.inf if difference.first is None else difference.first


def _missing(first: Columns, second: Columns) -> tuple[str, ...]:
    """Columns of the first result that the second one lacks."""
    numbers, texts = set(second.names), second.texts
    return (*(n for n in first.names if n not in numbers), *(name for name in first.texts if name not in texts))


def _of_texts(name: str, a: np.ndarray, b: np.ndarray, times: np.ndarray) -> ColumnDifference:
    """How a column of texts differs from another."""
    unequal = a != b
    at = float(times[np.argmax(unequal)])
    size = np.inf if unequal.any() else 0.0
    return ColumnDifference(name, "", size, at, size, size, at if unequal.any() else None)


def _some(names: tuple[str, ...]) -> str:
    return ", ".join(names[:MOST_NEAR]) + (" ..." if len(names) > MOST_NEAR else "") if names else "none"


def common_rows(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the rows of the instants that both have, in either.

    Parameters
    ----------
    a, b
        Increasing times, s.
    """
    if not (len(a) and len(b)):
        return np.zeros(0, int), np.zeros(0, int)
    after = np.clip(np.searchsorted(b, a), 1, len(b) - 1) if len(b) > 1 else np.zeros(len(a), int)
    before = np.maximum(after - 1, 0)
    nearest = np.where(np.abs(b[before] - a) <= np.abs(b[after] - a), before, after)
    same = np.abs(b[nearest] - a) <= SAME_INSTANT * np.maximum(1.0, np.abs(a))
    return np.flatnonzero(same), nearest[same]


def _difference(
    name: str, columns: Columns, pair: tuple[np.ndarray, np.ndarray], times: np.ndarray
) -> ColumnDifference:
    a, b = pair
    unequal = np.ascontiguousarray(a).view(np.int64) != np.ascontiguousarray(b).view(np.int64)
    both_nan = np.isnan(a) & np.isnan(b)
    gap = np.where(both_nan | (a == b), 0.0, np.abs(a - b))
    k = int(np.argmax(np.where(np.isnan(gap), np.inf, gap)))
    span = float(np.ptp(a))
    largest = float(gap[k])
    relative = 0.0 if largest == 0.0 else largest / span if span > 0.0 else np.inf
    first = float(times[np.argmax(unequal)]) if unequal.any() else None
    unit = columns.units.get(name, "")
    return ColumnDifference(name, unit, largest, float(times[k]), relative, float(np.sqrt(np.mean(gap**2))), first)
