"""Tells which system calls a confined child has tried that are denied to it, as the kernel reports them.

The kernel stops a thread of the child in such a call until the parent has answered. So the parent must `poll` often.
The child cannot hide a call, and cannot make one up.
"""

import errno
import fcntl
import os
import select
import socket
import struct
from collections.abc import Callable
from contextlib import suppress

from orchestration.sandbox.system_calls import known_calls

_NEXT, _ANSWER = 0xC0502100, 0xC0182101  # SECCOMP_IOCTL_NOTIF_RECV and _SEND: direction, size, '!', number
_CALL, _CALL_BYTES = struct.Struct("=QII i"), 80  # identity of the call, thread, flags, number; and what follows
_REFUSAL = struct.Struct("=QqiI")
MOST_AT_ONCE = 1000


class Denials:
    """The parent's end of the report of denied calls; a context manager that closes what it opened.

    Attributes
    ----------
    teller
        Descriptor for the child, to be passed to it.
    """

    def __init__(self) -> None:
        self._socket, self._child = socket.socketpair()
        self._socket.setblocking(False)
        self._listener: int | None = None
        self._names = known_calls()
        self.teller = self._child.fileno()

    def __enter__(self) -> "Denials":
        """Return the object itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close all descriptors; calls that wait for an answer then fail."""
        self._socket.close()
        self._child.close()
        if self._listener is not None:
            os.close(self._listener)

    def poll(self, notice: Callable[[str], None]) -> None:
        """Refuse the calls that wait for an answer.

        Parameters
        ----------
        notice
            Receives the name of each call before the call is answered, while the process still waits in it.
        """
        if self._listener is None:
            self._listen()
        for _ in range(MOST_AT_ONCE):
            if self._listener is None or not self._calls_wait(self._listener):
                break
            call = bytearray(_CALL_BYTES)
            try:
                fcntl.ioctl(self._listener, _NEXT, call)
                identity, _, _, number = _CALL.unpack_from(call)
                notice(self._names.get(number, f"call {number}"))
                fcntl.ioctl(self._listener, _ANSWER, _REFUSAL.pack(identity, 0, -errno.EPERM, 0))
            except OSError as failed:
                if failed.errno != errno.ENOENT:  # the thread that called has died, or was interrupted
                    break

    @staticmethod
    def _calls_wait(listener: int) -> bool:
        """Whether a call waits; a listener that has lost its process would never return another."""
        poll = select.poll()
        poll.register(listener, select.POLLIN)
        return any(event & select.POLLIN for _, event in poll.poll(0))

    def _listen(self) -> None:
        """Take the listener from the child, if the child has sent it."""
        with suppress(BlockingIOError, ConnectionError):
            _, received, _, _ = socket.recv_fds(self._socket, 1, 1)
            self._listener = received[0] if received else None
