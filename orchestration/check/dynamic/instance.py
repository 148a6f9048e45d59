"""A stranger's binary and its instances, called through ctypes; every call is announced before it is made.

Runs in the worker's process only: a call may crash, hang or print.
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

from orchestration.check.findings import shown
from orchestration.errors import InitializationError
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, accepted, status_name
from orchestration.fmi.instance import C_TYPES, c_references
from orchestration.fmi.instance import Instance as Component
from orchestration.fmi.library import Library
from orchestration.fmi.logging import Messages

LONGEST_MESSAGE = 300
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
        self._library = Library(Path(plan["library"]))
        self.variables = {row["name"]: row for row in plan["variables"]}

    def lacks(self) -> Sequence[str]:
        """Functions that are not exported."""
        return self._library.lacks()

    def ask(self, function: str) -> Any:
        """The answer of a function without arguments.

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
        """A new component.

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
        """Variables of a causality and of types, of any but String if there are none."""
        rows = self.variables.values()
        chosen = types or (REAL, INTEGER, BOOLEAN)
        return [row["name"] for row in rows if row["causality"] == causality and row["type"] in chosen]

    def starts(self) -> dict[str, float]:
        """Start values of inputs."""
        return {name: self.variables[name]["start"] or 0.0 for name in self.names("input")}


class Instance:
    """A component that keeps its time; a context manager that frees it."""

    _numbers = itertools.count(1)

    def __init__(self, binary: Binary) -> None:
        self.binary, self.time, self.messages = binary, 0.0, Messages()
        try:
            self.component = binary.create(self.messages, name=f"checked{next(self._numbers)}")
        except InitializationError as refused:
            msg = f"fmi2Instantiate refuses the GUID of the description{self._said()}."
            raise RefusedError(msg) from refused

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
        with _naming_what_is_missing():
            self.component.close()

    def status(self, function: str, *arguments: Any) -> int:
        """Status that a function returns."""
        with _naming_what_is_missing():
            return self.component.status(function, *arguments)

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function that ought to work.

        Raises
        ------
        RefusedError
        """
        status = self.status(function, *arguments)
        if not accepted(status):
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
            self.call(f"fmi2Set{row['type']}", c_references([row["reference"]]), 1, _pointer(row["type"], value))

    def get(self, names: Iterable[str]) -> tuple[float, ...]:
        """Values by name."""
        found = []
        for name in names:
            row = self.binary.variables[name]
            number = C_TYPES[row["type"]]()
            self.call(f"fmi2Get{row['type']}", c_references([row["reference"]]), 1, ct.byref(number))
            found.append(float(number.value))
        return tuple(found)

    def outputs(self) -> tuple[float, ...]:
        """All outputs but strings."""
        return self.get(self.binary.names("output"))

    def _said(self) -> str:
        return f' ("{shown(self.messages[-1], LONGEST_MESSAGE)}")' if self.messages else ""


def reals(numbers: Sequence[float]) -> Any:
    """C array of doubles."""
    return (ct.c_double * len(numbers))(*numbers)


def bits(values: Sequence[float]) -> bytes:
    """What makes two outputs the same: every bit."""
    return struct.pack(f"<{len(values)}d", *values)


def not_finite(names: Sequence[str], values: Sequence[float]) -> list[str]:
    """Names with their values that are NaN or infinite."""
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
