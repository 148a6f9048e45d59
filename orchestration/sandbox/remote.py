"""A process that serves this one: memory that both see, messages in a socket, and how the process ended.

The process runs a program of this package, which knows its job. Whatever the process does, this one goes on: a process
that dies, hangs or closes its connection becomes a sentence, `RemoteProcess.ending`. The process ends with this one,
also if this one is killed, since its end of the socket closes then.
"""

import json
import mmap
import os
import select
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from orchestration.errors import OrchestrationError
from orchestration.sandbox.interpreter import command, death, search_path
from orchestration.sandbox.interrupts import asked

LONGEST_END = 5.0  # s that a process may take to end by itself
GRACE = 0.5  # s that a call may last on after Ctrl-C; the command line expects an effect within 1 s
_LOOK = 0.1  # s between two looks whether the process lives
_NEAR_LIMIT = 0.8  # share of its memory in use, from which on a death is that of memory
_HEAD = struct.Struct("<IB")  # length and kind of a message
REPLY, SAID = 0, 1
"""Kinds of a message: the answer to a request; a text that the process says of itself."""
MOST_BYTES, MOST_TEXT, MOST_SAID = 2**31, 2**16, 10_000
"""Bytes of a message and of a text that are taken, and texts that are kept until somebody takes them."""
_MOST_READS = 256  # of 64 KiB, which is more than a socket holds, so that a process that goes on is not heard for ever


class RemoteEndedError(OrchestrationError):
    """The process has ended, or was ended; the message is the end of a sentence, such as ``died of SIGSEGV``."""


def packed(kind: int, content: bytes) -> bytes:
    """A message for the socket."""
    return _HEAD.pack(len(content), kind) + content


def received(connection: socket.socket) -> Any:
    """Wait for a message, and return what it holds; None if the other side is closed."""
    head = _exactly(connection, _HEAD.size)
    content = _exactly(connection, _HEAD.unpack(head)[0]) if head else b""
    return json.loads(content) if content else None


def _exactly(connection: socket.socket, n: int) -> bytes:
    parts = []
    while n > 0:
        part = connection.recv(min(n, 2**20))
        if not part:
            return b""
        parts.append(part)
        n -= len(part)
    return b"".join(parts)


class RemoteProcess:
    """A process that runs a program of this package beside this one.

    Parameters
    ----------
    program
        Module that ``python -m`` runs, with an object in JSON as its argument: ``talk`` and ``bell`` are descriptors
        of sockets, ``memory`` that of the shared memory of ``size`` bytes.
    size
        Bytes of the shared memory.
    time_limit
        Longest time of a call, s; None for no limit.
    memory_limit
        Bytes that the process may use, to say whether it died of that.

    Attributes
    ----------
    memory
        The shared memory. It stays mapped as long as the object lives.
    bell, talk
        Descriptors of the socket whose bytes wake the other process, and of that for messages.
    ending
        How the process ended, as the end of a sentence; empty while it lives.
    overdue
        Whether the process was ended because a call took longer than the time limit.
    said
        Texts that the process has said and nobody has taken yet, the newest `MOST_SAID` of them.
    """

    def __init__(
        self,
        program: str,
        size: int,
        *,
        time_limit: float | None = None,
        memory_limit: int | None = None,
    ) -> None:
        self.time_limit, self.memory_limit = time_limit, memory_limit
        self.overdue = False
        self.ending, self.said = "", deque[str](maxlen=MOST_SAID)
        self._used = 0  # bytes of memory that the process has used at most
        self._replies: deque[Any] = deque()
        self._received = bytearray()
        self._talk, talk = socket.socketpair()
        self._bell, bell = socket.socketpair()
        file = _shared_file(size)
        try:
            self.memory = mmap.mmap(file, size)
            given = {"talk": talk.fileno(), "bell": bell.fileno(), "memory": file, "size": size}
            self._process = _started(program, given, (talk.fileno(), bell.fileno(), file))
        finally:
            os.close(file)
            talk.close()
            bell.close()
        self._talk.setblocking(False)
        self._bell.setblocking(False)
        self.bell, self.talk = self._bell.fileno(), self._talk.fileno()
        self._poll = select.poll()
        for end in (self._talk, self._bell):
            self._poll.register(end, select.POLLIN)

    @property
    def pid(self) -> int:
        """Id of the process."""
        return self._process.pid

    def tell(self, content: Mapping[str, Any], *, limit: float | None = None) -> None:
        """Send a message that has no answer.

        Parameters
        ----------
        limit
            Longest time, s, that the process may take to receive it, if it is not the process's own.

        Raises
        ------
        RemoteEndedError
        """
        self._send(packed(REPLY, json.dumps(content).encode()), self.ring, limit)

    def request(self, content: Mapping[str, Any], notify: Callable[[], None], *, limit: float | None = None) -> Any:
        """Send a message, and return the answer.

        Parameters
        ----------
        notify
            Called after the message was sent, to tell the process of it.
        limit
            Longest time, s, if it is not the process's own.

        Raises
        ------
        RemoteEndedError
        """
        self._send(packed(REPLY, json.dumps(content).encode()), notify, limit)
        self.wait(lambda: bool(self._replies), limit=limit)
        return self._replies.popleft()

    def ring(self) -> None:
        """Wake the process."""
        with suppress(BlockingIOError, BrokenPipeError):
            self._bell.send(b"\0")

    def wait(self, ready: Callable[[], bool], *, limit: float | None = None) -> None:
        """Wait until the process has done something, and receive what it says meanwhile.

        Raises
        ------
        RemoteEndedError
            If the process ends, or it takes too long.
        """
        limit = self.time_limit if limit is None else limit
        end, pause = (None if limit is None else time.monotonic() + limit), 0.0
        interrupted = False
        while True:
            self._receive(pause)
            if ready():
                return
            if end is not None and time.monotonic() > end:
                self.overdue = not interrupted
                self._fail("was interrupted" if interrupted else f"did not return within {limit:g} s")
            if asked() and not interrupted:
                interrupted, end = True, time.monotonic() + GRACE
            pause = _LOOK if end is None else max(0.0, min(_LOOK, end - time.monotonic()))

    def take(self) -> None:
        """Receive what the process has sent so far, without waiting; whether it lives is not asked.

        Raises
        ------
        RemoteEndedError
            If it sent what is no message.
        """
        with suppress(OSError):  # there is nothing more now, or never again
            for _ in range(_MOST_READS):
                self._received += self._talk.recv(2**16)
        self._unpack()

    def close(self) -> None:
        """End the process, if it has not ended; a second call does nothing."""
        if not self.ending:
            self.ending = "was ended"
        self._poll = select.poll()
        self._talk.close()
        self._bell.close()
        if self._process.returncode is None and not self._reap(LONGEST_END):
            self._process.kill()
            self._reap(None)

    def _send(self, message: bytes, notify: Callable[[], None], limit: float | None) -> None:
        """Send a message, while the process may be sending too."""
        rest = memoryview(message)
        told = False
        while rest:
            try:
                rest = rest[self._talk.send(rest) :]
            except BlockingIOError:
                if not told:
                    notify()  # it reads what fills the socket
                told = True
                self.wait(lambda: bool(select.select((), (self._talk,), (), 0.01)[1]), limit=limit)
            except OSError:
                self._died()
        notify()

    def _receive(self, pause: float) -> None:
        """Take in what the process has sent, after waiting for it for at most so many seconds."""
        for descriptor, _ in self._poll.poll(1e3 * pause):
            end = self._bell if descriptor == self.bell else self._talk
            try:
                part = end.recv(2**16)
            except BlockingIOError:
                continue
            except OSError:
                part = b""
            if end is self._talk:
                self._received += part
            if not part:
                self._unpack()
                self._died()
        self._unpack()
        if pause > 0 and not self._replies and self._reap(0.0):
            self._died()

    def _unpack(self) -> None:
        """Take whole messages out of what was received."""
        while len(self._received) >= _HEAD.size:
            length, kind = _HEAD.unpack_from(self._received)
            if length > MOST_BYTES:
                self._fail("sent what is no message")
            if len(self._received) < _HEAD.size + length:
                return
            content = bytes(self._received[_HEAD.size : _HEAD.size + length])
            del self._received[: _HEAD.size + length]
            if kind == SAID:
                self.said.append(content[:MOST_TEXT].decode(errors="replace"))
                continue
            try:
                self._replies.append(json.loads(content))
            except (ValueError, RecursionError):
                self._fail("sent what is no message")

    def _died(self) -> None:
        """Say how the process ended.

        Raises
        ------
        RemoteEndedError
        """
        if self._process.returncode is None and not self._reap(LONGEST_END):
            self._fail("closed its connection to the master")
        code, used = self._process.returncode or 0, self._used
        how = death(code, "ended its process", "died")
        if code < 0 and self.memory_limit is not None and used > _NEAR_LIMIT * self.memory_limit:
            self._fail(f"went beyond its memory limit of {self.memory_limit / 2**20:.0f} MiB ({how})")
        self._fail(how)

    def _fail(self, how: str) -> None:
        self.end(how)
        raise RemoteEndedError(self.ending)

    def end(self, how: str) -> None:
        """End the process because of what it did, given as the end of a sentence."""
        self.ending = self.ending or how
        if self._process.returncode is None:
            self._process.kill()
            self._reap(None)

    def _reap(self, longest: float | None) -> bool:
        """Wait for the end of the process for at most so many seconds; returns whether it has ended."""
        if self._process.returncode is not None:
            return True
        end = None if longest is None else time.monotonic() + longest
        while True:
            try:
                found, status, usage = os.wait4(self._process.pid, 0 if end is None else os.WNOHANG)
            except ChildProcessError:  # somebody else has waited for all children
                self._process.returncode = 0
                return True
            if found:
                self._process.returncode = os.waitstatus_to_exitcode(status)
                self._used = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
                return True
            if end is not None and time.monotonic() >= end:
                return False
            time.sleep(0.001)


def _shared_file(size: int) -> int:
    """Descriptor of a file without a name, which vanishes with its last user."""
    if hasattr(os, "memfd_create"):
        file = os.memfd_create("adaptimp")
    else:
        with tempfile.TemporaryFile() as temporary:
            file = os.dup(temporary.fileno())
    os.ftruncate(file, size)
    return file


def _started(program: str, plan: Mapping[str, Any], descriptors: tuple[int, ...]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        command(program, json.dumps(plan)),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": search_path()},
        pass_fds=descriptors,
        start_new_session=True,  # Ctrl-C is for this process, which then ends the other
    )
