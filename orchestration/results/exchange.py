"""Results in the hands of other libraries: pandas and xarray."""

from typing import TYPE_CHECKING, Any

from orchestration.fmi.names import arrays, base_name
from orchestration.results.columns import TIME

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from orchestration.results.result import Result


def to_pandas(result: "Result") -> "pd.DataFrame":
    """A DataFrame with the index ``time``; see `Result.to_pandas`."""
    import pandas as pd

    frame = pd.DataFrame(result.rows, index=pd.Index(result.time, name=TIME), columns=list(result.names))
    for name, texts in result.texts.items():
        frame[name] = texts
    units = {TIME: "s", **result.units}
    said = {"metadata": dict(result.metadata), "status": result.status, "message": result.message}
    frame.attrs = {"units": units, **said}
    return frame


def to_xarray(result: "Result") -> "xr.Dataset":
    """A Dataset with one variable for each column or array; see `Result.to_xarray`."""
    import xarray as xr

    whole = arrays(tuple(result))
    names = dict.fromkeys(base_name(name) if base_name(name) in whole else name for name in result)
    variables: dict[str, Any] = {}
    for name in names:
        values = result[name]
        dimensions = [f"{name}_{axis}" for axis in range(1, values.ndim)]
        variables[name] = ((TIME, *dimensions), values, {"units": result.unit(name)})
    coordinates: dict[str, Any] = {TIME: (TIME, result.time, {"units": "s"})}
    for name in names:
        for axis, size in enumerate(result[name].shape[1:], start=1):
            coordinates[f"{name}_{axis}"] = range(1, size + 1)
    attributes = {**result.metadata, "status": result.status, "message": result.message}
    return xr.Dataset(variables, coordinates, attributes)
