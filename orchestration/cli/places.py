"""Makes the folders that commands write to, and says what was written."""

import tempfile
from pathlib import Path

from orchestration.errors import OrchestrationError


def require_folder(folder: Path, option: str = "--out") -> None:
    """Make a folder for results; a folder that nothing can be written to is refused before any work is done.

    Parameters
    ----------
    option
        Option that the folder comes from, which an error names.

    Raises
    ------
    OrchestrationError
        If the folder cannot be made, or nothing can be written to it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        msg = f"{option}: nothing can be written to {folder}: {error.strerror}; choose another place."
        raise OrchestrationError(msg) from error


def written(path: Path, *, existed: bool) -> str:
    """The beginning of a sentence on a file that was written."""
    return f"{'replaced' if existed else 'wrote'} {path}"
