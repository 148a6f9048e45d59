"""Takes times and values out of what a user has: mappings, files, and tables of pandas, xarray and NumPy."""

import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.unit_names import named_unit
from orchestration.fmi.units import UnitDefinition, conversion
from orchestration.master.series_files import read_table
from orchestration.results.columns import TIME, Columns

_HEADER = re.compile(r"(?P<name>.*\S)\s+\[(?P<unit>[^\]]*)\]", re.DOTALL)
_KINDS = (
    "a mapping of names to (time, values), a pandas DataFrame, an xarray Dataset, a structured array of NumPy, a"
    " Result, or the path of a CSV or Parquet file"
)


@dataclass(frozen=True)
class Origin:
    """Where series come from: the words of messages, and the file's name and hash for the metadata."""

    words: str
    file: str = ""
    sha256: str = ""


_INPUTS = Origin("inputs")


class Given(NamedTuple):
    """Times and values of a series as they were given, still unchecked, with the first words of messages about it."""

    subject: str
    time: Any
    values: Any
    unit: str = ""
    origin: Origin = _INPUTS


def series_in(source: Any) -> dict[str, Given | Any]:
    """Return what a source has for each input, by name; values of a mapping that are no arrays are left as they are.

    Raises
    ------
    SystemDescriptionError
        If the source or its time cannot be time series.
    """
    if source is None:
        return {}
    if isinstance(source, str | Path):
        table = read_table(Path(source))
        return _of_columns(table.columns, Origin(str(source), Path(source).name, table.sha256), table.units)
    if isinstance(source, Columns):  # a result, which is a mapping too
        columns = [(TIME, source.time), *zip(source.names, source.rows.T, strict=True)]
        return _of_columns(columns, _INPUTS, source.units)
    if _is_a("pandas", "DataFrame", source):
        return _of_frame(source)
    if _is_a("xarray", "Dataset", source):
        return {str(name): _of_data_array(f"inputs: {name}", source[name]) for name in source.data_vars}
    if isinstance(source, Mapping):
        return {_text(name): value for name, value in source.items()}
    if isinstance(source, np.ndarray) and source.dtype.names:
        return _of_columns([(name, source[name]) for name in source.dtype.names], _INPUTS, {})
    msg = f"inputs: {_shown(source)} is not {_KINDS}."
    raise SystemDescriptionError(msg)


def one_of(subject: str, value: Any) -> Given:
    """Return the times and values of the value that a mapping has for an input.

    Raises
    ------
    SystemDescriptionError
        If the value does not have both.
    """
    if _is_a("pandas", "Series", value) or _is_a("pandas", "DataFrame", value):
        units = value.attrs.get("units", value.attrs.get("unit", ""))
        unit = units.get(value.name, "") if isinstance(units, Mapping) and hasattr(value, "name") else units
        return Given(subject, value.index.to_numpy(), value.to_numpy(), unit if isinstance(unit, str) else "")
    if _is_a("xarray", "DataArray", value):
        return _of_data_array(subject, value)
    if isinstance(value, tuple | list) and len(value) == 2 and all(map(_is_long, value)):
        return Given(subject, value[0], value[1])
    what = "give a constant as a start value, with system.set" if not _is_long(value) else "give its time, too"
    msg = f"{subject}: {_shown(value)} is not (time, values), a TimeSeries, or a column of pandas or xarray; {what}."
    raise SystemDescriptionError(msg)


def _of_columns(
    columns: Iterable[tuple[str, np.ndarray]], origin: Origin, units: Mapping[str, str]
) -> dict[str, Given]:
    """Series of columns; the time is the column called time, or else the first."""
    listed = [(*_header(header), values) for header, values in columns]
    if not listed:
        msg = f"{origin.words}: there are no columns."
        raise SystemDescriptionError(msg)
    first = next((k for k, (name, _, _) in enumerate(listed) if name == TIME), 0)
    name, unit, time = listed.pop(first)
    if "." in name:
        msg = f"{origin.words}: its first column is {name}; the first column, or one called time, must hold the time."
        raise SystemDescriptionError(msg)
    time, found = _in_seconds(origin, time, unit or units.get(name, "")), {}
    for name, unit, values in listed:
        if name in found:
            msg = f"{origin.words}: the column {name} is there twice; give it once."
            raise SystemDescriptionError(msg)
        found[name] = Given(f"{origin.words}: {name}", time, values, unit or units.get(name, ""), origin)
    return found


def _of_frame(frame: Any) -> dict[str, Given]:
    """Series of a DataFrame: the time is its column called time, its index, or else its first column."""
    import pandas as pd

    units = frame.attrs.get("units", {})
    columns = [(str(name), frame.iloc[:, k].to_numpy()) for k, name in enumerate(frame.columns)]
    numbered = isinstance(frame.index, pd.RangeIndex) and frame.index.name is None
    if not numbered and TIME not in [_header(name)[0] for name, _ in columns]:
        name = TIME if frame.index.name is None else str(frame.index.name)
        header = name if _header(name)[0] == TIME else f"{TIME} [{_header(name)[1]}]" if _header(name)[1] else TIME
        columns.insert(0, (header, frame.index.to_numpy()))
    return _of_columns(columns, _INPUTS, units if isinstance(units, Mapping) else {})


def _of_data_array(subject: str, array: Any) -> Given:
    """A series of a DataArray over the coordinate time, or else over its first dimension."""
    if not array.dims:
        msg = f"{subject}: it has no dimension; one over time is needed."
        raise SystemDescriptionError(msg)
    over = TIME if TIME in array.dims else array.dims[0]
    if over not in array.coords:
        msg = f"{subject}: its dimension {over} has no coordinate; give it the times in s."
        raise SystemDescriptionError(msg)
    origin = Origin(subject)
    time = _in_seconds(origin, array[over].to_numpy(), str(array[over].attrs.get("units", "")))
    unit = array.attrs.get("units", array.attrs.get("unit", ""))
    return Given(subject, time, array.transpose(over, ...).to_numpy(), str(unit))


def _in_seconds(origin: Origin, time: np.ndarray, unit: str) -> np.ndarray:
    """Times in s; those in another unit are converted."""
    if unit in ("", "s") or time.dtype.kind not in "fiu":
        return time
    factor = conversion(named_unit(unit), UnitDefinition("s", named_unit("s").meaning))
    if factor is None:
        msg = f"{origin.words}: its time has the unit {unit}, which does not become s; use s, ms or min."
        raise SystemDescriptionError(msg)
    return time * factor[0]


def _header(text: str) -> tuple[str, str]:
    """Name and unit of a column that is called ``name [unit]``, or just ``name``."""
    match = _HEADER.fullmatch(text.strip())
    return (match["name"], match["unit"].strip()) if match else (text.strip(), "")


def _text(name: Any) -> str:
    if isinstance(name, str):
        return name
    msg = f"inputs: the name {name!r} is not a text; component.variable is needed."
    raise SystemDescriptionError(msg)


def _is_a(package: str, kind: str, value: Any) -> bool:
    """Whether a value is of a class of a package, which is not imported for the question."""
    module = sys.modules.get(package)
    return module is not None and isinstance(value, getattr(module, kind))


def _is_long(value: Any) -> bool:
    """Whether a value has elements."""
    return hasattr(value, "__len__") and not isinstance(value, str)


def _shown(value: Any) -> str:
    """A value in few characters."""
    text = f"an array of shape {value.shape}" if isinstance(value, np.ndarray) and value.ndim else repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
