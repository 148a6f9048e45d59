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
from contextlib import suppress

from orchestration.sandbox.system_calls import known_calls

_NEXT, _ANSWER = 0xC0502100, 0xC0182101  # SECCOMP_IOCTL_NOTIF_RECV and _SEND: direction, size, '!', number
_CALL, _CALL_BYTES = struct.Struct("=QII i"), 80  # identity of the call, thread, flags, number; and what follows
_REFUSAL = struct.Struct("=QqiI")
MOST_AT_ONCE = 1000

MEANING = {
    **dict.fromkeys(("socket",), "a socket"),
    **dict.fromkeys(("execve", "execveat", "fork", "vfork", "clone"), "another process or program"),
    **dict.fromkeys(
        (
            *("kill", "tgkill", "tkill", "rt_sigqueueinfo", "rt_tgsigqueueinfo", "pidfd_open", "pidfd_send_signal"),
            *("fcntl", "setsid", "setpgid", "prctl", "setpriority", "ioprio_set", "prlimit64"),
        ),
        "power over another process, or over its own limits",
    ),
    **dict.fromkeys(
        (
            *("ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "process_mrelease", "kcmp"),
            *("pidfd_getfd", "migrate_pages", "move_pages", "shmget", "shmat", "msgget", "semget", "mq_open"),
        ),
        "the memory of another process",
    ),
    **dict.fromkeys(
        (
            *("mknod", "mknodat", "chmod", "fchmod", "fchmodat", "fchmodat2", "chown", "fchown", "lchown", "fchownat"),
            *("utime", "utimes", "futimesat", "utimensat", "setxattr", "lsetxattr", "fsetxattr", "setxattrat"),
            *("removexattr", "lremovexattr", "fremovexattr", "removexattrat"),
        ),
        "another owner, mode or time of a file",
    ),
}
"""What a denied call asks for, as the end of a sentence."""
OTHER_MEANING = "a change of the system"


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

    def poll(self) -> list[str]:
        """Refuse the calls that wait for an answer; returns their names."""
        if self._listener is None:
            self._listen()
        found: list[str] = []
        while self._listener is not None and len(found) < MOST_AT_ONCE:
            if not self._calls_wait(self._listener):
                break
            call = bytearray(_CALL_BYTES)
            try:
                fcntl.ioctl(self._listener, _NEXT, call)
                identity, _, _, number = _CALL.unpack_from(call)
                found.append(self._names.get(number, f"call {number}"))
                fcntl.ioctl(self._listener, _ANSWER, _REFUSAL.pack(identity, 0, -errno.EPERM, 0))
            except OSError as failed:
                if failed.errno != errno.ENOENT:  # the thread that called has died, or was interrupted
                    break
        return found

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
