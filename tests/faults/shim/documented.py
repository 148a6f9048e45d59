"""Reads docs/misbehaviour.md: what comes of each fault, and which functions each algorithm calls."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from orchestration.master.algorithm import ALGORITHMS, DIRECTIONAL, NEWTON, PARALLEL, Algorithm, Correction

PAGE = Path(__file__).parents[3] / "docs" / "misbehaviour.md"
RUNS = {
    **ALGORITHMS,
    "directional": Algorithm("directional", PARALLEL, correction=Correction(NEWTON, jacobian=DIRECTIONAL)),
}
"""The algorithms that are tried: those that have a name, and Newton's method with directional derivatives."""
COMPLETE, FAILED, KILLED, ENDED, HANGS = "complete", "failed", "killed", "ended", "hangs"
CONTAINED = "contained"


@dataclass(frozen=True)
class Call:
    """A function that runs call.

    Attributes
    ----------
    algorithms
        Names of the algorithms that call it.
    refused
        What comes of a status that is worse than a warning.
    rows
        ``none``, ``some`` or ``all``: the rows that a failed run has.
    """

    function: str
    algorithms: tuple[str, ...]
    refused: str
    rows: str


@cache
def outcomes(*, isolated: bool = False) -> dict[str, str]:
    """What comes of each fault, by the fault's word."""
    return {row[0].strip("`"): row[3 if isolated else 2] for row in _table("fault")}


@cache
def calls() -> dict[str, Call]:
    """The functions that runs call, by name."""
    return {call.function: call for call in map(_call, _table("function"))}


def expected(fault: str, function: str, algorithm: str, *, isolated: bool = False) -> str:
    """What the page says of a fault in a function under an algorithm."""
    call = calls().get(function)
    if call is None or algorithm not in call.algorithms:
        return COMPLETE
    outcome = outcomes(isolated=isolated)[fault]
    return call.refused if outcome == FAILED else outcome


def _call(row: list[str]) -> Call:
    algorithms = tuple(RUNS) if row[1] == "all" else tuple(row[1].split(", "))
    rows = "none" if "before the first row" in row[2] else "all" if "all rows" in row[2] else "some"
    return Call(row[0].strip("`"), algorithms, row[2].replace(",", " ").replace(";", " ").split()[0], rows)


def _table(first: str) -> list[list[str]]:
    """Cells of the table whose first column has a title."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith(f"| {first} |")) + 2
    rows = []
    for line in lines[begin:]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows
