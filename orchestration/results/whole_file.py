"""Writing of files that exist only when they are complete.

A file is written as a draft ``NAME.part`` first. The draft moves to the path of the file at the end.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from orchestration.errors import OrchestrationError


def draft_path(path: Path) -> Path:
    """Return the path of the draft of a file, ``NAME.part``."""
    return path.with_name(path.name + ".part")


def partial_path(path: Path) -> Path:
    """Return the path for the rows of a run that failed, ``STEM.partial.SUFFIX``."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


def remove_draft(path: Path) -> None:
    """Remove the draft of a file, if it exists."""
    with suppress(OSError):
        draft_path(path).unlink(missing_ok=True)


@contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Convert an error of the operating system during writing into an error of this package.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    try:
        yield
    except OSError as error:
        msg = f"{path}: the result cannot be written: {error.strerror or error}; choose another place."
        raise OrchestrationError(msg) from error
