"""Where the rows of a run that failed go, and what is said of a file that cannot be written."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from orchestration.errors import OrchestrationError


def partial_path(path: Path) -> Path:
    """Return the path for the rows of a run that failed, ``STEM.partial.SUFFIX``."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


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
