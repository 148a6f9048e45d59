"""Compares a run of a public FMU here with that in fmpy."""

from dataclasses import dataclass

import numpy as np

from tests.interop.matrix.compare import relative, rounded_up
from tests.interop.public.process import Examination

BITWISE, DIFFERS, REFUSED, NEITHER, ALONE = "bitwise", "differs", "refused", "neither", "only here"


@dataclass(frozen=True)
class Run:
    """What came of a run.

    Attributes
    ----------
    kind
        `BITWISE`: all rows are equal, bit by bit; `DIFFERS`; `REFUSED`: it runs in fmpy, and not here; `NEITHER`: it
        runs nowhere; `ALONE`: it runs here, and not in fmpy.
    detail
        Why it does not run, the largest difference over its column's largest absolute value, or rows that fmpy alone
        shows.
    rows
        Rows that are compared.
    """

    kind: str
    detail: str = ""
    rows: int = 0


def judged(ours: Examination, theirs: Examination) -> Run:
    """Compare both runs, or say why there is one or none."""
    if ours.out is None:
        return Run(NEITHER if theirs.out is None else REFUSED, ours.failure)
    if theirs.out is None:
        return Run(ALONE, f"fmpy: {theirs.failure}")
    with np.load(ours.out) as mine, np.load(theirs.out) as other:
        rows, expected = mine["rows"], other["rows"]
    more = len(expected) - len(rows)
    if more > 0 and rows.tobytes() == expected[: len(rows)].tobytes():
        detail = f"the FMU ends the simulation, and fmpy shows {more} row{'s' if more > 1 else ''} more"
        return Run(BITWISE, detail, len(rows))
    if rows.shape != expected.shape:
        return Run(DIFFERS, f"{len(rows)} rows, and {len(expected)} in fmpy", len(rows))
    if rows.tobytes() == expected.tobytes():
        return Run(BITWISE, rows=len(rows))
    return Run(DIFFERS, f"by {rounded_up(float(relative(rows, expected).max())):.0e}", len(rows))
