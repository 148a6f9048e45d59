"""Compiles the loop of a run before its first step, so that nobody takes compilation for stepping."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from time import perf_counter

from orchestration.master.kernel.compiled import compilations
from orchestration.stages import stage


def compile_loop(make_no_step: Callable[[], None]) -> float:
    """Let numba compile the loop of a run, or load the machine code that an earlier process has kept.

    Parameters
    ----------
    make_no_step
        Calls the loop with the arrays of the run, and with an empty span of steps.

    Returns
    -------
    float
        Time that it took, s.

    Raises
    ------
    KeyboardInterrupt
        At the end, if the user has asked for it in the meantime.
    """
    started, before = perf_counter(), compilations()

    def done() -> str:
        return "compiled the master's loop" if compilations() > before else "loaded the master's loop from the cache"

    with stage("compiling or loading the master's loop", done), _interrupts_at_the_end():
        make_no_step()
    return perf_counter() - started


@contextmanager
def _interrupts_at_the_end() -> Iterator[None]:
    """Let the first Ctrl-C wait for the end: the compiler calls Python back, and a KeyboardInterrupt would be lost."""
    usual = signal.getsignal(signal.SIGINT)
    if current_thread() is not main_thread() or usual is not signal.default_int_handler:
        yield
        return
    asked: list[int] = []

    def remember(number: int, _: object) -> None:
        asked.append(number)
        signal.signal(signal.SIGINT, usual)

    signal.signal(signal.SIGINT, remember)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
    if asked:
        raise KeyboardInterrupt
