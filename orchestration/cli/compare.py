"""Compares two files of results, and prints where they differ: ``adaptimp compare``.

Exit codes: 0 all bits agree, 1 the results differ or a file is unusable, 2 they cannot be compared.
"""

import json as formats
import math
from importlib.metadata import version
from pathlib import Path
from typing import Any

from orchestration.cli.codes import ExitCode, exit_code_of
from orchestration.cli.output import output, watched, width
from orchestration.cli.tables import table
from orchestration.errors import OrchestrationError
from orchestration.results.comparison import ColumnDifference, Comparison, verdict_of
from orchestration.results.comparison import compare as compared
from orchestration.results.result import Result

HEAD = ("column", "unit", "largest", "at t", "of range", "first at t", "first row")
MOST_SHOWN = 12  # columns of a table; JSON has all


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


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _json(content: dict[str, Any], code: ExitCode) -> str:
    about = {"version": version("adaptimp")}
    return formats.dumps({**about, **content, "exit_code": int(code)}, indent=2, allow_nan=False)
