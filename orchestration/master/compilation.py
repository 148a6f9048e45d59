"""Compiles the loop of a run before its first step, so that nobody takes compilation for stepping."""

from collections.abc import Callable
from time import perf_counter

from orchestration.master.kernel.compiled import compilations
from orchestration.sandbox.interrupts import noted
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
        At the end, if the user has asked for it in the meantime: the compiler calls Python back, where an interrupt
        would be lost.
    """
    started, before = perf_counter(), compilations()

    def done() -> str:
        return "compiled the master's loop" if compilations() > before else "loaded the master's loop from the cache"

    with stage("compiling or loading the master's loop", done), noted():
        make_no_step()
    return perf_counter() - started
