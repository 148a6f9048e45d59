"""What a command says, and where: results on standard output, remarks and errors on standard error.

With --quiet a command says nothing but its errors, and what was asked for as data. With --verbose it also says what
was unpacked, compiled and taken from a cache, and how long that took. With --json standard output has the data alone.
"""

import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from threading import current_thread, main_thread
from typing import TYPE_CHECKING, Any, TextIO

from orchestration.errors import SystemDescriptionError

if TYPE_CHECKING:
    from rich.console import Console

    from orchestration.master.progress import ProgressLine

PROGRESS_AFTER = 1.0  # s
LOGGERS = ("orchestration", "adaptimp_fmu")
UNLIMITED = 10_000  # columns, for what another program reads
NARROWEST = 20  # columns
LAST_STREAM = 2  # descriptor of standard error


class Output:
    """What the command says that is being carried out.

    Attributes
    ----------
    quiet, verbose, debug
        Whether the options of these names were given.
    data_only
        Whether standard output is for data alone, so that sentences go to standard error.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the options of the command before."""
        self.quiet = self.verbose = self.debug = self.data_only = False

    def choose(self, *, quiet: bool, verbose: bool, debug: bool) -> None:
        """Take options, which may stand before and after the name of a command.

        Raises
        ------
        SystemDescriptionError
            If both --quiet and --verbose are given.
        """
        self.quiet, self.verbose, self.debug = self.quiet or quiet, self.verbose or verbose, self.debug or debug
        if self.quiet and self.verbose:
            msg = "--quiet and --verbose exclude each other; give one of them."
            raise SystemDescriptionError(msg)

    def say(self, text: str) -> None:
        """Say what was done, on standard output unless that is for data."""
        if not self.quiet:
            _write(text, sys.stderr if self.data_only else sys.stdout)

    def remark(self, text: str) -> None:
        """Say on standard error what the user should know."""
        if not self.quiet:
            self.error(text)

    def warn(self, message: Warning | str, *_: object) -> None:
        """Say a warning as a sentence, without the place in the code that it came from."""
        self.remark(f"Warning: {message}")

    def error(self, text: str) -> None:
        """Say on standard error why the command ends, --quiet or not."""
        _write(text, sys.stderr)

    def data(self, text: str) -> None:
        """Write what was asked for, --quiet or not."""
        _write(text, sys.stdout)

    def show(self, renderable: Any) -> None:
        """Print a table of rich."""
        if not self.quiet:
            with _writing(sys.stdout):
                _console().print(renderable)


output = Output()
"""The one of this process."""


def width() -> int:
    """Number of columns that standard output has; unlimited if another program reads it."""
    if "COLUMNS" not in os.environ and not sys.stdout.isatty():
        return UNLIMITED
    from shutil import get_terminal_size

    return max(NARROWEST, get_terminal_size().columns)


def _write(text: str, stream: TextIO) -> None:
    """Write a line; click would write UTF-8 to a stream that asks for ASCII."""
    with _writing(stream):
        stream.write(f"{text}\n")
        stream.flush()


@contextmanager
def _writing(stream: TextIO) -> Iterator[None]:
    """Write on to nowhere if the reader of a pipe has gone, as ``head`` does; the command still does its work.

    Raises
    ------
    OSError
        If the stream cannot be written for another reason, such as a full disk.
    """
    try:
        yield
    except BrokenPipeError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
    except OSError as error:
        name = "Standard output" if stream is sys.stdout else "Standard error"
        msg = f"{name} cannot be written: {error.strerror}; choose another place for it."
        raise OSError(msg) from error


def require_streams() -> None:
    """Refuse a standard output that is closed, and let the other two streams lead nowhere if they are closed.

    Otherwise a file of the run would get the number of the stream, and would receive what an FMU prints.

    Raises
    ------
    OSError
        If standard output is closed.
    """
    closed = sys.stdout is None
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= LAST_STREAM:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    sys.stdout = sys.stdout or open(1, "w", closefd=False)
    sys.stderr = sys.stderr or open(2, "w", closefd=False)
    if closed:
        msg = "Standard output is closed; redirect it to a file, or to /dev/null."
        raise OSError(msg)


def _console() -> "Console":
    from rich.console import Console

    return Console(markup=False, highlight=False, width=width())  # names such as x[i] are no markup


def never_fail_on_characters() -> None:
    """Let both streams print characters that their encoding lacks as escapes, such as those of a unit."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def watched() -> "Iterator[ProgressLine]":
    """Show what takes longer than `PROGRESS_AFTER`, on standard error; --verbose also says what was done."""
    from rich.console import Console

    from orchestration.master.progress import ProgressLine

    console = Console(stderr=True, markup=False, highlight=False, quiet=output.quiet)
    with ProgressLine(console, PROGRESS_AFTER) as line, _listening(line):
        yield line


class _Listener(logging.Handler):
    """Takes what the packages log: DEBUG says what begins, INFO what was done."""

    def __init__(self, line: "ProgressLine") -> None:
        super().__init__()
        self._line = line

    def emit(self, record: logging.LogRecord) -> None:
        """Show what begins, or say what was done; the line belongs to the main thread."""
        shows = current_thread() is main_thread()
        if record.levelno == logging.DEBUG and shows:
            self._line.begin(record.getMessage())
        elif record.levelno == logging.INFO:
            if shows:
                self._line.end()
            if output.verbose:
                output.remark(record.getMessage())


@contextmanager
def _listening(line: "ProgressLine") -> Iterator[None]:
    listener, loggers = _Listener(line), [logging.getLogger(name) for name in LOGGERS]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.addHandler(listener)
        logger.setLevel(logging.DEBUG)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.removeHandler(listener)
            logger.setLevel(level)
