"""Exit codes of ``adaptimp``, and which error ends in which of them."""

from enum import IntEnum

from orchestration.sandbox.guard import EXIT_CODE


class ExitCode(IntEnum):
    """What became of a command, for scripts."""

    SUCCESS = 0
    FAILED = 1
    REFUSED = 2
    FAULT = 3
    ENDED_BY_FMU = EXIT_CODE
    INTERRUPTED = 130  # as shells have it


MEANINGS = {
    ExitCode.SUCCESS: "success",
    ExitCode.FAILED: "a run failed on its way, or a file cannot be used",
    ExitCode.REFUSED: "the request cannot be carried out as it is",
    ExitCode.FAULT: "a fault of adaptimp itself",
    ExitCode.ENDED_BY_FMU: "an FMU ended the program",
    ExitCode.INTERRUPTED: "interrupted by Ctrl-C",
}
"""What each code says, in the words of the help."""


def exit_code_of(error: BaseException) -> ExitCode:
    """Return the exit code of a command that an exception ends."""
    from orchestration.errors import InitializationError, OrchestrationError, SimulationError

    if isinstance(error, KeyboardInterrupt):
        return ExitCode.INTERRUPTED
    if isinstance(error, InitializationError):  # start values are part of the request
        return ExitCode.REFUSED
    if isinstance(error, SimulationError | OSError):  # a full disk, a cache that cannot be written
        return ExitCode.FAILED
    return ExitCode.REFUSED if isinstance(error, OrchestrationError) else ExitCode.FAULT
