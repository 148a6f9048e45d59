"""Which components of a campaign live in processes of their own, so that a crash costs its run and nothing else."""

from orchestration.campaigns.engines.task import Task
from orchestration.containers.contained.containment import is_own
from orchestration.fmi.isolation import CAN_ISOLATE, Isolation


def foreign_components(task: Task) -> tuple[str, ...]:
    """Names of the components whose FMUs are not of this project."""
    return tuple(component.name for component in task.system.components if not is_own(component))


def isolation_of(task: Task) -> Isolation | None:
    """Components in processes of their own: those that the task names, or else all with FMUs of other tools.

    Where FMUs cannot be isolated, only a task that asks for it isolates some, and is refused.
    """
    if task.isolation is not None or not CAN_ISOLATE:
        return task.isolation
    foreign = foreign_components(task)
    return Isolation(foreign) if foreign else None


def isolates_any(task: Task) -> bool:
    """Whether a component lives in a process of its own."""
    isolation = isolation_of(task)
    return isolation is not None and any(isolation.covers(component.name) for component in task.system.components)
