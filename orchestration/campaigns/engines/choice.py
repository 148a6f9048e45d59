"""Chooses the engine for a task."""

from orchestration.campaigns.engine import Engine
from orchestration.campaigns.engines.plain import PlainEngine
from orchestration.campaigns.task import Task


def engine_for(task: Task) -> Engine:
    """The fastest engine that can make the runs of a task."""
    return PlainEngine(task)
