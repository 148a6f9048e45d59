"""What a call into a library may change in its host and must leave alone: arithmetic, locale, folder, signals.

A host computes with the rounding mode and the treatment of tiny numbers that its process has. A library that changes
them, which a library built with ``-ffast-math`` does when it is loaded, changes the results of all others.
"""

import ctypes as ct
import locale
import os
import platform
import signal
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

_ENVIRONMENT_BYTES = 64  # of fenv_t, more than any C library needs
_HANDLER_BYTES = 256  # of struct sigaction
_ROUNDING, _TINY, _TRAPS = (
    "the rounding mode",
    "the treatment of tiny numbers (flush to zero)",
    "the traps of arithmetic",
)
# Where fenv_t keeps its control bits: offset, bytes, and the bits by what they decide.
_X86_PRECISION = (0, 2, {_ROUNDING: 0x0C00, "the precision of the x87 unit": 0x0300, _TRAPS: 0x003F})
_SSE = {_ROUNDING: 0x6000, _TINY: 0x8040, _TRAPS: 0x1F80}
_ARM = {_ROUNDING: 0x00C00000, _TINY: 0x01000000, _TRAPS: 0x00009F00}
_CONTROLS: Mapping[tuple[str, str], tuple[tuple[int, int, Mapping[str, int]], ...]] = {
    ("linux", "x86_64"): (_X86_PRECISION, (28, 4, _SSE)),
    ("linux", "aarch64"): ((0, 4, _ARM),),
    ("darwin", "x86_64"): (_X86_PRECISION, (4, 4, _SSE)),
    ("darwin", "arm64"): ((8, 8, _ARM),),
}
CHANGES_RESULTS = frozenset({_ROUNDING, _TINY, _TRAPS, "the precision of the x87 unit"})
"""What decides the results of arithmetic."""


@dataclass(frozen=True)
class HostState:
    """A reading of the state of this process.

    Attributes
    ----------
    arithmetic
        Control bits by what they decide.
    locale
        Name of the locale.
    folder
        Working directory; empty if it has been removed.
    handlers
        Addresses of the handlers of signals, by number.
    """

    arithmetic: Mapping[str, int]
    locale: str
    folder: str
    handlers: Mapping[int, int]
    _environment: bytes
    _actions: Mapping[int, bytes]

    @classmethod
    def read(cls) -> "HostState":
        """Read the state of this process."""
        environment = _environment()
        folder = ""
        with suppress(OSError):
            folder = os.getcwd()
        actions = _actions()
        handlers = {number: int.from_bytes(action[:8], sys.byteorder) for number, action in actions.items()}
        return cls(_controls(environment), locale.setlocale(locale.LC_ALL), folder, handlers, environment, actions)

    def arithmetic_differs(self) -> bool:
        """Whether the process computes in another way than when this state was read; it costs a microsecond."""
        now = _environment()
        return now != self._environment and _controls(now) != self.arithmetic

    def changes(self, now: "HostState") -> dict[str, str]:
        """Return what has changed, each with the new state as a part of a sentence."""
        found = {name: "" for name, value in now.arithmetic.items() if value != self.arithmetic.get(name)}
        if now.locale != self.locale:
            found["the locale"] = f" to {now.locale}"
        if now.folder != self.folder:
            found["the working directory"] = f" to {now.folder}" if now.folder else ""
        changed = [number for number, handler in now.handlers.items() if handler != self.handlers.get(number)]
        if changed:
            found["the handlers of signals"] = f" ({', '.join(map(_signal_name, changed))})"
        return found

    def restore(self) -> None:
        """Give the process this state back, as far as the system takes it."""
        library = _math()
        if library is not None and self._environment:
            library.fesetenv(ct.create_string_buffer(self._environment, len(self._environment)))
        with suppress(locale.Error):
            locale.setlocale(locale.LC_ALL, self.locale)
        with suppress(OSError):
            os.chdir(self.folder)
        for number, action in self._actions.items():
            _sigaction()(number, ct.create_string_buffer(action, len(action)), None)


@cache
def _math() -> ct.CDLL | None:
    """The library of C's ``fenv.h``; None where it is not known."""
    names = {"linux": "libm.so.6", "darwin": "/usr/lib/libSystem.B.dylib"}
    with suppress(OSError, KeyError):
        return ct.CDLL(names[sys.platform])
    return None


def _environment() -> bytes:
    """The floating-point environment of this thread; empty where it is not known."""
    library = _math()
    if library is None:
        return b""
    buffer = ct.create_string_buffer(_ENVIRONMENT_BYTES)
    library.fegetenv(buffer)
    return buffer.raw


def _controls(environment: bytes) -> dict[str, int]:
    """The control bits in a floating-point environment, by what they decide."""
    found: dict[str, int] = {}
    for place, (offset, size, bits) in enumerate(_CONTROLS.get((sys.platform, platform.machine()), ())):
        word = int.from_bytes(environment[offset : offset + size], "little")
        for name, mask in bits.items():
            found[name] = found.get(name, 0) | (word & mask) << (64 * place)
    return found


@cache
def _sigaction() -> Any:
    return ct.CDLL(None).sigaction


def _actions() -> dict[int, bytes]:
    """What the process does on each signal, as the C library stores it; empty on Windows."""
    if os.name != "posix":
        return {}
    found, buffer = {}, ct.create_string_buffer(_HANDLER_BYTES)
    for number in range(1, 32):
        if number not in (signal.SIGKILL, signal.SIGSTOP) and _sigaction()(number, None, buffer) == 0:
            found[number] = buffer.raw
    return found


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
