"""Keeps exceptions that Python code raises while an FMU or a compiled loop calls it, until that call has returned.

C code cannot pass on an exception of Python. ctypes would print the exception and drop it, Ctrl-C included.
"""

from collections.abc import Callable
from threading import local

from orchestration.fmi.codes import Status


class _Kept(local):
    """Exceptions of this thread."""

    def __init__(self) -> None:
        self.raised: list[BaseException] = []


_kept = _Kept()


def deferring(work: Callable[[], int]) -> int:
    """Return the fmi2Status of `work`, or fmi2Error if it raises an exception, which is kept.

    An interrupt is kept too, and `work` is done again: the call is completed, so that the run ends between two steps.
    """
    while True:
        try:
            return work()
        except KeyboardInterrupt as interrupt:
            _kept.raised.append(interrupt)
        except Exception as error:
            _kept.raised.append(error)
            return int(Status.ERROR)


def keep(error: BaseException) -> None:
    """Keep an exception until `raise_kept`."""
    _kept.raised.append(error)


def raise_kept() -> None:
    """Raise the first exception that was kept in this thread, and forget the others.

    Raises
    ------
    BaseException
    """
    if _kept.raised:
        first = _kept.raised[0]
        _kept.raised.clear()
        raise first
