"""What units log, through fmpy's proxy, while they are tested."""

import ctypes
import itertools
from functools import cache
from typing import Any
from weakref import WeakValueDictionary

from fmpy import fmi2
from fmpy.logging import addLoggerProxy

STATUS_NAMES = ("fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending")
_environments = itertools.count(2**31)  # far from those that others may count
_units: "WeakValueDictionary[int, Any]" = WeakValueDictionary()


def register(unit: Any) -> int:
    """A component environment for a unit with a list ``messages``."""
    environment = next(_environments)
    _units[environment] = unit
    return environment


def listen(callbacks: Any) -> None:
    """Let fmpy's proxy, which formats printf arguments and serves one logger at a time, serve ours."""
    callbacks.logger = _c_logger()
    addLoggerProxy(ctypes.byref(callbacks))


@cache
def _c_logger() -> Any:
    """The logger of all units, which is never freed; the environment tells them apart."""

    def log(environment: Any, _name: Any, _status: int, _category: Any, message: Any) -> None:
        unit = _units.get(environment or 0)
        if unit is not None:
            unit.messages.append((message or b"").decode(errors="replace").strip())

    return fmi2.fmi2CallbackLoggerTYPE(log)


def last_message(unit: Any) -> str:
    """What a unit logged last, as part of a sentence."""
    return f'its last message: "{unit.messages[-1]}"' if unit.messages else "it logged nothing"


def failure(unit: Any, error: Any) -> str:
    """The sentence for a call that failed, from fmpy's exception."""
    known = 0 <= error.status < len(STATUS_NAMES)
    status = STATUS_NAMES[error.status] if known else f"status {error.status}"
    where = f"t = {unit.time:.12g} s (step {unit.steps})"
    return f"{unit.name}: {error.function} returned {status} at {where}; {last_message(unit)}."
