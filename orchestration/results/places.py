"""Where the rows of a run that failed go, and what is said of a file that cannot be written."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from adaptimp_fmu.files.whole_file import LONGEST_NAME, shortened
from orchestration.errors import OrchestrationError


def partial_path(path: Path) -> Path:
    """Return the path for the rows of a run that failed, ``STEM.partial.SUFFIX``; a very long stem is shortened."""
    ending = f".partial{path.suffix}"
    return path.with_name(shortened(path.stem, LONGEST_NAME - len(os.fsencode(ending))) + ending)


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
