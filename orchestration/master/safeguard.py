"""What is guarded while a run calls its FMUs: the state of the process, its exit, and Ctrl-C where it would be lost."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from orchestration.errors import RecordedRows, SimulationError
from orchestration.fmi.codes import accepted
from orchestration.fmi.instance import Instance
from orchestration.sandbox.guard import Guard
from orchestration.sandbox.interrupts import noted

Found = TypeVar("Found")


def exposed(instances: Sequence[Instance]) -> list[str]:
    """Names of the instances whose FMUs run in this process."""
    return [instance.name for instance in instances if not instance.isolated]


@contextmanager
def over_steps(instances: Sequence[Instance], guard: Guard, time: float) -> Iterator[None]:
    """Guard a part of a run that begins at a time, s.

    Raises
    ------
    KeyboardInterrupt
        At the end, if Ctrl-C came meanwhile: compiled code may have called Python, where the interrupt would be lost.
    """
    with noted(), guard.over(exposed(instances), f"in a step after t = {time:.9g} s"):
        yield


def guarded(run: tuple[Sequence[Instance], Guard], call: Callable[..., Found], *arguments: Any) -> Found:
    """Call a function that calls instances between two steps, with the process guarded."""
    instances, guard = run
    with guard.over(exposed(instances), "between two steps"):
        return call(*arguments)


def terminate(instances: Sequence[Instance], guard: Guard, rows: Callable[[], RecordedRows]) -> None:
    """Terminate the instances whose processes live.

    Parameters
    ----------
    rows
        Returns the rows of the run, for an error.

    Raises
    ------
    SimulationError
        If an FMU does not terminate.
    """
    for instance in instances:
        if instance.library.ending:
            continue
        with guard.over(exposed([instance]), "while it was terminated"):
            status = instance.status("fmi2Terminate")
        if not accepted(status):
            raise SimulationError(instance.failure("fmi2Terminate", status), rows())
