"""What a library can change for its whole process or thread, and should leave alone.

Such things are how numbers are rounded and whether tiny ones become 0, the locale, the working directory, and what a
signal does. `ProcessState` remembers them and puts them back.
"""

import ctypes
import locale
import os
import platform
import signal
import sys
import threading
from dataclasses import dataclass, field
from functools import cache
from typing import Any

_ENVIRONMENT_BYTES, _ACTION_BYTES = 64, 256  # more than any system's fenv_t and struct sigaction take
_HANDLER_BYTES = 8  # of struct sigaction: the address of the function
_EXCEPTIONS = 0x3F  # bits of MXCSR that computing sets
_ROUNDING, _TINY = 0x6000, 0x8040  # bits of MXCSR: the rounding mode; tiny results and operands are 0
_SIGNALS = ("HUP", "INT", "QUIT", "ILL", "ABRT", "BUS", "FPE", "SEGV", "PIPE", "ALRM", "TERM", "CHLD", "USR1", "USR2")
# Bytes of fenv_t that choose how numbers are computed, by system and processor.
_CHOICES: dict[tuple[str, str], tuple[slice, ...]] = {
    ("linux", "x86_64"): (slice(28, 32), slice(0, 2)),
    ("linux", "aarch64"): (slice(0, 4),),
    ("darwin", "x86_64"): (slice(4, 8), slice(0, 2)),
    ("darwin", "arm64"): (slice(8, 16),),
}


@dataclass(frozen=True)
class ProcessState:
    """What a library could change, as it is at one time.

    The rounding belongs to a thread, everything else to the process. Only the main thread looks at that, because
    other threads of a program may change it at the same time, for good reasons.
    """

    computing: tuple[bytes, ...]
    locale: str
    folder: str
    handlers: tuple[bytes, ...]
    raw: tuple[bytes, tuple[bytes, ...]] = field(compare=False, repr=False)

    @classmethod
    def now(cls) -> "ProcessState":
        """The present state."""
        environment = _environment()
        computing = _choices(environment)
        if threading.current_thread() is not threading.main_thread():
            return cls(computing, "", "", (), (environment, ()))
        try:
            folder = os.getcwd()
        except OSError:  # somebody has removed it
            folder = ""
        actions = _actions()
        handlers = tuple(action[:_HANDLER_BYTES] for action in actions)
        return cls(computing, locale.setlocale(locale.LC_ALL), folder, handlers, (environment, actions))

    def restore(self) -> list[str]:
        """Put everything back that has changed since; returns what that was, as parts of a sentence."""
        now = ProcessState.now()
        if now == self:
            return []
        found = []
        if now.computing != self.computing:
            found += _computing(now.computing, self.computing)
            _c().fesetenv(ctypes.create_string_buffer(self.raw[0], _ENVIRONMENT_BYTES))
        if now.locale != self.locale:
            found.append(f"the locale (to {now.locale})")
            locale.setlocale(locale.LC_ALL, self.locale)
        if now.folder != self.folder and self.folder:
            found.append(f"the working directory (to {now.folder})")
            os.chdir(self.folder)
        if now.handlers != self.handlers:
            changed = [k for k, handler in enumerate(self.handlers) if handler != now.handlers[k]]
            found.append(f"what happens on {', '.join(_numbers()[k].name for k in changed)}")
            for k in changed:
                _c().sigaction(_numbers()[k], ctypes.create_string_buffer(self.raw[1][k], _ACTION_BYTES), None)
        return found


def _computing(now: tuple[bytes, ...], before: tuple[bytes, ...]) -> list[str]:
    """What of the computing with numbers has changed."""
    if platform.machine() != "x86_64":
        return ["how numbers are rounded"]
    changed = int.from_bytes(now[0], "little") ^ int.from_bytes(before[0], "little")
    found = ["the rounding mode"] if changed & _ROUNDING or now[1] != before[1] else []
    found += ["whether tiny numbers become 0"] if changed & _TINY else []
    return found or ["what happens on an invalid operation"]


def _choices(environment: bytes) -> tuple[bytes, ...]:
    """The parts of a floating-point environment that choose, without those that computing sets."""
    key = (sys.platform, platform.machine())
    parts = tuple(environment[part] for part in _CHOICES.get(key, ()))
    if key[1] != "x86_64" or not parts:
        return parts
    choosing = int.from_bytes(parts[0], "little") & ~_EXCEPTIONS
    return choosing.to_bytes(4, "little"), *parts[1:]


def _environment() -> bytes:
    """The floating-point environment of this thread; zeros if it is unknown."""
    if (sys.platform, platform.machine()) not in _CHOICES or not hasattr(_c(), "fegetenv"):
        return bytes(_ENVIRONMENT_BYTES)
    buffer = ctypes.create_string_buffer(_ENVIRONMENT_BYTES)
    _c().fegetenv(buffer)
    return buffer.raw


def _actions() -> tuple[bytes, ...]:
    """What happens on each signal that people use."""
    if sys.platform == "win32":
        return ()
    numbers, sigaction = _numbers(), _c().sigaction
    buffer = ctypes.create_string_buffer(_ACTION_BYTES * len(numbers))
    first = ctypes.addressof(buffer)
    for k, number in enumerate(numbers):
        sigaction(int(number), None, ctypes.c_void_p(first + k * _ACTION_BYTES))
    raw = buffer.raw
    return tuple(raw[k * _ACTION_BYTES : (k + 1) * _ACTION_BYTES] for k in range(len(numbers)))


@cache
def _numbers() -> tuple[signal.Signals, ...]:
    return tuple(signal.Signals[f"SIG{name}"] for name in _SIGNALS if f"SIG{name}" in signal.Signals.__members__)


@cache
def _c() -> Any:
    """The libraries of C that this process has loaded."""
    return ctypes.CDLL(None)
