"""Reductions of a result with numpy: one number of a run from its rows.

Instants
    A reduction that names no column of a sampled component looks at all rows, each at its time. Any other reduction
    looks at the steps: a column of a sampled component holds in row k + 1 its value over [time[k], time[k + 1]), so
    this value is put together with what all other columns, and the time, are in row k.
"""

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.results.measures.arithmetic import computed
from orchestration.results.measures.expression import Column, Expression, Reduction, Time, walk

if TYPE_CHECKING:
    from orchestration.results.result import Result


def reduced(reduction: Reduction, result: "Result") -> float:
    """Reduce a result to one number, as `Reduction` says.

    Parameters
    ----------
    reduction
        Names columns of numbers, no arrays.
    """
    by_steps = any(isinstance(node, Column) and is_sampled(node.name, result) for node in walk(reduction))
    number = max(0, len(result.time) - 1) if by_steps else len(result.time)
    leaf = partial(_at_instants, result=result, by_steps=by_steps)
    value = np.broadcast_to(computed(reduction.value, leaf), number)
    where = True if reduction.where is None else computed(reduction.where, leaf)
    chosen = np.broadcast_to(where, number)
    time = result.time[:number]
    with np.errstate(all="ignore"):  # what is too large for a double is infinite, as in a program
        if reduction.kind in ("integral", "duration"):
            steps = np.diff(result.time)
            n = len(steps)
            return _summed(reduction.kind, value[:n][chosen[:n]], steps[chosen[:n]])
        return _chosen(reduction.kind, value[chosen], time[chosen])


def is_sampled(name: str, result: "Result") -> bool:
    """Whether a column belongs to a sampled component."""
    return name.partition(".")[0] in result.sample_times


def _at_instants(node: Expression, result: "Result", by_steps: bool) -> np.ndarray:
    """The time or a column at the instants."""
    if isinstance(node, Time):
        return result.time[:-1] if by_steps else result.time
    if not isinstance(node, Column):
        msg = f"{node!r} has no values at the instants of a run."
        raise TypeError(msg)
    column = result[node.name]
    if not by_steps:
        return column
    return column[1:] if is_sampled(node.name, result) else column[:-1]


def _summed(kind: str, values: np.ndarray, steps: np.ndarray) -> float:
    """An integral, or how long a condition holds."""
    return _sum(values * steps) if kind == "integral" else _sum(steps[values])


def _sum(values: np.ndarray) -> float:
    """A sum from first to last, one by one; np.sum adds in pairs."""
    return float(np.add.accumulate(np.concatenate(([0.0], values)))[-1])


def _chosen(kind: str, values: np.ndarray, times: np.ndarray) -> float:
    """A reduction that needs no lengths of steps."""
    if kind in ("first_time", "last_time"):
        values, times = values[values], times[values]
    if not len(values):
        return float("nan")
    found: dict[str, Any] = {
        "max": lambda: values[values.argmax()],
        "min": lambda: values[values.argmin()],
        "time_of_max": lambda: times[values.argmax()],
        "time_of_min": lambda: times[values.argmin()],
        "initial": lambda: values[0],
        "final": lambda: values[-1],
        "first_time": lambda: times[0],
        "last_time": lambda: times[-1],
        "mean": lambda: _sum(values) / len(values),
        "rms": lambda: np.sqrt(_sum(values * values) / len(values)),
        "share": lambda: np.count_nonzero(values) / len(values),
    }
    return float(found[kind]())
