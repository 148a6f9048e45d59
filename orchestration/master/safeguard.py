"""What is guarded while a run calls its FMUs: the state of the process, its exit, and Ctrl-C where it would be lost."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext

from orchestration.fmi.instance import Instance
from orchestration.sandbox.guard import Guard
from orchestration.sandbox.interrupts import noted


def exposed(instances: Sequence[Instance]) -> list[str]:
    """Names of the instances whose FMUs run in this process."""
    return [instance.name for instance in instances if not instance.isolated]


@contextmanager
def over_steps(instances: Sequence[Instance], guard: Guard, time: float) -> Iterator[None]:
    """Guard a part of a run that begins at a time, s.

    Raises
    ------
    KeyboardInterrupt
        At the end, if Ctrl-C came while an isolated FMU was waited for.
    """
    names = exposed(instances)
    with noted() if len(names) < len(instances) else nullcontext():
        with guard.over(names, f"in a step after t = {time:.9g} s"):
            yield


def terminated(instances: Sequence[Instance], guard: Guard) -> Iterator[tuple[Instance, int]]:
    """Terminate the instances whose processes live; yields each with the fmi2Status."""
    for instance in instances:
        if not instance.library.ending:
            with guard.over(exposed([instance]), "while it was terminated"):
                status = instance.status("fmi2Terminate")
            yield instance, status
