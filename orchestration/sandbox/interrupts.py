"""Lets Ctrl-C and other requests to end wait while compiled code or another process is called.

Python runs the handler of a signal wherever it has control next. That may be in a function which compiled code has
called back, and there the KeyboardInterrupt of the handler would be lost. So signals are noted meanwhile, and handled
afterwards.

Three modules share the work. `orchestration.cli.interrupts` has the policy: what a signal does to a command, and when a
second one ends the process. `noted`, here, defers the handler of that policy, or Python's own, while a call must not be
interrupted. `orchestration.fmi.deferred` keeps an exception that was raised in a callback nevertheless, until the call
has returned.
"""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that ask a process to end, and that it can handle; Windows has no SIGHUP."""
_asked: list[tuple[int, FrameType | None]] = []


@contextmanager
def noted() -> Iterator[None]:
    """Note signals that Python handles within the context, and handle the first at the end.

    Only the main thread does so, since it handles all signals. A context within another leaves that to the other.

    Raises
    ------
    KeyboardInterrupt
        At the end, or what else the handler raises, in place of any other exception.
    """
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    usual = {number: handler for number, handler in handlers.items() if callable(handler)}
    if not usual or _note in usual.values() or current_thread() is not main_thread():
        yield
        return
    _asked.clear()
    for number in usual:
        signal.signal(number, _note)
    try:
        yield
    finally:
        for number, handler in usual.items():
            signal.signal(number, handler)
        if _asked:
            number, frame = _asked[0]
            _asked.clear()
            usual[number](number, frame)


def asked() -> bool:
    """Whether a signal was noted in the present context; in the main thread."""
    return bool(_asked) and current_thread() is main_thread()


def _note(number: int, frame: FrameType | None) -> None:
    _asked.append((number, frame))
