"""Asks a component that has discarded a step whether it ends the simulation, or how far it came (FMI 2.0.4, 4.2.2)."""

import ctypes
from collections.abc import Sequence
from enum import IntEnum

from orchestration.fmi.codes import Status, accepted
from orchestration.fmi.instance import Instance
from orchestration.master.kernel.codes import Column, Failure


class StatusKind(IntEnum):
    """The fmi2StatusKind of what can be asked after fmi2Discard."""

    LAST_SUCCESSFUL_TIME = 2
    TERMINATED = 3


def end_of_simulation(failure: Failure, where: str, instances: Sequence[Instance]) -> str:
    """Return a sentence if a component discards a step because the simulation is over; else an empty text.

    Parameters
    ----------
    failure
        The failed call.
    where
        Time and step, for the sentence.
    """
    subject, call, status = failure
    if (call, status) != (Column.DO_STEP, Status.DISCARD):
        return ""
    ends = ctypes.c_int(0)
    answer = instances[subject].ask("fmi2GetBooleanStatus", StatusKind.TERMINATED, ctypes.byref(ends))
    if not (answer is not None and accepted(answer) and ends.value):
        return ""
    return f"{instances[subject].name} ends the simulation{where}."


def how_far(failure: Failure, instances: Sequence[Instance], *, smallest: float | None) -> str:
    """Return a sentence, after a blank, on what can be done about a discarded step; empty after another failure.

    Parameters
    ----------
    smallest
        Smallest step, s, of a run that controls its step; None for steps of given length.
    """
    subject, call, status = failure
    if (call, status) != (Column.DO_STEP, Status.DISCARD):
        return ""
    time = ctypes.c_double()
    answer = instances[subject].ask("fmi2GetRealStatus", StatusKind.LAST_SUCCESSFUL_TIME, ctypes.byref(time))
    known = answer is not None and accepted(answer)
    reached = f"It has come to t = {time.value:.9g} s" if known else "It does not say how far it has come"
    if smallest is not None:
        needed = f"steps below the smallest, {smallest:g} s, would be needed"
        return f" {reached}; {needed}; allow smaller steps, or stop the run there."
    return f" {reached}; use smaller steps, or algorithm adaptive, which shortens a step that is discarded."
