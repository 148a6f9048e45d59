"""What can go wrong in a co-simulation, each with what, where, both values and what to do."""

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np


class RecordedRows(Protocol):
    """What an error keeps of a run: the rows that were complete; an `orchestration.Result` is one.

    Attributes
    ----------
    time
        Communication points, s, shape (n_rows,).
    names
        Columns as ``component.variable``.
    rows
        Values, float64, shape (n_rows, n_columns).
    """

    @property
    def time(self) -> "np.ndarray": ...  # noqa: D102 - described above

    @property
    def names(self) -> tuple[str, ...]: ...  # noqa: D102 - described above

    @property
    def rows(self) -> "np.ndarray": ...  # noqa: D102 - described above

    def __getitem__(self, name: str, /) -> "np.ndarray":
        """A column, float64, shape (n_rows,)."""
        ...

    def write(self, path: str | Path) -> None:
        """Write all rows to a file."""


class OrchestrationError(Exception):
    """Base of all errors of this package."""


class UnknownNameError(OrchestrationError, KeyError):
    """A name that nothing bears; the message gives near names."""

    def __str__(self) -> str:
        """The message as it is; a KeyError would quote it."""
        return str(self.args[0]) if self.args else ""


class ArchiveError(OrchestrationError):
    """An archive is missing, unsafe to unpack, or not what it claims to be."""


class SystemDescriptionError(OrchestrationError):
    """A system is described wrongly."""


class SimulationError(OrchestrationError):
    """A run failed.

    Attributes
    ----------
    result
        All rows that are complete, None if the run failed before the first.
    """

    def __init__(self, message: str, result: RecordedRows | None = None) -> None:
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

    def __init__(self, result: RecordedRows) -> None:
        super().__init__("The run was interrupted.")
        self.result = result
