"""The channel by which a child process reports to its parent: records with a signature over a pipe.

The pipe has no name in any folder, and the key of the signatures is in no file, argument or environment variable.
So a stranger's library in the child cannot forge a record by printing, by writing to files or by writing to every
open descriptor: what is not signed is dropped and counted. A library that searches the memory of its own process
for the key can still sign; no process can hide from the code that it runs.
"""

import hashlib
import hmac
import json
import os
from threading import Thread
from typing import IO, Any

MOST_BYTES = 64 * 1024**2  # of all records of a child
LONGEST_RECORD = 16 * 1024**2  # bytes
KEY_BYTES = 32
_DIGEST = hashlib.sha256
_SIGNATURE = 2 * _DIGEST().digest_size  # characters


class Sender:
    """The child's end of the channel.

    Parameters
    ----------
    descriptor
        The pipe.
    key
        The secret that both ends know.
    """

    def __init__(self, descriptor: int, key: bytes) -> None:
        self._descriptor, self._count = descriptor, 0
        self._signature = hmac.new(key, digestmod=_DIGEST)

    def send(self, record: dict[str, Any]) -> None:
        """Send an object that JSON can hold."""
        self._count += 1
        content = json.dumps([self._count, record]).encode()
        signature = self._signature.copy()
        signature.update(content)
        left = memoryview(signature.hexdigest().encode() + b" " + content + b"\n")
        while left:
            left = left[os.write(self._descriptor, left) :]


class Receiver:
    """The parent's end of the channel, which a thread reads.

    Parameters
    ----------
    stream
        The pipe.
    key
        The secret that both ends know.

    Attributes
    ----------
    records
        The objects that were received with a right signature, each once and in their order.
    foreign
        Number of lines in the pipe that are not such records.
    """

    def __init__(self, stream: IO[bytes], key: bytes) -> None:
        self._stream, self._key, self._last, self._bytes = stream, key, 0, 0
        self.records: list[dict[str, Any]] = []
        self.foreign = 0
        self._thread = Thread(target=self._read, name="reports of a child process", daemon=True)
        self._thread.start()

    def finish(self, timeout: float) -> None:
        """Wait until the pipe has ended, s at the longest."""
        self._thread.join(timeout)

    def _read(self) -> None:
        while line := self._stream.readline(LONGEST_RECORD):
            self._bytes += len(line)
            if self._bytes <= MOST_BYTES:
                self._take(line)
            else:
                self.foreign += 1

    def _take(self, line: bytes) -> None:
        signature, content = line[:_SIGNATURE], line[_SIGNATURE + 1 :].removesuffix(b"\n")
        right = hmac.new(self._key, content, _DIGEST).hexdigest().encode()
        number, record = json.loads(content) if hmac.compare_digest(signature, right) else (0, {})
        if number > self._last:  # a record that was read and is sent again has an old number
            self._last = number
            self.records.append(record)
        else:
            self.foreign += 1
