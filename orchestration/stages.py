"""Says through Python's logging what takes time: unpacking, compiling, initializing.

A record of level DEBUG says what begins. A record of level INFO says what was done, and how long that took. Nothing
is printed unless a program asks for it:

    logging.basicConfig(level=logging.INFO)
"""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

_LOG = logging.getLogger(__name__)


@contextmanager
def stage(doing: str, done: str | Callable[[], str]) -> Iterator[None]:
    """Log the beginning of what the context does, and its end with the time that it took.

    Parameters
    ----------
    doing
        What begins, such as ``"initializing 5 components"``.
    done
        What was done, such as ``"initialized 5 components"``, or a function that says so at the end. Nothing is
        logged after an exception.
    """
    _LOG.debug("%s", doing)
    started = perf_counter()
    yield
    _LOG.info("%s in %.3g s", done if isinstance(done, str) else done(), perf_counter() - started)
