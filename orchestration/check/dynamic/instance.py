"""Calls the binary of an unknown FMU through ctypes; every call is announced before it is made.

The module runs in a child process only, since a call may crash, hang or print.
"""

import ctypes as ct
import itertools
import math
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from orchestration.check.dynamic.watched_library import LOADING, WatchedLibrary
from orchestration.check.findings import Finding, shown
from orchestration.errors import InitializationError
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, accepted, status_name
from orchestration.fmi.instance import C_TYPES, c_references
from orchestration.fmi.instance import Instance as Component
from orchestration.fmi.logging import Messages

LONGEST_MESSAGE = 300
Values = Mapping[str, float | str]


class RefusedError(Exception):
    """The FMU refused a call that FMI 2.0 allows."""


class MissingError(Exception):
    """The FMU's library does not export a function."""


class Binary:
    """The shared library of an FMU under check.

    Parameters
    ----------
    plan
        Facts about the FMU that `orchestration.check.dynamic.supervision` wrote down.
    announce
        Receives the name of each function before the call, and an empty text after it.
    tell
        Receives findings about calls that change what they must not change.

    Raises
    ------
    OSError
        If the library cannot be loaded.
    """

    def __init__(
        self,
        plan: dict[str, Any],
        announce: Callable[[str], None],
        tell: Callable[[Finding], None] = lambda _: None,
    ) -> None:
        self.plan, self._announce = plan, announce
        announce(LOADING)
        self._library = WatchedLibrary(Path(plan["library"]), tell, plan.setdefault("told", []))
        announce("")
        self.variables = {row["name"]: row for row in plan["variables"]}

    def lacks(self) -> Sequence[str]:
        """Functions that are not exported."""
        return self._library.lacks()

    def ask(self, function: str) -> Any:
        """Return the answer of a function without arguments.

        Raises
        ------
        MissingError
        """
        with _naming_what_is_missing():
            found = self._library.function(function)
        self._announce(function)
        answer = found()
        self._announce("")
        return answer

    def create(self, messages: Messages, *, guid: str | None = None, name: str = "checked") -> Component:
        """Create an instance.

        Raises
        ------
        InitializationError
            If it is refused.
        MissingError
        """
        identity = (self.plan["guid"] if guid is None else guid, self.plan["resources"])
        with _naming_what_is_missing():
            return Component(self._library, name, identity, messages=messages, announce=self._announce)

    def names(self, causality: str, *types: str) -> list[str]:
        """Return the variables of a causality and of the given types; without types, all but String variables."""
        rows = self.variables.values()
        chosen = types or (REAL, INTEGER, BOOLEAN)
        return [row["name"] for row in rows if row["causality"] == causality and row["type"] in chosen]

    def starts(self) -> dict[str, float]:
        """Return the start values of the inputs."""
        return {name: self.variables[name]["start"] or 0.0 for name in self.names("input")}


class Instance:
    """An instance of an FMU that keeps its time; a context manager that frees the instance."""

    _numbers = itertools.count(1)

    def __init__(self, binary: Binary) -> None:
        self.binary, self.time, self.messages = binary, 0.0, Messages()
        try:
            self.component = binary.create(self.messages, name=f"checked{next(self._numbers)}")
        except InitializationError as refused:
            refuses_guid = any("guid" in message.lower() for message in self.messages)
            what = "refuses the GUID of the description" if refuses_guid else "returns no instance"
            msg = f"fmi2Instantiate {what}{self._said() or ', and logs no message'}."
            raise RefusedError(msg) from refused

    def __enter__(self) -> Self:
        """Return the instance itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Free the instance."""
        self.free()

    def free(self) -> None:
        """Free the instance; a second call does nothing."""
        with _naming_what_is_missing():
            self.component.close()

    def status(self, function: str, *arguments: Any) -> int:
        """Call a function with the instance and return its fmi2Status."""
        with _naming_what_is_missing():
            return self.component.status(function, *arguments)

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function with the instance that FMI 2.0 allows in this state.

        Raises
        ------
        RefusedError
        """
        status = self.status(function, *arguments)
        if not accepted(status):
            msg = f"{function} returns {status_name(status)} at t = {self.time:.9g} s{self._said()}."
            raise RefusedError(msg)

    def enter(self) -> Self:
        """Enter initialization mode without a stop time, as ecos and libcosim do."""
        self.time = self.binary.plan["start_time"]
        self.call("fmi2SetupExperiment", 0, 0.0, self.time, 0, 0.0)
        self.call("fmi2EnterInitializationMode")
        return self

    def initialize(self) -> Self:
        """Initialize the instance, so that steps can be made."""
        self.enter().call("fmi2ExitInitializationMode")
        return self

    def step(self, h: float | None = None) -> None:
        """Make a step, by default of the length that the plan proposes."""
        length = self.binary.plan["step"] if h is None else h
        self.call("fmi2DoStep", self.time, length, 1)
        self.time += length

    def set(self, values: Values) -> None:
        """Set variables by name, each with a call of its own."""
        for name, value in values.items():
            row = self.binary.variables[name]
            self.call(f"fmi2Set{row['type']}", c_references([row["reference"]]), 1, _pointer(row["type"], value))

    def get(self, names: Iterable[str]) -> tuple[float, ...]:
        """Return the values of variables by name."""
        found = []
        for name in names:
            row = self.binary.variables[name]
            number = C_TYPES[row["type"]]()
            self.call(f"fmi2Get{row['type']}", c_references([row["reference"]]), 1, ct.byref(number))
            found.append(float(number.value))
        return tuple(found)

    def outputs(self) -> tuple[float, ...]:
        """Return the values of all outputs but strings, by name."""
        return self.get(self.binary.names("output"))

    def _said(self) -> str:
        said = "".join(self.messages[-1]) if self.messages else ""  # without the status, which the call returns
        return f' ("{shown(said, LONGEST_MESSAGE)}")' if said else ""


def reals(numbers: Sequence[float]) -> Any:
    """Return a C array of doubles."""
    return (ct.c_double * len(numbers))(*numbers)


def bits(values: Sequence[float]) -> bytes:
    """Return the bits of a value; two outputs are the same if all bits are."""
    return struct.pack(f"<{len(values)}d", *values)


def not_finite(names: Sequence[str], values: Sequence[float]) -> list[str]:
    """Return the names, with values, of the outputs that are NaN or infinite."""
    return [f"{name} = {value:g}" for name, value in zip(names, values, strict=True) if not math.isfinite(value)]


@contextmanager
def _naming_what_is_missing() -> Iterator[None]:
    """A function that the library does not export is a `MissingError`."""
    try:
        yield
    except AttributeError as missing:
        raise MissingError(missing.name) from None


def _pointer(type_: str, value: float | str) -> Any:
    return ct.byref(ct.c_double(float(value)) if type_ == REAL else ct.c_int(int(value)))
