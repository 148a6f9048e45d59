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
MOVING: dict[str, dict[str, Any]] = {
    ".webp": {"quality": 70, "method": 4, "minimize_size": True},
    ".gif": {"optimize": True, "disposal": 1},
}
"""Options of Pillow for moving pictures, by their suffix."""
HASH_SALT = "adaptimp"
"""Makes the names of parts of an SVG file the same in every file."""


def require_picture(
    path: Path, error: type[OrchestrationError] = OrchestrationError, formats: Sequence[str] = FORMATS
) -> str:
    """Return the suffix of a file for a picture, in lower case.

    Parameters
    ----------
    formats
        Suffixes that may be chosen, in lower case.

    Raises
    ------
    OrchestrationError
        Of the type `error`, if no picture is written with this suffix.
    """
    suffix = path.suffix.lower()
    if suffix not in formats:
        found = f"cannot have the suffix {path.suffix}" if path.suffix else "needs a suffix"
        msg = f"{path}: a picture {found}; choose {', '.join(formats)}."
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
