"""Says what a campaign would do, without doing it: ``adaptimp sweep --dry-run``."""

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.analysis.doctor.finding import counted
from orchestration.campaigns.design.factor import STEP
from orchestration.campaigns.execution.local import worker_count
from orchestration.cli.output import output, width
from orchestration.cli.sweep_report import SweepReport, shown
from orchestration.cli.tables import table
from orchestration.fmi.description import SAMPLE_TIME

if TYPE_CHECKING:
    import pandas as pd

    from orchestration.campaigns.study import Study

PLANNED = "planned"
"""Status of a campaign that was not begun."""
MOST_RUNS = 10_000_000  # whose factors are listed
MOST_VALUES = 5  # of a factor that are shown
_PERIODS = (("days", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0))


def tell_plan(study: "Study", report: SweepReport, workers: int | None) -> None:
    """Print the number of runs and steps, the values of the factors, and how long it would take.

    Of very many runs only the number is printed.
    """
    report.status, report.runs = PLANNED, len(study)
    if len(study) > MOST_RUNS:
        output.say(f"{report.system}: {counted(len(study), 'run')}, too many to list their factors")
        return
    points = study.points
    report.factors = tuple(points.columns)
    output.say(f"{report.system}: {counted(len(points), 'run')}, {_steps(study, points)} ({study.stop_time:g} s)")
    rows = [(name, *_values(points[name].to_numpy())) for name in points.columns]
    output.say(table(("factor", "number", "values"), rows, width(), numbers=("number",), together=2))
    output.say("measures: " + ", ".join(f"{name} [{unit}]" if unit else name for name, unit in study.units.items()))
    one, threads = _time_of_run(study, points), worker_count(workers)
    report.seconds = one * len(points) / threads
    took, all_of_them = _duration(one), _duration(report.seconds)
    output.say(f"One run takes {took} here, so all of them take about {all_of_them} with {counted(threads, 'worker')}.")


def _time_of_run(study: "Study", points: "pd.DataFrame") -> float:
    """Duration of the first run, s; it is made twice, since the first time includes what is compiled once."""
    first: dict[str, Any] = points.iloc[0].to_dict()
    study.evaluate(first)
    began = time.perf_counter()
    study.evaluate(first)
    return time.perf_counter() - began


def _steps(study: "Study", points: "pd.DataFrame") -> str:
    """The number of steps of each run, in words; runs that vary the step have different numbers."""
    lengths = [study.step] if study.step is not None else []
    for name in {SAMPLE_TIME, STEP} & set(points.columns):
        column = points[name].to_numpy()
        lengths = [float(column.max()), float(column.min())]
    numbers = dict.fromkeys(str(round(study.stop_time / length)) for length in lengths)
    return f"{' to '.join(numbers)} steps each"


def _values(column: np.ndarray) -> tuple[str, str]:
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
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"
