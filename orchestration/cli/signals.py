"""The signals of a run or of a file with their smallest, largest and last values, for readers and for programs."""

import math
from collections.abc import Mapping
from typing import Any

from orchestration.cli.tables import table
from orchestration.results.extremes import Extremes

HEAD = ("signal", "unit", "min", "max", "final")


def signal_table(records: Mapping[str, Mapping[str, Any]], width: int) -> str:
    """A table of signals, from what `signal_record` returns."""
    rows = [
        (name, record["unit"], *("" if record[key] is None else f"{record[key] + 0.0:.6g}" for key in HEAD[2:]))
        for name, record in records.items()  # + 0.0: no -0
    ]
    return table(HEAD, rows, width, numbers=HEAD[2:], together=2)


def signal_record(found: Extremes) -> dict[str, dict[str, Any]]:
    """For JSON: unit, min, max and final by signal; a number that is not finite, or not there, is None."""
    return {
        name: {"unit": found.units.get(name, ""), **dict(zip(HEAD[2:], map(_finite, values), strict=True))}
        for name, *values in zip(found.names, found.smallest, found.largest, found.last, strict=True)
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
