"""The library of an FMU in a process of its own, behind the same interface as a library in this process.

A function by name, and a function by address, hand each call over to the process and return what it returns. If the
process has ended, each call returns fmi2Fatal, or no instance, at once.
"""

import ctypes as ct
import os
import select
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from orchestration.errors import ArchiveError
from orchestration.fmi import signatures
from orchestration.fmi.codes import Status
from orchestration.fmi.isolation import CAN_ISOLATE, Isolation
from orchestration.fmi.library import Library
from orchestration.fmi.logging import Message, heard
from orchestration.fmi.remote_arguments import deliver, outward, types
from orchestration.fmi.remote_layout import CALLS, IDLE, LOAD, SLOW, UNLOAD, WORD, Caller, Word, arrays_size
from orchestration.sandbox.interpreter import LONGEST_START
from orchestration.sandbox.interrupts import noted
from orchestration.sandbox.remote import LONGEST_END, RemoteEndedError, RemoteProcess

_PROGRAM = "orchestration.fmi.remote_program"
# Turns that a side waits in a loop, and by letting others run, before it sleeps. The process of an FMU sleeps early:
# five of them that wait for long keep each other from the two cores (3 us per step and component, else 8 to 14 us).
_MASTER_TURNS, _SERVER_TURNS = (200, 20), (50, 5)
# What an answer raises that is not as this program makes it: the FMU has written over the process's memory.
_NO_ANSWER = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
_ATTEND = ct.CFUNCTYPE(ct.c_int, ct.c_void_p, ct.c_void_p)


class _Polled(ct.Structure):
    """``struct pollfd``."""

    _fields_ = (("descriptor", ct.c_int), ("events", ct.c_short), ("found", ct.c_short))


def start_process(isolation: Isolation, n_variables: int) -> RemoteProcess:
    """Start a process for an FMU with so many variables; it gets ready while this process goes on.

    Raises
    ------
    ArchiveError
        If this system cannot isolate FMUs.
    """
    if not CAN_ISOLATE:
        msg = "FMUs cannot be isolated on Windows, where a process inherits no sockets; run without isolation."
        raise ArchiveError(msg)
    from orchestration.fmi.remote_calls import server

    process = RemoteProcess(
        _PROGRAM,
        WORD * Word.ARRAYS + arrays_size(n_variables),
        time_limit=isolation.time_limit,
        memory_limit=isolation.memory_limit,
    )
    spins, yields = _turns(_SERVER_TURNS)
    limits = [isolation.memory_limit, isolation.descriptor_limit]
    with suppress(RemoteEndedError):  # the first call says it
        plan = {"server": server(), "spins": spins, "yields": yields, "limits": limits}
        process.tell(plan, limit=LONGEST_START)  # it may be more than the socket holds until the process reads
    return process


def _turns(usual: tuple[int, int]) -> tuple[int, int]:
    """Turns of waiting; none in a loop where the other side could not run meanwhile."""
    one = (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()) == 1
    return (0 if one else usual[0]), usual[1]


class RemoteLibrary(Library):
    """A shared library of an FMU, loaded in another process.

    Parameters
    ----------
    path
        Absolute path of the file.
    process
        A process from `start_process`, which `close` ends.

    Raises
    ------
    OSError
        If the library, or one that it needs, cannot be loaded, or the process ends over it.
    """

    isolated = True

    def __init__(self, path: Path, process: RemoteProcess) -> None:
        self.path, self._process = path, process
        self._words = (ct.c_int64 * Word.ARRAYS).from_buffer(process.memory)
        self._attend, self._byte = _ATTEND(self._wait_on), ct.create_string_buffer(1)
        self._polled = (_Polled * 2)(*((end, select.POLLIN, 0) for end in (process.bell, process.talk)))
        self._caller = (ct.c_int64 * Caller.LENGTH)(*self._record())
        self._functions: dict[str, Any] = {}
        self._kept: list[Any] = []
        self._messages: Any = None
        self._call, self._exported = "", frozenset[str]()
        limit = None if process.time_limit is None else process.time_limit + LONGEST_START
        answer = self._request(LOAD, [str(path)], limit=limit)
        if answer is None or "error" in answer:
            reason = f"loading it {process.ending}" if answer is None else answer["error"]
            self.close()
            raise OSError(reason)
        self._exported = frozenset(answer["exported"])

    def _record(self) -> list[int]:
        """Words of the record that stands for the instance."""
        c = ct.CDLL(None)
        spins, yields = _turns(_MASTER_TURNS)
        words = dict.fromkeys(Caller, 0)
        words |= {Caller.SHARED: ct.addressof(self._words), Caller.SPINS: spins, Caller.YIELDS: yields}
        words |= {Caller.BELL: self._process.bell, Caller.BYTE: ct.addressof(self._byte)}
        words |= {Caller.YIELD: _address(c.sched_yield), Caller.WRITE: _address(c.write)}
        words |= {Caller.READ: _address(c.read), Caller.POLL: _address(c.poll)}
        words |= {Caller.POLLED: ct.addressof(self._polled)}
        words |= {
            Caller.CAPACITY: len(self._process.memory) - WORD * Word.ARRAYS,
            Caller.ATTEND: _address(self._attend),
        }
        return [words[Caller(k)] for k in range(Caller.LENGTH)]

    @property
    def ending(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How the process ended while it was needed, such as ``died of SIGSEGV``; empty if it did not."""
        return self._process.ending

    def lacks(self, functions: Sequence[str] = signatures.FUNCTIONS) -> list[str]:
        """Functions that are not exported; by default of all functions of FMI 2.0 for co-simulation."""
        return [name for name in functions if name not in self._exported]

    def function(self, name: str) -> Callable[..., Any]:
        """A function that hands its call over to the process.

        Raises
        ------
        AttributeError
            If the library does not export it.
        """
        if name not in self._exported:
            msg = f"{self.path.name} does not export {name}."
            raise AttributeError(msg, name=name)
        return noted()(self._found(name))

    def address(self, name: str) -> int:
        """Address of a function that hands its call over; 0 if the library does not export it."""
        return _address(self._found(name)) if name in self._exported else 0

    def close(self) -> None:
        """Unload the library and end the process; a second call does nothing."""
        try:
            if not self._process.ending:
                self._request(UNLOAD, [], limit=LONGEST_END)
        finally:
            self._caller[Caller.ENDED] = 1
            self._process.close()

    def _found(self, name: str) -> Any:
        if name not in self._functions:
            self._functions[name] = self._made(name)
        return self._functions[name]

    def _made(self, name: str) -> Any:
        """A C function for a function of FMI."""
        if name in CALLS:
            from orchestration.fmi.remote_calls import stand_in

            return _kind(name)(stand_in(name))
        if name == "fmi2Instantiate":
            return _INSTANTIATE(self._instantiate)
        if name == "fmi2FreeInstance":
            return _FREE(lambda _: self._request(name, []))
        if name in signatures.OTHERS:
            return lambda: (self._request(name, []) or "").encode("latin-1")

        def handed_over(_: int, *arguments: Any) -> int:
            answer = self._request(name, outward(name, arguments))
            try:
                if answer is not None:
                    return deliver(name, arguments, answer["written"], self._kept, status=int(answer["status"]))
            except _NO_ANSWER:
                self._process.end("sent what is no answer")
                self._caller[Caller.ENDED] = 1
            return Status.FATAL

        return _kind(name)(handed_over)

    def _instantiate(self, name: bytes, kind: int, guid: bytes, resources: bytes, given: int, *flags: int) -> int:
        self._messages = heard(signatures.Callbacks.from_address(given).componentEnvironment)
        texts = [(text or b"").decode() for text in (name, guid, resources)]
        answer = self._request("fmi2Instantiate", [texts[0], kind, *texts[1:], *flags])
        return ct.addressof(self._caller) if answer else 0

    def _request(self, function: str, arguments: list[Any], *, limit: float | None = None) -> Any:
        """Let the process do something; None if it ends over it."""
        if self._caller[Caller.ENDED]:
            return None
        try:
            return self._process.request({"function": function, "arguments": arguments}, self._tell, limit=limit)
        except RemoteEndedError:
            self._caller[Caller.ENDED] = 1
            return None
        finally:
            self._words[Word.SAID] = 0
            self._pass_on()

    def _tell(self) -> None:
        self._words[Word.CALL] = SLOW
        self._process.ring()

    def _wait_on(self, caller: int, _: int) -> int:  # noqa: ARG002 - the record is this object's
        """Wait for a call that takes long, or take in what the FMU has logged; the record gets the status."""
        words = self._words
        words[Word.MASTER_SLEEPS] = 1
        try:
            self._process.wait(lambda: words[Word.CALL] == IDLE)
            words[Word.SAID] = 0
            self._process.take()  # the call may have ended before its last messages were read
        except RemoteEndedError:
            self._caller[Caller.ENDED] = 1
            return 0
        finally:
            words[Word.MASTER_SLEEPS] = 0
            self._pass_on()
        self._caller[Caller.RESULT] = ct.c_int32(words[Word.STATUS]).value
        return 0

    def _pass_on(self) -> None:
        """Give the instance the messages that its FMU has logged."""
        said = self._process.said
        while said:
            text = said.popleft()
            if self._messages is not None:
                self._messages.append(Message(text[1:], int(text[0]) if text[:1].isdigit() else 0))


def _address(function: Any) -> int:
    return int(ct.cast(function, ct.c_void_p).value or 0)


_INSTANTIATE = ct.CFUNCTYPE(
    *(ct.c_void_p, ct.c_char_p, ct.c_int, ct.c_char_p, ct.c_char_p, ct.c_void_p, ct.c_int, ct.c_int)
)
_FREE = ct.CFUNCTYPE(None, ct.c_void_p)


@cache
def _kind(name: str) -> Any:
    """C type of a function whose pointers are plain addresses."""
    return ct.CFUNCTYPE(ct.c_int, ct.c_void_p, *types(name))
