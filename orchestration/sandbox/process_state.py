"""What a library can change for its whole process or thread, and should leave alone.

These are how numbers are computed, the locale, the working directory, and what a signal does. `ProcessState` remembers
them and puts them back. A library built with ``-ffast-math``, say, makes tiny numbers 0 when it is loaded, and so
changes the results of all others.
"""

import ctypes
import locale
import os
import platform
import signal
import struct
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from typing import Any

_ENVIRONMENT_BYTES, _ACTION_BYTES = 64, 256  # more than any system's fenv_t and struct sigaction take
_HANDLER = f"P{_ACTION_BYTES - struct.calcsize('P')}x"  # struct sigaction: the address of the function is first
_ROUNDING, _TINY, _TRAPS, _PRECISION = (
    "the rounding mode",
    "the treatment of tiny numbers (flush to zero)",
    "the traps of arithmetic",
    "the precision of the x87 unit",
)
_LOCALE, _FOLDER, _HANDLERS = "the locale", "the working directory", "the handlers of signals"
# Where fenv_t keeps its control bits: offset, bytes, and the bits by what they decide.
_X87 = (0, 2, {_ROUNDING: 0x0C00, _PRECISION: 0x0300, _TRAPS: 0x003F})
_SSE = {_ROUNDING: 0x6000, _TINY: 0x8040, _TRAPS: 0x1F80}
_ARM = {_ROUNDING: 0x00C00000, _TINY: 0x01000000, _TRAPS: 0x00009F00}
_CONTROLS: Mapping[tuple[str, str], tuple[tuple[int, int, Mapping[str, int]], ...]] = {
    ("linux", "x86_64"): (_X87, (28, 4, _SSE)),
    ("linux", "aarch64"): ((0, 4, _ARM),),
    ("darwin", "x86_64"): (_X87, (4, 4, _SSE)),
    ("darwin", "arm64"): ((8, 8, _ARM),),
}
CHANGES_RESULTS = frozenset({_ROUNDING, _TINY, _TRAPS, _PRECISION})
"""What decides the results of arithmetic."""


@dataclass(frozen=True)
class ProcessState:
    """What a library could change, as it is at one time.

    How numbers are computed belongs to a thread, everything else to the process. Only the main thread looks at that,
    because other threads of a program may change it at the same time, for good reasons.

    Attributes
    ----------
    arithmetic
        Control bits by what they decide.
    locale
        Name of the locale; empty in another thread than the main one.
    folder
        Working directory; empty if it has been removed, and in another thread.
    handlers
        Addresses of the handlers of the signals that can be handled, by rising number; none in another thread.
    in_main_thread
        Whether the state was read in the main thread.
    raw
        Floating-point environment and handlers as the C library stores them.
    """

    arithmetic: Mapping[str, int]
    locale: str
    folder: str
    handlers: tuple[int, ...]
    in_main_thread: bool
    raw: tuple[bytes, bytes] = field(compare=False, repr=False)

    @classmethod
    def now(cls) -> "ProcessState":
        """The present state."""
        environment = _environment()
        if threading.current_thread() is not threading.main_thread():
            return cls(_controls(environment), "", "", (), False, (environment, b""))
        folder = ""
        with suppress(OSError):  # somebody has removed it
            folder = os.getcwd()
        actions = _actions()
        read = locale.setlocale(locale.LC_ALL), folder, _handlers().unpack(actions), True
        return cls(_controls(environment), *read, (environment, actions))

    def arithmetic_differs(self) -> bool:
        """Whether the process computes in another way than when this state was read; it costs a microsecond."""
        now = _environment()
        return now != self.raw[0] and _controls(now) != self.arithmetic

    def changes(self, now: "ProcessState") -> dict[str, str]:
        """What differs at a later time, each with how it is then, as a part of a sentence."""
        found = {name: "" for name, value in now.arithmetic.items() if value != self.arithmetic.get(name)}
        if not (self.in_main_thread and now.in_main_thread):
            return found
        if now.locale != self.locale:
            found[_LOCALE] = f" to {now.locale}"
        if now.folder != self.folder and self.folder:
            found[_FOLDER] = f" to {now.folder}" if now.folder else ""
        if changed := self._changed_handlers(now):
            found[_HANDLERS] = f" ({', '.join(_signal_name(_numbers()[k]) for k in changed)})"
        return found

    def restore(self) -> dict[str, str]:
        """Put back what has changed since, as far as the system takes it; returns that as `changes` does."""
        now = ProcessState.now()
        if now == self or not (changed := self.changes(now)):
            return {}
        if now.arithmetic != self.arithmetic:
            _math().fesetenv(ctypes.create_string_buffer(self.raw[0], _ENVIRONMENT_BYTES))
        if _LOCALE in changed:
            with suppress(locale.Error):
                locale.setlocale(locale.LC_ALL, self.locale)
        if _FOLDER in changed:
            with suppress(OSError):
                os.chdir(self.folder)
        for k in self._changed_handlers(now) if _HANDLERS in changed else ():
            action = self.raw[1][k * _ACTION_BYTES : (k + 1) * _ACTION_BYTES]
            _sigaction()(_numbers()[k], ctypes.create_string_buffer(action, _ACTION_BYTES), None)
        return changed

    def _changed_handlers(self, now: "ProcessState") -> list[int]:
        """Places of the handlers that differ."""
        return [k for k, handler in enumerate(self.handlers) if handler != now.handlers[k]]


@cache
def _math() -> Any:
    """The library of C's ``fenv.h``; None where its environment is not known."""
    if (sys.platform, platform.machine()) in _CONTROLS:
        with suppress(OSError):
            return ctypes.CDLL("libm.so.6" if sys.platform == "linux" else "/usr/lib/libSystem.B.dylib")
    return None


def _environment() -> bytes:
    """The floating-point environment of this thread; empty where it is not known."""
    library = _math()
    if library is None:
        return b""
    buffer = ctypes.create_string_buffer(_ENVIRONMENT_BYTES)
    library.fegetenv(buffer)
    return buffer.raw


def _controls(environment: bytes) -> dict[str, int]:
    """The control bits in a floating-point environment, by what they decide; none where it is not known."""
    found: dict[str, int] = {}
    for place, (offset, size, bits) in enumerate(_layout() if environment else ()):
        word = int.from_bytes(environment[offset : offset + size], "little")
        for name, mask in bits.items():
            found[name] = found.get(name, 0) | (word & mask) << (64 * place)
    return found


@cache
def _layout() -> tuple[tuple[int, int, Mapping[str, int]], ...]:
    return _CONTROLS.get((sys.platform, platform.machine()), ())


def _actions() -> bytes:
    """What happens on each signal, as the C library stores it; empty on Windows."""
    buffer, arguments = _room()
    for number, place in arguments:
        _sigaction()(number, None, place)
    return buffer.raw[: len(arguments) * _ACTION_BYTES]


@cache
def _room() -> tuple[Any, tuple[tuple[int, ctypes.c_void_p], ...]]:
    """Memory for `_actions`, of the main thread, and the place in it for each signal."""
    numbers = _numbers()
    buffer = ctypes.create_string_buffer(_ACTION_BYTES * max(1, len(numbers)))
    first = ctypes.addressof(buffer)
    return buffer, tuple((number, ctypes.c_void_p(first + k * _ACTION_BYTES)) for k, number in enumerate(numbers))


@cache
def _handlers() -> struct.Struct:
    """The addresses in what `_actions` returns."""
    return struct.Struct(_HANDLER * len(_numbers()))


@cache
def _numbers() -> tuple[int, ...]:
    """Signals that a process can handle, without those of real time."""
    if sys.platform == "win32":
        return ()
    return tuple(number for number in range(1, 32) if number not in (signal.SIGKILL, signal.SIGSTOP))


@cache
def _sigaction() -> Any:
    return ctypes.CDLL(None).sigaction


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
