"""Files that are whole or not there: written beside their place as ``NAME.part``, then moved."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from orchestration.errors import OrchestrationError


def draft_path(path: Path) -> Path:
    """Where a file grows until it is whole."""
    return path.with_name(path.name + ".part")


def partial_path(path: Path) -> Path:
    """Where the rows of a run that failed are kept, ``STEM.partial.SUFFIX``."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


def remove_draft(path: Path) -> None:
    """Remove the draft of a file, if there is one."""
    with suppress(OSError):
        draft_path(path).unlink(missing_ok=True)


@contextmanager
def write_errors(path: Path) -> Iterator[None]:
    """Turn what the operating system refuses into an error of this package.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    try:
        yield
    except OSError as error:
        msg = f"{path}: the result cannot be written: {error.strerror or error}."
        raise OrchestrationError(msg) from error
