"""The signals of a run or of a file with their smallest, largest and last values, for readers and for programs."""

import math
from collections.abc import Mapping
from typing import Any

from orchestration.cli.tables import table
from orchestration.results.extremes import Extremes

HEAD = ("signal", "unit", "min", "max", "final")


def signal_table(records: Mapping[str, Mapping[str, Any]], width: int) -> str:
    """A table of signals, from what `signal_record` returns."""
    rows = [(name, record["unit"], *(_cell(record[key]) for key in HEAD[2:])) for name, record in records.items()]
    return table(HEAD, rows, width, numbers=HEAD[2:], together=2)


def signal_record(found: Extremes) -> dict[str, dict[str, Any]]:
    """For JSON: unit, min, max and final by signal; a number that is not finite, or not there, is None.

    The final value of a String is a text.
    """
    texts = {name: {"unit": "", "min": None, "max": None, "final": text} for name, text in found.texts.items()}
    numbers = {
        name: {"unit": found.units.get(name, ""), **dict(zip(HEAD[2:], map(_finite, values), strict=True))}
        for name, *values in zip(found.names, found.smallest, found.largest, found.last, strict=True)
    }
    return numbers | texts


def _cell(value: float | str | None) -> str:
    if value is None or isinstance(value, str):
        return value or ""
    return f"{value + 0.0:.6g}"  # + 0.0: no -0


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
