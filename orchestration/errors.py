"""What can go wrong in a co-simulation, each with what, where, both values and what to do."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from orchestration.results.result import Result


class OrchestrationError(Exception):
    """Base of all errors of this package."""


class ArchiveError(OrchestrationError):
    """An archive is missing, unsafe to unpack, or not what it claims to be."""


class SystemDescriptionError(OrchestrationError):
    """A system is described wrongly."""


class SignalError(OrchestrationError, ValueError):
    """A name, a shape, a value or a time does not fit the FMU that is driven."""


class SimulationError(OrchestrationError):
    """A run failed.

    Attributes
    ----------
    result
        All rows that are complete, None if the run failed before the first.
    """

    def __init__(self, message: str, result: Result | None = None) -> None:
        super().__init__(message)
        self.result = result


class InitializationError(SimulationError):
    """A component refused its start values, or failed otherwise before the first step."""


class RunInterrupted(KeyboardInterrupt):
    """A run was interrupted.

    Attributes
    ----------
    result
        All rows that are complete.
    """

    def __init__(self, result: Result) -> None:
        super().__init__("The run was interrupted.")
        self.result = result
