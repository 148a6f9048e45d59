"""Writes the table of a campaign to a file: CSV, Parquet or NetCDF."""

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.errors import SystemDescriptionError
from orchestration.results.places import write_errors

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

RUN = "run"
"""Dimension of a table without a grid in NetCDF."""


def frame_of(table: "xr.Dataset | pd.DataFrame") -> "pd.DataFrame":
    """The table with one row for each run, factors first."""
    import pandas as pd

    return table if isinstance(table, pd.DataFrame) else table.to_dataframe().reset_index()


def require_file(path: Path | None) -> None:
    """Refuse a folder in the place of the file, before any work is done.

    Raises
    ------
    SystemDescriptionError
        If the path is that of a folder.
    """
    if path is not None and path.is_dir():
        msg = f"{path} is a folder; a file for the table is needed."
        raise SystemDescriptionError(msg)


def write_table(table: "xr.Dataset | pd.DataFrame", path: Path) -> None:
    """Write the table in the format that the suffix names; the file appears when it is complete.

    Parquet and NetCDF keep the units of the measures; NetCDF keeps the grid.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    with write_errors(path):
        write_whole(path, _WRITERS[path.suffix.lower()](table))


def _csv(table: "xr.Dataset | pd.DataFrame") -> bytes:
    return frame_of(table).to_csv(index=False, lineterminator="\n").encode()


def _parquet(table: "xr.Dataset | pd.DataFrame") -> bytes:
    content = BytesIO()
    frame_of(table).to_parquet(content, index=False)
    return content.getvalue()


def _netcdf(table: "xr.Dataset | pd.DataFrame") -> bytes:
    import pandas as pd

    dataset = table.rename_axis(RUN).to_xarray() if isinstance(table, pd.DataFrame) else table
    return bytes(dataset.to_netcdf(engine="scipy"))


_WRITERS = {".csv": _csv, ".parquet": _parquet, ".nc": _netcdf}
