"""Says what a campaign would do, without doing it: ``adaptimp sweep --dry-run``."""

import time
from typing import TYPE_CHECKING, Any

from orchestration.analysis.doctor.finding import counted
from orchestration.campaigns.local import worker_count
from orchestration.cli.output import output, width
from orchestration.cli.sweep_report import SweepReport, shown
from orchestration.cli.tables import table

if TYPE_CHECKING:
    import pandas as pd

    from orchestration.campaigns.study import Study

PLANNED = "planned"
"""Status of a campaign that was not begun."""
MOST_VALUES = 5  # of a factor that are shown
_PERIODS = (("days", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0))


def tell_plan(study: "Study", report: SweepReport, workers: int | None) -> None:
    """Print the number of runs and steps, the values of the factors, and how long it would take.

    The first run is made twice to see how long it takes: the first time includes what is compiled once.
    """
    points = study.points
    report.status, report.runs, report.factors = PLANNED, len(points), tuple(points.columns)
    steps = round(study.stop_time / study.step)
    output.say(f"{report.system}: {counted(len(points), 'run')}, {steps} steps each ({study.stop_time:g} s)")
    rows = [(name, *_values(points[name])) for name in points.columns]
    output.say(table(("factor", "number", "values"), rows, width(), numbers=("number",), together=2))
    output.say("measures: " + ", ".join(f"{name} [{unit}]" if unit else name for name, unit in study.units.items()))
    first: dict[str, Any] = points.iloc[0].to_dict()
    study.evaluate(first)
    began = time.perf_counter()
    study.evaluate(first)
    one = time.perf_counter() - began
    cores = worker_count(workers)
    report.seconds = one * len(points) / cores
    output.say(
        f"One run takes {_duration(one)} here, so all of them take about {_duration(report.seconds)}"
        f" with {counted(cores, 'worker')}."
    )


def _values(column: "pd.Series") -> tuple[str, str]:
    """How many values a factor has, and the values; of many the first ones and the last one."""
    values = list(dict.fromkeys(column.tolist()))
    if len(values) > MOST_VALUES:
        ends = sorted(values)
        return str(len(values)), f"{shown(ends[0])} to {shown(ends[-1])}"
    return str(len(values)), ", ".join(map(shown, values))


def _duration(seconds: float) -> str:
    """A duration in a fitting unit."""
    for unit, length in _PERIODS:
        if seconds >= 2 * length:
            return f"{seconds / length:.3g} {unit}"
    return f"{seconds:.2g} s" if seconds >= 1 else f"{1e3 * seconds:.2g} ms"
