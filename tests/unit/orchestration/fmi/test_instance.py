"""Tests of exceptions that a callback keeps: an instance raises each one after the call that it belongs to."""

from collections.abc import Callable
from typing import Any, cast

import pytest

from orchestration.fmi.codes import Status
from orchestration.fmi.deferred import keep, raise_kept
from orchestration.fmi.instance import Instance
from orchestration.fmi.library import Library

HANDLE = 16


class Interrupting:
    """Stands for a library, in which Ctrl-C reaches a callback during one function."""

    isolated, ending = False, ""

    def __init__(self, function: str) -> None:
        self.called: list[str] = []
        self._function = function

    def lacks(self, functions: Any) -> list[str]:  # noqa: ARG002 - it has all
        """Functions that are not exported."""
        return []

    def function(self, name: str) -> Callable[..., int]:
        """A function that notes its call."""

        def call(*_: Any) -> int:
            self.called.append(name)
            if name == self._function:
                keep(KeyboardInterrupt(name))
            return HANDLE if name == "fmi2Instantiate" else int(Status.OK)

        return call


def used(library: Interrupting) -> None:
    """Make an instance, ask it, and free it."""
    instance = Instance(cast("Library", library), "m", ("guid", "resources"))
    try:
        instance.ask("fmi2GetRealStatus", 2, None)
    finally:
        instance.close()


@pytest.mark.parametrize(
    ("function", "called"),
    [
        ("fmi2Instantiate", ["fmi2Instantiate", "fmi2FreeInstance"]),
        ("fmi2GetRealStatus", ["fmi2Instantiate", "fmi2GetRealStatus", "fmi2FreeInstance"]),
        ("fmi2FreeInstance", ["fmi2Instantiate", "fmi2GetRealStatus", "fmi2FreeInstance"]),
    ],
)
def test_an_interrupt_comes_out_of_its_own_call(function: str, called: list[str]) -> None:
    library = Interrupting(function)
    with pytest.raises(KeyboardInterrupt, match=function):
        used(library)
    assert library.called == called
    raise_kept()  # nothing is left for the next call
