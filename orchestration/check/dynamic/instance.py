"""A stranger's binary and its instances, called through ctypes; every call is announced before it is made.

Runs in the worker's process only: a call may crash, hang or print.
"""

import ctypes as ct
import itertools
import math
import struct
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from orchestration.check.findings import shown
from orchestration.fmi import signatures
from orchestration.fmi.signatures import OK, WARNING, Allocate, Callbacks, Free, Logger

STATUS = ("fmi2OK", "fmi2Warning", "fmi2Discard", "fmi2Error", "fmi2Fatal", "fmi2Pending")
KEPT_MESSAGES, LONGEST_MESSAGE = 5, 300
_INTEGERS = ("Integer", "Boolean")
Values = Mapping[str, float | str]


class RefusedError(Exception):
    """A call that ought to work returned something else."""


class MissingError(Exception):
    """The library lacks a function."""


class Binary:
    """The library.

    Parameters
    ----------
    plan
        What `orchestration.check.dynamic.supervision` wrote down about the FMU.
    announce
        Told the name of each function before it is called.
    """

    def __init__(self, plan: Mapping[str, Any], announce: Callable[[str], None]) -> None:
        self.plan, self._announce = plan, announce
        self._library = ct.CDLL(plan["library"])
        self.variables = {row["name"]: row for row in plan["variables"]}
        self._alive: list[Any] = []  # callbacks that an instance may call until the end

    def lacks(self) -> list[str]:
        """Functions that are not exported."""
        return [name for name in signatures.FUNCTIONS if not hasattr(self._library, name)]

    def function(self, name: str) -> Callable[..., Any]:
        """A function, announced when it is called.

        Raises
        ------
        MissingError
        """
        try:
            found = getattr(self._library, name)
        except AttributeError:
            raise MissingError(name) from None
        if name in signatures.OTHERS:
            found.restype, found.argtypes = signatures.OTHERS[name]
        else:
            found.restype, found.argtypes = ct.c_int, (ct.c_void_p, *signatures.ARGUMENTS[name])

        def announced(*arguments: Any) -> Any:
            self._announce(name)
            result = found(*arguments)
            self._announce("")
            return result

        return announced

    def create(self, messages: list[str], *, guid: str | None = None, name: str = "checked") -> int | None:
        """A new component, None if it is refused."""
        environment = next(_environments)
        _heard[environment] = messages
        callbacks = Callbacks(_logger(), *_memory(), None, environment)
        _format_messages(callbacks)
        self._alive.append(callbacks)
        return self.function("fmi2Instantiate")(
            name.encode(),
            signatures.CO_SIMULATION,
            (self.plan["guid"] if guid is None else guid).encode(),
            self.plan["resources"].encode(),
            ct.byref(callbacks),
            0,
            1,  # logging on: the last message goes into the finding
        )

    def names(self, causality: str, *types: str) -> list[str]:
        """Variables of a causality and of types, of any but String if there are none."""
        rows = self.variables.values()
        chosen = types or ("Real", *_INTEGERS)
        return [row["name"] for row in rows if row["causality"] == causality and row["type"] in chosen]

    def starts(self) -> dict[str, float]:
        """Start values of inputs."""
        return {name: self.variables[name]["start"] or 0.0 for name in self.names("input")}


class Instance:
    """A component that keeps its time; a context manager that frees it."""

    _numbers = itertools.count(1)

    def __init__(self, binary: Binary) -> None:
        self.binary, self.time, self.messages = binary, 0.0, []
        self.component = binary.create(self.messages, name=f"checked{next(self._numbers)}")
        if not self.component:
            msg = f"fmi2Instantiate refuses the GUID of the description{self._said()}."
            raise RefusedError(msg)

    def __enter__(self) -> Self:
        """The instance itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Free the component."""
        self.free()

    def free(self) -> None:
        """Free the component, once."""
        if self.component:
            component, self.component = self.component, None
            self.binary.function("fmi2FreeInstance")(component)

    def status(self, function: str, *arguments: Any) -> int:
        """Status that a function returns."""
        return self.binary.function(function)(self.component, *arguments)

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function that ought to work.

        Raises
        ------
        RefusedError
        """
        status = self.status(function, *arguments)
        if status not in (OK, WARNING):
            msg = f"{function} returns {status_name(status)} at t = {self.time:.9g} s{self._said()}."
            raise RefusedError(msg)

    def enter(self) -> Self:
        """Go to initialization mode; no stop time, as ecos and libcosim have it."""
        self.time = self.binary.plan["start_time"]
        self.call("fmi2SetupExperiment", 0, 0.0, self.time, 0, 0.0)
        self.call("fmi2EnterInitializationMode")
        return self

    def initialize(self) -> Self:
        """Go to where steps are made."""
        self.enter().call("fmi2ExitInitializationMode")
        return self

    def step(self, h: float | None = None) -> None:
        """A step, of the usual length by default."""
        length = self.binary.plan["step"] if h is None else h
        self.call("fmi2DoStep", self.time, length, 1)
        self.time += length

    def set(self, values: Values) -> None:
        """Set variables by name, one call each."""
        for name, value in values.items():
            row = self.binary.variables[name]
            self.call(f"fmi2Set{row['type']}", references([row["reference"]]), 1, _pointer(row["type"], value))

    def get(self, names: Iterable[str]) -> tuple[float, ...]:
        """Values by name."""
        found = []
        for name in names:
            row = self.binary.variables[name]
            number = ct.c_double() if row["type"] == "Real" else ct.c_int()
            self.call(f"fmi2Get{row['type']}", references([row["reference"]]), 1, ct.byref(number))
            found.append(float(number.value))
        return tuple(found)

    def outputs(self) -> tuple[float, ...]:
        """All outputs but strings."""
        return self.get(self.binary.names("output"))

    def _said(self) -> str:
        return f' ("{shown(self.messages[-1], LONGEST_MESSAGE)}")' if self.messages else ""


def references(numbers: Sequence[int]) -> Any:
    """C array of value references."""
    return (ct.c_uint * len(numbers))(*numbers)


def reals(numbers: Sequence[float]) -> Any:
    """C array of doubles."""
    return (ct.c_double * len(numbers))(*numbers)


def status_name(status: int) -> str:
    """Name of a status."""
    return STATUS[status] if 0 <= status < len(STATUS) else f"the status {status}, which FMI does not know,"


def bits(values: Sequence[float]) -> bytes:
    """What makes two outputs the same: every bit."""
    return struct.pack(f"<{len(values)}d", *values)


def not_finite(names: Sequence[str], values: Sequence[float]) -> list[str]:
    """Names with their values that are NaN or infinite."""
    return [f"{name} = {value:g}" for name, value in zip(names, values, strict=True) if not math.isfinite(value)]


def _pointer(type_: str, value: float | str) -> Any:
    return ct.byref(ct.c_double(float(value)) if type_ == "Real" else ct.c_int(int(value)))


_environments = itertools.count(1)
_heard: dict[int, list[str]] = {}  # the last messages, by component environment


@cache
def _logger() -> Any:
    """The logger of all instances, which keeps their last messages."""

    def log(environment: Any, name: Any, status: int, category: Any, message: Any) -> None:  # noqa: ARG001
        with suppress(Exception):
            messages = _heard[environment or 0]
            messages[:] = [*messages, (message or b"").decode(errors="replace").strip()][-KEPT_MESSAGES:]

    return Logger(log)


def _format_messages(callbacks: Callbacks) -> None:
    """Put fmpy's proxy before the logger: it formats the arguments of a message, which ctypes cannot see."""
    if (library := _proxy()) is not None:
        library.addLoggerProxy(ct.byref(callbacks))


@cache
def _proxy() -> Any:
    """Fmpy's library for messages, without the time that importing fmpy takes; None if this machine has none."""
    fmpy = find_spec("fmpy")
    name = {"win32": "win64/logging.dll", "darwin": "darwin64/logging.dylib"}.get(sys.platform, "linux64/logging.so")
    if fmpy is None or fmpy.origin is None:
        return None
    with suppress(OSError):
        return ct.CDLL(str(Path(fmpy.origin).parent / "logging" / name))
    return None


def _memory() -> tuple[Any, Any]:
    """The C library's calloc and free as callbacks."""
    c = ct.CDLL("msvcrt") if hasattr(ct, "WinDLL") else ct.CDLL(None)
    return (
        Allocate(ct.cast(c.calloc, ct.c_void_p).value or 0),
        Free(ct.cast(c.free, ct.c_void_p).value or 0),
    )
