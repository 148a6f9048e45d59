"""Changes of values at given times of a run, checked before the run begins."""

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.master.time_grid import Grid
from orchestration.system.sampling import RATIO_TOLERANCE
from orchestration.system.system import System

Changes = Mapping[float, Mapping[str, Any]]
"""Values by ``component.variable``, by the time of the change, s."""


def times_of(changes: Changes) -> list[float]:
    """Return the times of changes, s, in their order.

    Raises
    ------
    SystemDescriptionError
        If a time is not a finite number.
    """
    for time, values in changes.items():
        is_number = isinstance(time, int | float | np.number) and not isinstance(time, bool)
        if not (is_number and math.isfinite(time)):
            msg = f"changes: {time!r} is not a time; a finite number in s is needed."
            raise SystemDescriptionError(msg)
        if not isinstance(values, Mapping):
            msg = f"changes: at t = {time:g} s, {values!r} is not a mapping of component.variable to values."
            raise SystemDescriptionError(msg)
    return sorted(float(time) for time in changes)


def scheduled(
    system: System, changes: Changes, grid: Grid, driven: Collection[str]
) -> dict[int, dict[str, float | bool | str]]:
    """Return the changes by the index of the first communication point at or after each.

    Parameters
    ----------
    changes
        Values by time; of an array one for all elements, or one for each.
    grid
        Communication points of the run.
    driven
        Inputs that take their values from time series.

    Raises
    ------
    SystemDescriptionError
        If a time lies outside of the run, a name or value is wrong, or a variable cannot change during a run.
    """
    found: dict[int, dict[str, float | bool | str]] = {}
    if not changes:
        return found
    plain = System("_", system.components)
    for time in times_of(changes):
        k = _point(grid, time)
        for path, value in changes[time].items():
            elements = system.elements(path)
            require_free(elements, driven)
            for element in elements:
                _require_changeable(system, element)
            changed = plain.set({path: value})
            for element in elements:
                component, variable = changed.resolve(element)
                found.setdefault(k, {})[element] = component.start[variable.name]
    return found


def _point(grid: Grid, time: float) -> int:
    """Return the index of the first point at or after a time, s, from which a step leads on."""
    slack = RATIO_TOLERANCE * max(1.0, abs(time))
    k = int(np.searchsorted(grid.times, time - slack))
    if time < grid.times[0] - slack or k >= grid.n:
        msg = f"changes: t = {time:.9g} s lies outside of the run from {grid.times[0]:.9g} s to {grid.times[-1]:.9g} s."
        if grid.times[0] <= time <= grid.times[-1]:
            msg = (
                f"changes: a change at t = {time:.9g} s would do nothing; the last step begins at"
                f" {grid.times[-2]:.9g} s."
            )
        raise SystemDescriptionError(msg)
    return k


def _require_changeable(system: System, path: str) -> None:
    """Refuse a variable whose value cannot change during a run, or would be overwritten at once."""
    variable = system.resolve(path)[1]
    tunable = variable.causality == "parameter" and variable.variability == "tunable"
    if not tunable and variable.causality != "input":
        kind = (
            f"a {variable.variability} parameter"
            if variable.causality == "parameter"
            else f"of causality {variable.causality}"
        )
        msg = f"changes: {path} is {kind}; only tunable parameters and inputs without a source can change in a run."
        raise SystemDescriptionError(msg)
    if source := system.sources.get(path):
        msg = f"changes: {path} takes its value from {source}, which would overwrite the change."
        raise SystemDescriptionError(msg)


def require_free(values: Collection[str], driven: Collection[str]) -> None:
    """Refuse to change inputs that take their values from time series.

    Raises
    ------
    SystemDescriptionError
        Naming the first of them.
    """
    for path in driven:
        if path in values:
            msg = f"{path} takes its value from a time series, which would overwrite the change."
            raise SystemDescriptionError(msg)
