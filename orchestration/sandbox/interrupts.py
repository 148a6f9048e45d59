"""Lets Ctrl-C wait while compiled code or another process is called.

Python raises a KeyboardInterrupt wherever it has control next. That may be in a function which compiled code has called
back, and there the exception would be lost. So Ctrl-C is noted meanwhile, and raised afterwards.
"""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread

_asked: list[int] = []


@contextmanager
def noted() -> Iterator[None]:
    """Note Ctrl-C within the context, and raise it at the end; only in the main thread, which receives it.

    Raises
    ------
    KeyboardInterrupt
        At the end, in place of any other exception.
    """
    usual = signal.getsignal(signal.SIGINT)
    if current_thread() is not main_thread() or usual is not signal.default_int_handler:
        yield
        return
    _asked.clear()
    signal.signal(signal.SIGINT, _note)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if _asked:
            _asked.clear()
            raise KeyboardInterrupt


def asked() -> bool:
    """Whether Ctrl-C was noted in the present context; in the main thread."""
    return bool(_asked) and current_thread() is main_thread()


def _note(number: int, _: object) -> None:
    _asked.append(number)
