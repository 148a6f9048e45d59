"""Drives one FMU call by call, by variable names and times of the test's choice; for tests."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, Status
from orchestration.fmi.description import read_description
from orchestration.fmi.instance import Instance
from orchestration.fmi.library import needed_to_run
from orchestration.fmi.logging import Messages
from orchestration.sandbox.archive import unpacked

Value = float | int | bool
OK = Status.OK


class RefusedError(Exception):
    """A call's status is not fmi2OK."""


class Driver:
    """An instance of an FMU, not initialized yet.

    Attributes
    ----------
    instance
        The instance, for calls that may fail: its `status` raises nothing.
    messages
        What the instance logged.
    """

    def __init__(self, path: Path) -> None:
        self.description = read_description(path)
        self.variables = self.description.variables
        self.messages = Messages(None)
        with ExitStack() as opened:
            folder = opened.enter_context(unpacked(path, needed_to_run))
            self.instance = Instance.open("unit", self.description, folder, messages=self.messages)
            opened.callback(self.instance.close)
            self._opened = opened.pop_all()

    def initialize(
        self, start: Mapping[str, Value] | None = None, *, t0: float = 0.0, stop: float | None = None
    ) -> None:
        """Set start values and go through initialization mode."""
        self.set(start or {})
        self.enter(t0, stop)
        self.call("fmi2ExitInitializationMode")

    def enter(self, t0: float = 0.0, stop: float | None = None) -> None:
        """Go to initialization mode."""
        self.call("fmi2SetupExperiment", 0, 0.0, t0, int(stop is not None), stop or 0.0)
        self.call("fmi2EnterInitializationMode")

    def set(self, values: Mapping[str, Value]) -> None:
        """Set variables by name, one call each."""
        for name, value in values.items():
            variable = self.variables[name]
            number = value if variable.type == REAL else int(value)
            self._require_ok(
                f"fmi2Set{variable.type}", self.instance.set(variable.type, [variable.reference], [number])
            )

    def get(self, *names: str) -> np.ndarray:
        """Values by name, as float64; those of a type with one call."""
        values = np.empty(len(names))
        for kind in (REAL, INTEGER, BOOLEAN):
            places = [i for i, name in enumerate(names) if self.variables[name].type == kind]
            if places:
                status, found = self.instance.get(kind, [self.variables[names[i]].reference for i in places])
                self._require_ok(f"fmi2Get{kind}", status)
                values[places] = found
        return values

    def outputs(self) -> dict[str, float]:
        """All outputs by name."""
        names = [v.name for v in self.description.of_causality("output")]
        return dict(zip(names, map(float, self.get(*names)), strict=True))

    def step(self, t: float, h: float) -> None:
        """One fmi2DoStep."""
        self.call("fmi2DoStep", t, h, 1)

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function that must return fmi2OK.

        Raises
        ------
        RefusedError
        """
        self._require_ok(function, self.instance.status(function, *arguments))

    def close(self) -> None:
        """Free the instance and remove the unpacked archive; again does nothing."""
        self._opened.close()

    def _require_ok(self, function: str, status: int) -> None:
        if status != OK:
            raise RefusedError(self.instance.failure(function, status))
