"""Ends a command that gets a signal: SIGTERM and SIGHUP act like Ctrl-C, and a second signal where the first cannot.

Python acts on a signal between two steps of its own. While a call of an FMU or of the compiler does not return, there
are none. So a thread listens, too: the operating system hands it each signal through a socket, whatever the main thread
does. The loops of the master know nothing of it.
"""

import os
import signal
import sys
import time
from contextlib import suppress
from threading import Thread, current_thread, main_thread
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Any, Self

from orchestration.sandbox.interrupts import SIGNALS

if TYPE_CHECKING:
    from socket import socket

SIGNALLED = 128  # plus the number of a signal: exit code, as shells have it
PATIENCE = 1.0  # s that the main thread gets to act on a signal
_END = b"\0"  # no signal has this number


class Signalled(KeyboardInterrupt):
    """The request of another program that the process ends.

    Parameters
    ----------
    number
        Number of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(f"The run was interrupted by {signal.Signals(number).name}.")
        self.number = number


def signal_of(error: BaseException | None) -> int:
    """Return the number of the signal that an interrupt comes from, that of Ctrl-C if nothing else is known."""
    while error is not None:
        if isinstance(error, Signalled):
            return error.number
        error = error.__cause__
    return signal.SIGINT


class Interrupts:
    """A context in which signals interrupt a command; it changes nothing outside of the main thread.

    A signal that the parent process told its children to ignore, as ``nohup`` does, stays ignored.
    """

    def __init__(self) -> None:
        self._before: dict[int, Any] = {}
        self._noticed = 0.0  # when the main thread acted on a signal last, s
        self._ends: tuple[socket, socket] | None = None

    def __enter__(self) -> Self:
        """Begin to listen."""
        if current_thread() is not main_thread():
            return self
        from socket import socketpair

        usual = (signal.SIG_DFL, signal.default_int_handler)
        for number in SIGNALS:
            if signal.getsignal(number) in usual:
                self._before[number] = signal.signal(number, self._interrupt)
        self._ends = socketpair()
        self._ends[1].setblocking(False)
        signal.set_wakeup_fd(self._ends[1].fileno(), warn_on_full_buffer=False)
        Thread(target=self._listen, args=(self._ends[0],), daemon=True).start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave everything as it was."""
        if self._ends is None:
            return
        signal.set_wakeup_fd(-1)
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._ends[1].send(_END)
        self._ends[1].close()

    def _interrupt(self, number: int, _: FrameType | None) -> None:
        """Act on a signal, in the main thread."""
        self._noticed = time.monotonic()
        if number == signal.SIGINT:
            raise KeyboardInterrupt
        raise Signalled(number)

    def _listen(self, end: "socket") -> None:
        """Wait for signals, and end the process at the second one that the main thread does not act on."""
        waiting = 0.0  # since when the main thread has not acted on a signal, s; 0 if there is none
        with end:
            while (received := end.recv(1)) not in (b"", _END):
                number = received[0]
                if number not in self._before:
                    continue
                if waiting > self._noticed:
                    _end_process(number)
                arrived = time.monotonic()
                if not self._acted(arrived):
                    waiting = arrived
                    again = "press Ctrl-C again" if number == signal.SIGINT else "send the signal again"
                    _tell(f"The run does not stop, because a call does not return; {again} to end it without its rows.")

    def _acted(self, arrived: float) -> bool:
        """Whether the main thread acts on a signal that has just arrived."""
        while time.monotonic() < arrived + PATIENCE:
            if self._noticed > arrived - PATIENCE:
                return True
            time.sleep(PATIENCE / 50)
        return False


def _end_process(number: int) -> None:
    """End this process without the help of its main thread."""
    from adaptimp_fmu.files.temporary_folder import remove_all

    _tell("Interrupted: the process ends while a call does not return. Its rows are lost, except in a streamed file.")
    remove_all()
    os._exit(SIGNALLED + number)


def _tell(sentence: str) -> None:
    """Write to standard error without its buffer, whose lock the main thread may hold."""
    with suppress(OSError, ValueError, AttributeError):
        os.write(sys.stderr.fileno(), f"{sentence}\n".encode())
