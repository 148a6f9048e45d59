"""Compares two files of results, and prints where they differ: ``adaptimp compare``.

Exit codes: 0 all bits agree, 1 the results differ or a file is unusable, 2 they cannot be compared.
"""

import json as formats
import math
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from orchestration.cli.codes import ExitCode, exit_code_of
from orchestration.cli.output import output, watched, width
from orchestration.cli.tables import table
from orchestration.errors import OrchestrationError
from orchestration.results.comparison import ColumnDifference, Comparison
from orchestration.results.comparison import compare as compared
from orchestration.results.result import Result

HEAD = ("column", "unit", "largest", "at t", "of range", "first at t", "first row")
MOST_SHOWN = 12  # columns of a table; JSON has all
MOST_NAMED = 4


def compare_files(first: Path, second: Path, *, json: bool) -> ExitCode:
    """Print how two results differ, and return the exit code."""
    output.data_only = json
    try:
        with watched() as line:
            line.begin("comparing")
            a, b = Result.read(first), Result.read(second)
            found = compared(a, b)
    except (OrchestrationError, OSError) as error:
        if json:
            code = exit_code_of(error)
            output.data(_json({"first": str(first), "second": str(second), "error": str(error)}, code))
        raise
    same_rows = len(a.time) == len(b.time) == found.n_rows
    code = ExitCode.SUCCESS if found.identical and same_rows else ExitCode.FAILED
    verdict = verdict_of(found, (len(a.time), len(b.time)))
    if json:
        facts = {"first": str(first), "second": str(second), "verdict": verdict, "identical": code == ExitCode.SUCCESS}
        output.data(_json({**facts, **_facts(found, a, b)}, code))
        return code
    _print(found, a)
    output.say(verdict)
    return code


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
            listed = ", ".join(names[:MOST_NAMED]) + (" ..." if len(names) > MOST_NAMED else "")
            apart.append(f"only the {which} has {listed}")
    if set(rows) != {found.n_rows}:
        apart.append(f"{found.n_rows} rows are common to the {rows[0]} and {rows[1]} of the two")
    if apart and found.differences and not differing:
        apart.append("in what both have, all bits agree")
    if apart:
        return f"The results differ: {'; '.join(apart)}."
    return f"The results agree in all bits: {len(found.differences)} columns, {found.n_rows} rows."


def _print(found: Comparison, first: Result) -> None:
    differing = [difference for difference in found.differences if difference.first is not None]
    if not differing:
        return
    rows = [
        (d.name, d.unit, f"{d.largest:.4g}", f"{d.at:.9g}", f"{d.relative:.3g}", f"{d.first:.9g}", str(_row(d, first)))
        for d in differing[:MOST_SHOWN]
    ]
    output.say(table(HEAD, rows, width(), numbers=HEAD[2:], together=2))
    if len(differing) > MOST_SHOWN:
        output.say(f"{len(differing) - MOST_SHOWN} more columns differ; --json lists them.")


def _facts(found: Comparison, first: Result, second: Result) -> dict[str, Any]:
    """For JSON: what differs, by column; a number that is not finite is None."""
    columns = {
        d.name: {
            "unit": d.unit,
            "largest": _finite(d.largest),
            "at": d.at,
            "relative": _finite(d.relative),
            "rms": _finite(d.rms),
            "first": d.first,
            "first_row": _row(d, first),
        }
        for d in found.differences
    }
    return {
        "rows": {"first": len(first.time), "second": len(second.time), "common": found.n_rows},
        "only_in_first": list(found.only_in_first),
        "only_in_second": list(found.only_in_second),
        "columns": columns,
    }


def _row(difference: ColumnDifference, result: Result) -> int | None:
    """Number of the first row of the first result that differs, counted from 0; None if all agree."""
    return None if difference.first is None else int(result.time.searchsorted(difference.first))


def _first_time(difference: ColumnDifference) -> float:
    return math.inf if difference.first is None else difference.first


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _json(content: dict[str, Any], code: ExitCode) -> str:
    about = {"version": version("adaptimp")}
    return formats.dumps({**about, **content, "exit_code": int(code)}, indent=2, allow_nan=False)
