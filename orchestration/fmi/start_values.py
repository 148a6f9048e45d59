"""When the start values of an FMU are set: those of inputs in initialization mode, all others before it."""

from collections.abc import Mapping
from typing import TypeVar

from orchestration.fmi.description import Description

Value = TypeVar("Value")


def by_time(
    description: Description, given: Mapping[str, Value]
) -> tuple[dict[str, Value], dict[str, Value | float | str]]:
    """Split start values by the time at which FMI 2.0.4, section 4.2.4, lets them be set.

    Parameters
    ----------
    given
        Start values by the name of a variable, or of an array.

    Returns
    -------
    tuple
        Values to set before initialization mode, and values of inputs to set in it. Inputs that are not given have the
        start value that the description declares, which the library need not have.
    """
    inputs = [*description.of_causality("input"), *description.texts("input")]
    called = {v.name: (v.name, v.name.partition("[")[0]) for v in inputs}  # an element also by its array
    names = {name for both in called.values() for name in both}
    before = {name: value for name, value in given.items() if name not in names}
    driven = {name: value for name, value in given.items() if name in names}
    declared = {v.name: v.start for v in inputs if v.start is not None and driven.keys().isdisjoint(called[v.name])}
    return before, declared | driven
