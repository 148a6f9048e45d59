"""Collects the messages that FMUs log, with one logger for all instances of a process.

A message of FMI is a printf format with arguments that Python cannot read. A small library in fmpy's package
formats the message before it calls the logger. Where the library does not exist (Linux on ARM) or does not load,
a text stays as the FMU wrote it.
"""

import ctypes as ct
import itertools
import sys
from collections import deque
from contextlib import suppress
from functools import cache
from typing import Any
from weakref import WeakValueDictionary

from orchestration.errors import ArchiveError
from orchestration.fmi.fmpy_files import fmpy_file
from orchestration.fmi.signatures import Allocate, Callbacks, Free, Logger

KEPT_MESSAGES = 5
_PROXIES = {
    "linux": ("linux64", "logging.so"),
    "darwin": ("darwin64", "logging.dylib"),
    "win32": ("win64", "logging.dll"),
}


class Messages(deque[str]):
    """The last texts that an instance of an FMU logged, the newest last; `None` as length keeps all."""

    def __init__(self, most: int | None = KEPT_MESSAGES) -> None:
        super().__init__(maxlen=most)

    def last(self) -> str:
        """Return the newest text as a part of a sentence."""
        return f'its last message: "{self[-1]}"' if self else "it logged nothing"


_environments = itertools.count(1)
_heard: WeakValueDictionary[int, Messages] = WeakValueDictionary()


@Logger
def _log(environment: Any, name: Any, status: int, category: Any, message: Any) -> None:  # noqa: ARG001
    """Keep a text for the instance that the component environment names; an error must not reach the C code."""
    with suppress(Exception):
        messages = _heard.get(environment or 0)
        if messages is not None:
            messages.append((message or b"").decode(errors="replace").strip())


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
    with suppress(ArchiveError, OSError):
        return ct.CDLL(str(fmpy_file("logging", *_PROXIES[sys.platform])))
    return None


@cache
def _memory() -> tuple[Any, Any]:
    """The C library's calloc and free as callbacks."""
    c = ct.CDLL("msvcrt") if sys.platform == "win32" else ct.CDLL(None)
    return (
        Allocate(ct.cast(c.calloc, ct.c_void_p).value or 0),
        Free(ct.cast(c.free, ct.c_void_p).value or 0),
    )
