"""Draws the pictures of a campaign, and a page with all of them: ``adaptimp sweep --plot``."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from adaptimp_fmu.files.cache_folder import let_matplotlib_write

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def draw(table: "xr.Dataset | pd.DataFrame", folder: Path) -> list[Path]:
    """Draw a picture of each measure into a folder, and write a page with the pictures and the command.

    Raises
    ------
    OrchestrationError
        If a file cannot be written.
    """
    let_matplotlib_write()
    from orchestration.campaigns.pictures.page import write_page

    return write_page(table, folder, command=shlex.join(["adaptimp", *sys.argv[1:]]))
