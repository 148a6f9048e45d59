"""A library whose calls are watched: they must leave their host, and what they are given to read, as it was."""

import ctypes as ct
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from orchestration.check.findings import Finding, error, shown, warning
from orchestration.fmi.library import Library
from orchestration.sandbox.process_state import CHANGES_RESULTS, ProcessState

RULE = "17"
LOADING = "loading the library"
ALWAYS_WATCHED = 200  # calls of a function that reads or sets values; later every 50th is watched in full
SELDOM = 50
_OFTEN_CALLED = ("fmi2Get", "fmi2Set")
# Arguments that a function must only read, by position, with what they are.
_READ_ONLY: dict[str, dict[int, str]] = {
    "fmi2Instantiate": {0: "the name", 2: "the GUID", 3: "the location of resources", 4: "the callback functions"},
    "fmi2SetDebugLogging": {3: "the categories"},
    "fmi2DeSerializeFMUstate": {1: "the serialized state"},
    "fmi2GetDirectionalDerivative": {1: "the value references", 3: "the value references", 5: "the differential"},
    "fmi2SetRealInputDerivatives": {1: "the value references", 3: "the orders", 4: "the values"},
    "fmi2GetRealOutputDerivatives": {1: "the value references", 3: "the orders"},
    **{f"fmi2Get{kind}": {1: "the value references"} for kind in ("Real", "Integer", "Boolean", "String")},
    **{
        f"fmi2Set{kind}": {1: "the value references", 3: "the values"}
        for kind in ("Real", "Integer", "Boolean", "String")
    },
}
# The position of the array that a function fills, and of its length.
_FILLED = {
    **{f"fmi2Get{kind}": (3, 2) for kind in ("Real", "Integer", "Boolean")},
    "fmi2GetDirectionalDerivative": (6, 2),
    "fmi2GetRealOutputDerivatives": (4, 2),
    "fmi2SerializeFMUstate": (2, 3),
}
_BEHIND = bytes(range(64))  # bytes behind such an array that must stay


class WatchedLibrary(Library):
    """A loaded library of an FMU that reports the first call that changes what it must not change.

    Parameters
    ----------
    path
        Absolute path of the file.
    tell
        Receives a finding for each kind of change.
    told
        Kinds of changes that have been reported already; further ones are added.

    Raises
    ------
    OSError
        If the library, or one that it needs, cannot be loaded.
    """

    def __init__(self, path: Path, tell: Callable[[Finding], None], told: list[str]) -> None:
        self._tell, self._told, self._calls = tell, told, Counter[str]()
        self._watched: dict[str, Callable[..., Any]] = {}
        self._usual = ProcessState.now()
        super().__init__(path)
        self._compare_host(LOADING)

    def function(self, name: str) -> Callable[..., Any]:
        """An FMI function with its C types, whose calls are watched.

        Raises
        ------
        AttributeError
            If the library does not export it.
        """
        if name not in self._watched:
            self._watched[name] = self._watching(name, super().function(name))
        return self._watched[name]

    def _watching(self, name: str, bare: Callable[..., Any]) -> Callable[..., Any]:
        """A function that is watched."""
        read_only = _READ_ONLY.get(name, {})

        def watched(*arguments: Any) -> Any:
            before = [(what, arguments[i], _content(arguments[i])) for i, what in read_only.items()]
            answer = self._bounded(name, bare, arguments)
            for what, argument, content in before:
                if _content(argument) != content:
                    self._report(what, error(RULE, f"{name} writes into {what}, which it is given to read."))
            if self._is_due(name):
                self._compare_host(name)
            return answer

        return watched

    def _bounded(self, name: str, bare: Callable[..., Any], arguments: Sequence[Any]) -> Any:
        """Call a function, and report it if it writes behind the array that it fills."""
        place, length = _FILLED.get(name, (0, 0))
        filled = getattr(arguments[place], "_obj", arguments[place]) if place else None  # of ctypes.byref
        if not isinstance(filled, ct.Array | ct._SimpleCData):
            return bare(*arguments)
        kind = filled._type_ if isinstance(filled, ct.Array) else type(filled)
        size = ct.sizeof(kind) * arguments[length]
        room = (ct.c_char * (size + len(_BEHIND))).from_buffer_copy(bytes(filled)[:size] + _BEHIND)
        answer = bare(*arguments[:place], ct.cast(room, ct.POINTER(kind)), *arguments[place + 1 :])
        ct.memmove(ct.addressof(filled), room, size)
        if room.raw[size:] != _BEHIND:
            self._report("beyond", error(RULE, f"{name} writes beyond the values that it is asked for."))
        return answer

    def _is_due(self, name: str) -> bool:
        """Whether the whole state of the host is read after a call."""
        self._calls[name] += 1
        seldom = name.startswith(_OFTEN_CALLED) and self._calls[name] > ALWAYS_WATCHED
        return not seldom or self._calls[name] % SELDOM == 0 or self._usual.arithmetic_differs()

    def _compare_host(self, call: str) -> None:
        """Report what a call has changed in its host, and undo the change."""
        for what, how in self._usual.restore().items():
            said = f"{call[0].upper()}{call[1:]}" if call == LOADING else call
            if what in CHANGES_RESULTS:
                effect = "all that this process computes from then on has other results"
                self._report(what, error(RULE, f"{said} changes {what}: {effect}."))
            else:
                self._report(what, warning(RULE, f"{said} changes {what}{shown(how)} of its host."))

    def _report(self, what: str, finding: Finding) -> None:
        """Report a kind of change once."""
        if what not in self._told:
            self._told.append(what)
            self._tell(finding)


def _content(argument: Any) -> Sequence[object]:
    """A copy of what an argument of a C function points to, texts included."""
    if isinstance(argument, bytes):
        return [bytes(bytearray(argument))]
    pointed = getattr(argument, "_obj", argument)  # of ctypes.byref
    if not isinstance(pointed, (ct.Array, ct.Structure, ct._SimpleCData)):
        return []
    found: list[object] = [ct.string_at(ct.addressof(pointed), ct.sizeof(pointed))]
    if isinstance(pointed, ct.Array) and getattr(pointed, "_type_", None) is ct.c_char_p:
        found += [bytes(bytearray(text)) for text in pointed if text is not None]
    return found
