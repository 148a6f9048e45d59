"""A time series: values over time that an input of a system takes from measured or computed data.

simulate(system, inputs={"plant.F": TimeSeries(t, F, unit="kN"), "plant.on": (t, on)})
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.master.series_sources import Given, one_of, series_in

HELD, LINEAR = "held", "linear"
ERROR, HOLD = "error", "hold"
SUBJECT = "A time series"
"""First words of the messages about a series that does not know its input."""


@dataclass(frozen=True, eq=False, repr=False)
class TimeSeries:
    """Values over time for an input of a system, or for an array of inputs.

    Attributes
    ----------
    time
        Times of the points, s, shape (n,), increasing. A numpy.timedelta64 is converted.
    values
        Values, shape (n,), or (n, k) for an array of k inputs. Arrays of float64 are not copied.
    interpolation
        ``"held"``: a value holds until the next point. ``"linear"``: straight lines between the points. Default:
        linear for a Real input, held for an input that is Integer, Boolean or declared as discrete.
    unit
        Physical unit of the values, such as ``"kN"``, which is converted to the unit of the input. Default: the unit
        of the input.
    outside
        What the input shows before the first and after the last point. ``"error"`` refuses a run that goes beyond the
        points; ``"hold"`` holds the first and the last value.
    source, sha256
        Name and hash of the file that the values come from, for the metadata of a result.

    Raises
    ------
    SystemDescriptionError
        If there are no points, shapes do not fit, times do not increase, a number is not finite, or a choice is
        unknown.

    Examples
    --------
    >>> import numpy as np
    >>> from orchestration import TimeSeries
    >>> t = np.linspace(0.0, 1.0, 11)
    >>> TimeSeries(t, 2.0 * t, interpolation="held", unit="kN")
    <TimeSeries: 11 points, t = 0 to 1 s, held, in kN>
    """

    time: np.ndarray
    values: np.ndarray
    interpolation: str | None = None
    unit: str = ""
    outside: str = ERROR
    source: str = field(default="", compare=False)
    sha256: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        """Convert both arrays to float64, and refuse what cannot be a time series."""
        object.__setattr__(self, "time", np.ascontiguousarray(_numbers("times", self.time), np.float64))
        object.__setattr__(self, "values", np.asarray(_numbers("values", self.values), np.float64))
        if fault := _fault(self.time, self.values):
            msg = f"{SUBJECT}: {fault}"
            raise SystemDescriptionError(msg)
        for what, value, known in (
            ("interpolation", self.interpolation, (None, HELD, LINEAR)),
            ("choice outside of the points", self.outside, (ERROR, HOLD)),
        ):
            if value not in known:
                there_are = " and ".join(repr(choice) for choice in known if choice)
                msg = f"{SUBJECT}: there is no {what} {value!r}; there are {there_are}."
                raise SystemDescriptionError(msg)

    def __repr__(self) -> str:
        """Number of points, time span, and choices."""
        shape = f" of {' x '.join(map(str, self.values.shape[1:]))} values" if self.values.ndim > 1 else ""
        said = [f"t = {self.time[0]:g} to {self.time[-1]:g} s"]
        said += [text for text in (self.interpolation, f"in {self.unit}" if self.unit else "") if text]
        said += [f"from {self.source}"] if self.source else []
        return f"<TimeSeries: {len(self.time)} points{shape}, {', '.join(said)}>"

    @classmethod
    def read(
        cls,
        source: Any,
        *,
        interpolation: str | None = None,
        outside: str | None = None,
        units: Mapping[str, str] | None = None,
    ) -> "dict[str, TimeSeries]":
        """Read the columns of a file or a table, with the same choices for all.

        Parameters
        ----------
        source
            Whatever `simulate` takes as ``inputs``: the path of a CSV or Parquet file, a pandas DataFrame, an xarray
            Dataset, a structured array of NumPy, a `Result`, or a mapping.
        interpolation, outside
            As of the class; those of the source if None.
        units
            Unit by name of a column, instead of what the source says.

        Returns
        -------
        dict
            Series by ``component.variable``.

        Raises
        ------
        SystemDescriptionError
            If the source cannot be read as time series.

        Examples
        --------
        >>> import numpy as np
        >>> from orchestration import TimeSeries
        >>> table = np.array([(0.0, 1.0), (0.1, 3.0)], [("time", float), ("plant.u", float)])
        >>> TimeSeries.read(table, interpolation="held", units={"plant.u": "mm"})
        {'plant.u': <TimeSeries: 2 points, t = 0 to 0.1 s, held, in mm>}
        """
        found = series_of(source)
        units = dict(units or {})
        for name in units:
            if name not in found:
                msg = f"units: there is no series {name}; there are {', '.join(list(found)[:4])}."
                raise SystemDescriptionError(msg)
        given = {"interpolation": interpolation, "outside": outside}
        changes = {name: value for name, value in given.items() if value is not None}
        return {name: replace(one, unit=units.get(name, one.unit), **changes) for name, one in found.items()}


def series_of(source: Any) -> dict[str, TimeSeries]:
    """Return time series by ``component.variable`` of whatever `simulate` takes as ``inputs``.

    Raises
    ------
    SystemDescriptionError
        If the source, its time or a column cannot be a time series.
    """
    return {name: _made(f"inputs: {name}", given) for name, given in series_in(source).items()}


def _made(subject: str, value: Any) -> TimeSeries:
    """A time series; an error begins with the subject."""
    if isinstance(value, TimeSeries):
        return value
    given = value if isinstance(value, Given) else one_of(subject, value)
    origin = given.origin
    try:
        return TimeSeries(given.time, given.values, unit=given.unit, source=origin.file, sha256=origin.sha256)
    except SystemDescriptionError as error:
        msg = f"{given.subject}{str(error).removeprefix(SUBJECT)}"
        raise SystemDescriptionError(msg) from error


def _numbers(what: str, given: Any) -> np.ndarray:
    """Times or values as an array of numbers; differences of times become seconds."""
    try:
        array = np.asarray(given)
    except ValueError as error:
        msg = f"{SUBJECT}: its {what} do not form an array, because their lengths differ."
        raise SystemDescriptionError(msg) from error
    if array.dtype.kind == "m" and what == "times":
        return array / np.timedelta64(1, "s")
    if array.dtype.kind not in "fiub":
        example = str(array.ravel()[0]) if array.size else array.dtype
        of_time = ", in s from the start of the run" if what == "times" else ""
        msg = f"{SUBJECT}: its {what} are not numbers, but such as {example!r}; give floats{of_time}."
        raise SystemDescriptionError(msg)
    return array


def _fault(time: np.ndarray, values: np.ndarray) -> str | None:
    """What makes two arrays no time series, as the rest of a sentence; None if nothing does."""
    if time.ndim != 1:
        return f"its time has the shape {time.shape}; (n,) is needed."
    if not time.size:
        return "it has no points; at least one is needed."
    if not values.ndim or len(values) != len(time):
        n = len(values) if values.ndim else 1
        return f"it has {len(time)} times, but {n} value{'s' * (n != 1)}; one value for each time is needed."
    if not np.isfinite(time).all():
        k = int(np.argmin(np.isfinite(time)))
        return f"its time is {time[k]} at point {k}; finite times in s are needed."
    steps = np.diff(time)
    if not (steps > 0).all():
        k = int(np.argmin(steps > 0))
        return f"its time goes from {time[k]:.9g} s to {time[k + 1]:.9g} s at point {k + 1}; times must increase."
    finite = np.isfinite(values).reshape(len(time), -1).all(axis=1)
    if not finite.all():
        k = int(np.argmin(finite))
        wrong = values[k] if values.ndim == 1 else values[k][~np.isfinite(values[k])][0]
        return f"its value is {wrong} at t = {time[k]:.9g} s (point {k}); fill or drop such points first."
    return None
