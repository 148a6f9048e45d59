"""Lets errors name what a user knows: a component, or an element of a package, instead of a file in a cache."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from orchestration.errors import OrchestrationError


@contextmanager
def blaming(subject: str, place: Path) -> Iterator[None]:
    """Name a subject instead of a path in the messages of errors of this package.

    Parameters
    ----------
    subject
        What the file at the path is for the user, such as ``loop.ssp: component plant``.
    place
        Path that the user does not know.

    Raises
    ------
    OrchestrationError
        With the path replaced.
    """
    try:
        yield
    except OrchestrationError as error:
        error.args = (str(error).replace(str(place), subject), *error.args[1:])
        raise
