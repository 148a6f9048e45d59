"""Exit codes of ``adaptimp``, and which error ends in which of them."""

from enum import IntEnum

from orchestration.cli.interrupts import SIGNALLED, signal_of
from orchestration.sandbox.guard import EXIT_CODE


class ExitCode(IntEnum):
    """What became of a command, for scripts."""

    SUCCESS = 0
    FAILED = 1
    REFUSED = 2
    FAULT = 3
    ENDED_BY_FMU = EXIT_CODE
    HUNG_UP = 129  # 128 plus the number of a signal, as shells have it
    INTERRUPTED = 130
    TERMINATED = 143


MEANINGS = {
    ExitCode.SUCCESS: "success",
    ExitCode.FAILED: "a run failed on its way, or a file cannot be used",
    ExitCode.REFUSED: "the request cannot be carried out as it is",
    ExitCode.FAULT: "a fault of adaptimp itself",
    ExitCode.ENDED_BY_FMU: "an FMU ended the program",
    ExitCode.HUNG_UP: "interrupted by SIGHUP: the terminal was closed",
    ExitCode.INTERRUPTED: "interrupted by Ctrl-C",
    ExitCode.TERMINATED: "interrupted by SIGTERM",
}
"""What each code says, in the words of the help."""


def exit_code_of(error: BaseException) -> ExitCode:
    """Return the exit code of a command that an exception ends."""
    from adaptimp_fmu.files.parts import MissingPartError
    from orchestration.errors import InitializationError, OrchestrationError, SimulationError

    if isinstance(error, KeyboardInterrupt):
        return ExitCode(SIGNALLED + signal_of(error))
    if isinstance(error, InitializationError):  # start values are part of the request
        return ExitCode.REFUSED
    if isinstance(error, SimulationError | OSError):  # a full disk, a cache that cannot be written
        return ExitCode.FAILED
    return ExitCode.REFUSED if isinstance(error, OrchestrationError | MissingPartError) else ExitCode.FAULT
