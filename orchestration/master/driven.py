"""Binds time series to the inputs of a system: names, types, units and span are checked before a run."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import REAL, STRING
from orchestration.fmi.description import Variable
from orchestration.fmi.names import suggestion
from orchestration.fmi.unit_names import named_unit
from orchestration.fmi.units import Linear, conversion
from orchestration.master.kernel import series
from orchestration.master.kernel.series import Column, Form
from orchestration.master.time_series import ERROR, HELD, LINEAR, TimeSeries, series_of
from orchestration.system.system import Component, System

STRAIGHT = 1e-12  # of the largest value by which a point may leave the line through its neighbours and be no bend
SAME_TIME = 1e-9  # by which a series may begin after the start or end before the stop, relative to the larger of 1 s


@dataclass(frozen=True, eq=False)
class DrivenInput:
    """A scalar input that takes its values from a time series.

    Attributes
    ----------
    name
        As ``component.variable``.
    values
        In the unit of the input, float64, shape (n,); a view of the user's array if no unit is converted.
    form
        How values follow from the points.
    given
        The series as the user gave it.
    """

    name: str
    time: np.ndarray
    values: np.ndarray
    form: Form
    given: TimeSeries

    def first_value(self, start: float, step: float) -> float:
        """The value for a first step from a start time, s, of a length, s."""
        if self.form == Form.LINEAR:
            return float(np.interp(start, self.time, self.values))
        reached = np.searchsorted(self.time, series.reached(start, step), side="right")
        return float(self.values[max(0, int(reached) - 1)])

    def corners(self) -> np.ndarray:
        """Times, s, at which the input jumps or bends."""
        if self.form != Form.LINEAR:
            return self.time[1:][np.diff(self.values) != 0]
        if len(self.time) < 3:
            return self.time
        between = self.time[1:-1] - self.time[:-2]
        share = between / (self.time[2:] - self.time[:-2])
        line = self.values[:-2] + share * (self.values[2:] - self.values[:-2])
        bent = np.abs(self.values[1:-1] - line) > STRAIGHT * np.abs(self.values).max()
        return np.concatenate([self.time[:1], self.time[1:-1][bent], self.time[-1:]])


@dataclass(frozen=True, eq=False)
class DrivenInputs:
    """All inputs of a run that take their values from time series."""

    inputs: tuple[DrivenInput, ...] = ()

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self.inputs)

    @property
    def names(self) -> tuple[str, ...]:
        """The inputs as ``component.variable``."""
        return tuple(one.name for one in self.inputs)

    def first_values(self, start: float, step: float) -> dict[str, float]:
        """The values for a first step from a start time, s, of a length, s, by name."""
        return {one.name: one.first_value(start, step) for one in self.inputs}

    def corners(self) -> np.ndarray:
        """Times, s, at which some input jumps or bends, in any order."""
        return np.concatenate([np.empty(0), *(one.corners() for one in self.inputs)])

    def table(self, places: Mapping[str, int]) -> np.ndarray | None:
        """The table for `orchestration.master.kernel.series`, given the addresses of the inputs; None without inputs.

        The table holds addresses of the arrays here, so it must not outlive this object.
        """
        if not self.inputs:
            return None
        table = series.new_table(len(self.inputs))
        for row, one in zip(table[1:], self.inputs, strict=True):
            row[Column.TIMES], row[Column.LAST] = one.time.ctypes.data, len(one.time) - 1
            row[Column.VALUES], row[Column.STRIDE] = one.values.ctypes.data, one.values.strides[0]
            row[Column.FORM], row[Column.PLACE] = one.form, places[one.name]
        return table

    def described(self) -> dict[str, str]:
        """Metadata of a result: JSON of a list with an entry for each input; empty without inputs."""
        if not self.inputs:
            return {}
        return {"inputs": json.dumps([self._described(one) for one in self.inputs], ensure_ascii=False)}

    @cached_property
    def digest(self) -> str:
        """Hash of all points; empty without inputs."""
        return hashlib.sha256(json.dumps(self.described()).encode()).hexdigest() if self.inputs else ""

    @staticmethod
    def _described(one: DrivenInput) -> dict[str, Any]:
        found: dict[str, Any] = {
            "input": one.name,
            "interpolation": LINEAR if one.form == Form.LINEAR else HELD,
            "points": len(one.time),
            "sha256": one.given.sha256 or _hash(one.time, one.values),
        }
        optional = {"unit": one.given.unit, "file": one.given.source}
        return found | {key: value for key, value in optional.items() if value}


def driven_inputs(system: System, source: Any) -> DrivenInputs:
    """Bind what a user gives as ``inputs`` to the inputs of a system.

    Parameters
    ----------
    source
        See `orchestration.simulate`.

    Raises
    ------
    SystemDescriptionError
        If a name, a type, a unit or a shape does not fit, or an input has a source already.
    """
    found: dict[str, DrivenInput] = {}
    given_by: dict[str, str] = {}
    for name, given in series_of(source).items():
        elements = _elements(system, name)
        columns = _columns(name, elements, given)
        for path, values in zip(elements, columns, strict=True):
            if path in found:
                msg = f"inputs: {path} is given twice, by {given_by[path]} and by {name}; give it once."
                raise SystemDescriptionError(msg)
            found[path], given_by[path] = _bound(system, path, given, values), name
    return DrivenInputs(tuple(found.values()))


def require_cover(driven: DrivenInputs, start: float, stop: float) -> None:
    """Refuse a run, in s, that goes beyond the points of a series which is not held outside of them.

    Raises
    ------
    SystemDescriptionError
        Naming the input and both spans.
    """
    for one in driven.inputs:
        slack = SAME_TIME * max(1.0, abs(start), abs(stop))
        first, last = float(one.time[0]), float(one.time[-1])
        if one.given.outside == ERROR and (first > start + slack or last < stop - slack):
            msg = (
                f"inputs: {one.name} is given from {first:.9g} s to {last:.9g} s, but the run goes from {start:.9g} s"
                f' to {stop:.9g} s; give more points, or TimeSeries(..., outside="hold") to hold the end values.'
            )
            raise SystemDescriptionError(msg)


def _elements(system: System, name: str) -> list[str]:
    """The scalar inputs that a name stands for."""
    elements = system.elements(name) if "." in name else [name]
    for path in elements:
        component, _, variable = path.partition(".")
        if component not in system or variable not in system.component(component).description.variables:
            known = [f"{c.name}.{v.name}" for c in system.components for v in c.description.of_causality("input")]
            msg = f"inputs: there is no input {name}; {suggestion(name, known)}"
            raise SystemDescriptionError(msg)
    return elements


def _columns(name: str, elements: Sequence[str], given: TimeSeries) -> list[np.ndarray]:
    """Views of the values for each element."""
    n, k = len(given.time), len(elements)
    scalar = elements == [name]
    if given.values.ndim == 1 and scalar:
        return [given.values]
    if given.values.ndim == 1 or scalar or given.values[0].size != k:
        wanted = f"({n},)" if scalar else f"({n}, {k})"
        msg = f"inputs: {name} takes values of the shape {wanted}, not {given.values.shape}."
        raise SystemDescriptionError(msg)
    return list(given.values.reshape(n, k).T)


def _bound(system: System, path: str, given: TimeSeries, values: np.ndarray) -> DrivenInput:
    """The input of a name with its values, which are checked."""
    component, variable = system.resolve(path)
    if variable.causality != "input":
        fixed = variable.causality == "parameter"
        advice = "set it, or change it in the run with changes=" if fixed else "only inputs take time series"
        msg = f"inputs: {path} is not an input, but of causality {variable.causality}; {advice}."
        raise SystemDescriptionError(msg)
    if variable.type == STRING:
        msg = f"inputs: {path} is a String; only Reals, Integers and Booleans take time series."
        raise SystemDescriptionError(msg)
    if path in system.sources:
        msg = f"inputs: {path} has a source already, {system.sources[path]}; leave out the connection or the series."
        raise SystemDescriptionError(msg)
    scale = _scale(system, component, variable, given)
    values = scale(values)
    if variable.type == REAL:
        chosen = given.interpolation or (HELD if variable.variability == "discrete" else LINEAR)
        return DrivenInput(path, given.time, values, Form.LINEAR if chosen == LINEAR else Form.HELD, given)
    _require_whole(path, variable, given, values)
    return DrivenInput(path, given.time, values, Form.HELD_DISCRETE, given)


def _scale(system: System, component: Component, variable: Variable, given: TimeSeries) -> Linear:
    """The conversion from the unit of a series to that of its input, by the rules of connections."""
    if not given.unit or given.unit == variable.unit:
        return Linear()
    tables = [component.description.units, *(c.description.units for c in system.components)]
    source = named_unit(given.unit, tables)
    found = conversion(source, component.description.unit(variable), relative=variable.relative)
    if found is None:
        path = f"{component.name}.{variable.name}"
        why = "is not known" if source.meaning is None else f"does not become {variable.unit}"
        msg = f"inputs: {path} has the unit {variable.unit}, its series {given.unit}, which {why}."
        raise SystemDescriptionError(msg)
    return Linear(*found)


def _require_whole(path: str, variable: Variable, given: TimeSeries, values: np.ndarray) -> None:
    """Refuse values and interpolations that an Integer or a Boolean cannot have."""
    if given.interpolation == LINEAR:
        msg = f"inputs: {path} is of type {variable.type}, which is held between points; it cannot be linear."
        raise SystemDescriptionError(msg)
    low, high = (-(2.0**31), 2.0**31 - 1) if variable.type != "Boolean" else (0.0, 1.0)
    fits = (values == np.round(values)) & (values >= low) & (values <= high)
    if not fits.all():
        k = int(np.argmin(fits))
        needed = "0 or 1" if variable.type == "Boolean" else "an integer of 32 bits"
        msg = (
            f"inputs: {path} is of type {variable.type}; its value {values[k]:.9g} at t = {given.time[k]:.9g} s"
            f" is not {needed}."
        )
        raise SystemDescriptionError(msg)


def _hash(*arrays: np.ndarray) -> str:
    """SHA-256 of the numbers of some arrays."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array).data)
    return found.hexdigest()
