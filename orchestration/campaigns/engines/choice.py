"""Chooses the engine for a task."""

import logging

from orchestration.campaigns.engines.engine import Engine
from orchestration.campaigns.engines.isolated import isolates_any
from orchestration.campaigns.engines.master import MasterEngine
from orchestration.campaigns.engines.native import NativeEngine
from orchestration.campaigns.engines.task import Task
from orchestration.errors import ContainerError

_LOG = logging.getLogger(__name__)


def engine_for(task: Task) -> Engine:
    """The fastest engine that can make the runs of a task.

    A system of the project's own FMUs becomes one native library. Every other system, and one of which components are
    isolated, is stepped by the master.
    """
    if not isolates_any(task):
        try:
            return NativeEngine(task)
        except ContainerError as reason:
            _LOG.info("the runs are made by the master: %s", reason)
    return MasterEngine(task)
