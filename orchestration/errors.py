"""Errors of the orchestration package.

Every message names the subject, the place and both values, and says what to do.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np


class RecordedRows(Protocol):
    """The complete rows of a run that failed or was interrupted, as an error carries them.

    An `orchestration.Result` has this interface. The interface lets this module import no other module.
    """

    @property
    def time(self) -> "np.ndarray":
        """Communication points, s, shape (n_rows,)."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns as ``component.variable``."""
        ...

    @property
    def rows(self) -> "np.ndarray":
        """Values, float64, shape (n_rows, n_columns), in the units of the columns."""
        ...

    def __getitem__(self, name: str, /) -> "np.ndarray":
        """Values of a column, float64, shape (n_rows,)."""
        ...

    def write(self, path: str | Path) -> None:
        """Write all rows to a file whose suffix names the format."""


class OrchestrationError(Exception):
    """Base class of all errors of the orchestration package."""


class UnknownNameError(OrchestrationError, KeyError):
    """A name that nothing bears; the message gives near names."""

    def __str__(self) -> str:
        """The message as it is; a KeyError would quote it."""
        return str(self.args[0]) if self.args else ""


class ArchiveError(OrchestrationError):
    """Error of an FMU or SSP archive that is missing, invalid or unsafe to unpack."""


class SystemDescriptionError(OrchestrationError):
    """Error in the description of a coupled system, its options or its algorithm."""


class SignalError(OrchestrationError, ValueError):
    """A name, a shape, a value or a time does not fit the FMU that is driven."""


class SimulationError(OrchestrationError):
    """Error of a run that failed.

    Attributes
    ----------
    result
        All complete rows; None if the run failed before the first row.
    """

    def __init__(self, message: str, result: RecordedRows | None = None) -> None:
        super().__init__(message)
        self.result = result


class InitializationError(SimulationError):
    """Error of a component before the first step, for example on an invalid start value."""


class RunInterrupted(KeyboardInterrupt):
    """Interruption of a run by the user, with the rows until then.

    Attributes
    ----------
    result
        All complete rows.
    """

    def __init__(self, result: RecordedRows) -> None:
        super().__init__("The run was interrupted.")
        self.result = result
