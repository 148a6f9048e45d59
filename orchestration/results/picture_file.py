"""Writes pictures to files: which formats there are, and how the same picture becomes the same bytes."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from adaptimp_fmu.files.whole_file import whole_file
from orchestration.errors import OrchestrationError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")
METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Creator": None, "Date": None},
    ".pdf": {"Creator": None, "Producer": None, "CreationDate": None},
}
"""What matplotlib leaves out of a file, by its suffix: dates and versions, which differ between equal pictures."""
HASH_SALT = "adaptimp"
"""Makes the names of parts of an SVG file the same in every file."""


def require_picture(
    path: Path, error: type[OrchestrationError] = OrchestrationError, *, more: Sequence[str] = ()
) -> str:
    """Return the suffix of a file for a picture, in lower case.

    Parameters
    ----------
    more
        Suffixes besides those of pictures that the error is to offer.

    Raises
    ------
    OrchestrationError
        Of the type `error`, if no picture is written with this suffix.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        known = ", ".join((*FORMATS, *more))
        msg = f"{path}: a picture cannot have the suffix {path.suffix or 'of nothing'}; choose {known}."
        raise error(msg)
    return suffix


def save(figure: "Figure", path: Path, error: type[OrchestrationError] = OrchestrationError) -> None:
    """Write a figure, in the format that the suffix names; its folder is made where there is none.

    Raises
    ------
    OrchestrationError
        Of the type `error`, if the suffix is unknown, or the file cannot be written.
    """
    suffix = require_picture(path, error)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as file:
            figure.savefig(file, format=suffix[1:], metadata=METADATA[suffix])
    except OSError as reason:
        msg = f"{path}: the picture cannot be written: {reason.strerror or reason}; choose another place."
        raise error(msg) from reason
