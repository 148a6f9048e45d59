"""Collects the messages that FMUs log, with one logger for all instances of a process.

A message of FMI is a printf format with arguments that Python cannot read. A small library in fmpy's package
formats the message before it calls the logger. Where the library does not exist (Linux on ARM) or does not load,
a text stays as the FMU wrote it.
"""

import ctypes as ct
import itertools
import sys
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any
from weakref import WeakValueDictionary

from adaptimp_fmu.files.parts import MissingPartError
from adaptimp_fmu.files.standards import standard_file
from orchestration.errors import printable
from orchestration.fmi.codes import Status, status_name
from orchestration.fmi.deferred import keep
from orchestration.fmi.signatures import Allocate, Callbacks, Free, Logger

KEPT_MESSAGES = 100
"""Number of messages that an instance keeps of a whole run."""
FIRST_SHOWN, LAST_SHOWN = 20, 20
"""Number of messages of one call that a sentence shows: those at its beginning, and those at its end."""
LONGEST_TEXT = 2000  # characters of a text that are kept
_PROXIES = {
    "linux": ("linux64", "logging.so"),
    "darwin": ("darwin64", "logging.dylib"),
    "win32": ("win64", "logging.dll"),
}


class Message(str):
    """A text that an FMU logged, with its fmi2Status."""

    __slots__ = ("status",)
    status: int

    def __new__(cls, text: str, status: int = 0) -> "Message":
        """Make a text with a status: one line that is safe to show, of a long text the beginning."""
        made = super().__new__(cls, printable(text, LONGEST_TEXT))
        made.status = status
        return made

    def __str__(self) -> str:
        """The text, with the status unless that is fmi2OK."""
        text = super().__str__()
        return text if self.status == Status.OK else f"{status_name(self.status)}: {text}"


class Messages(deque[str]):
    """The last texts that an instance of an FMU logged, the newest last; `None` as length keeps all.

    Attributes
    ----------
    total
        Number of all texts so far.
    listener
        Called once, when a text comes; the text then belongs to a call that nobody has told of.
    """

    def __init__(self, most: int | None = KEPT_MESSAGES) -> None:
        super().__init__(maxlen=most)
        self.total = self._before_call = self._warnings = 0
        self._warning, self._warned = "", False
        self.listener: Callable[[], None] | None = None
        self._first: list[str] = []
        self._last: deque[str] = deque(maxlen=LAST_SHOWN)

    def begin_call(self) -> None:
        """Say that the FMU is called: later texts belong to this call."""
        if self._before_call != self.total:
            self._before_call = self.total
            self._first.clear()
            self._last.clear()

    def forget(self) -> None:
        """Forget all texts, and whose call they are, but not that a warning was told."""
        self.clear()
        self.total = self._before_call = self._warnings = 0
        self._warning, self.listener = "", None
        self._first.clear()
        self._last.clear()

    def append(self, text: str) -> None:
        """Take a text."""
        listener, self.listener = self.listener, None
        if listener is not None:
            self.begin_call()
            listener()
        text = text if isinstance(text, Message) else Message(text)
        super().append(text)
        self.total += 1
        (self._first if len(self._first) < FIRST_SHOWN else self._last).append(text)
        if isinstance(text, Message) and text.status == Status.WARNING:
            self._warning, self._warnings = self._warning or _plain(text), self._warnings + 1

    def take_warnings(self) -> tuple[str, int]:
        """Return the first text with the status fmi2Warning, and the number of such texts; 0 after it was told once."""
        if self._warned or not self._warnings:
            return "", 0
        self._warned = True
        return self._warning, self._warnings

    def last(self) -> str:
        """Return the texts of the last call, in their order, as a part of a sentence."""
        count = self.total - self._before_call
        if count == 0:
            return f'it logged nothing then, and before: "{_plain(self[-1])}"' if self else "it logged nothing"
        if count == 1:
            return f'its last message: "{_plain(self[-1])}"'
        quoted = [f'"{_plain(text)}"' for text in (*self._first, *self._last)]
        if left := count - len(quoted):
            quoted.insert(FIRST_SHOWN, f"{left} more")
        return f"its {count} messages: {', '.join(quoted)}"


def _plain(text: str) -> str:
    """A text without its status."""
    return "".join(text)


_environments = itertools.count(1)
_heard: WeakValueDictionary[int, Messages] = WeakValueDictionary()


@Logger
def _log(environment: Any, name: Any, status: int, category: Any, message: Any) -> None:  # noqa: ARG001
    """Keep a text for the instance that the component environment names; an error must not reach the C code."""
    try:
        messages = _heard.get(environment or 0)
        if messages is not None:
            messages.append(Message((message or b"").decode(errors="replace").strip(), status))
    except BaseException as error:
        keep(error)


def callbacks(messages: Messages) -> Callbacks:
    """Return the callbacks for a new instance, which must live as long as it; `messages` receives its texts."""
    environment = next(_environments)
    _heard[environment] = messages
    found = Callbacks(_log, *_memory(), None, environment)
    if (proxy := _proxy()) is not None:
        proxy.addLoggerProxy(ct.byref(found))
    return found


def heard(environment: int | None) -> Messages | None:
    """Return what receives the texts of the instance with a component environment."""
    return _heard.get(environment or 0)


def listen() -> None:
    """Set the logger that fmpy's library calls; it knows one logger, and another tool may have set its own."""
    if (proxy := _proxy()) is not None:
        proxy.addLoggerProxy(ct.byref(Callbacks(_log)))


@cache
def _proxy() -> Any:
    """Load the library that formats messages; None if this machine has none."""
    if sys.platform not in _PROXIES:
        return None
    with suppress(MissingPartError, OSError):
        return ct.CDLL(str(standard_file("logging", *_PROXIES[sys.platform])))
    return None


@cache
def _memory() -> tuple[Any, Any]:
    """The C library's calloc and free as callbacks."""
    c = ct.CDLL("msvcrt") if sys.platform == "win32" else ct.CDLL(None)
    return (
        Allocate(ct.cast(c.calloc, ct.c_void_p).value or 0),
        Free(ct.cast(c.free, ct.c_void_p).value or 0),
    )
