"""Drives one FMU through fmpy, by variable names; for tests."""

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2OK,
)

Value = float | int | bool


class Driver:
    """An instance of an FMU.

    Attributes
    ----------
    slave
        fmpy's object; its attributes named after FMI functions are the raw C functions.
    messages
        What the instance logged, as (status, category, text).
    """

    def __init__(self, path: Path, *, instance_name: str = "unit", logging: bool = True) -> None:
        self.description = fmpy.read_model_description(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self._folder = fmpy.extract(str(path))
        self.messages: list[tuple[int, str, str]] = []
        self.slave: Any = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=instance_name,
        )
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.slave.instantiate(callbacks=self._callbacks, loggingOn=logging)

    def initialize(
        self, start: Mapping[str, Value] | None = None, *, t0: float = 0.0, stop: float | None = None
    ) -> None:
        """Set start values and go through initialization mode."""
        self.set(start or {})
        self.slave.setupExperiment(startTime=t0, stopTime=stop)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, values: Mapping[str, Value]) -> None:
        """Set variables by name."""
        for name, value in values.items():
            variable = self.variables[name]
            setter = getattr(self.slave, f"set{variable.type}")
            setter([variable.valueReference], [value])

    def get(self, *names: str) -> np.ndarray:
        """Values by name, as float64."""
        return np.array([self._get(self.variables[name]) for name in names], dtype=float)

    def outputs(self) -> dict[str, float]:
        """All outputs by name."""
        names = [v.name for v in self.variables.values() if v.causality == "output"]
        return dict(zip(names, (float(v) for v in self.get(*names)), strict=True))

    def step(self, t: float, h: float) -> None:
        """One fmi2DoStep; raises fmpy's FMICallException unless the status is fmi2OK."""
        self.slave.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def status(self, function: str, *arguments: Any) -> int:
        """Status of a raw FMI function, called with the component as first argument."""
        return int(self.raw(function)(self.slave.component, *arguments))

    def raw(self, function: str) -> Any:
        """The C function without fmpy's checks: takes and returns plain ctypes values."""
        return getattr(self.slave.dll, function)  # fmpy has declared its types

    def references(self, *names: str) -> Sequence[int]:
        """Value references by name."""
        return [self.variables[name].valueReference for name in names]

    def close(self) -> None:
        """Free the instance and the unpacked archive."""
        if self.slave.component:
            self.slave.freeInstance()
            self.slave.component = None
        shutil.rmtree(self._folder, ignore_errors=True)

    def _get(self, variable: Any) -> Value:
        getter = getattr(self.slave, f"get{variable.type}")
        return getter([variable.valueReference])[0]

    def _log(self, _environment: Any, _name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append((status, category.decode(), message.decode().replace("%%", "%")))


OK = fmi2OK
