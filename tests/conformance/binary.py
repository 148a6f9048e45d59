"""Calls the C functions of an FMU's binary without a master; every call returns its status."""

import ctypes as ct
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import fmpy
import numpy as np
from fmpy.fmi2 import fmi2CallbackFunctions as Callbacks
from fmpy.fmi2 import fmi2CallbackLoggerTYPE as Logger
from lxml import etree

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
CO_SIMULATION = 1
PHASES = ("instantiated", "initialization mode", "step complete", "terminated", "error")

_component, _text, _flag, _size = ct.c_void_p, ct.c_char_p, ct.c_int, ct.c_size_t
_references, _reals, _integers = ct.POINTER(ct.c_uint), ct.POINTER(ct.c_double), ct.POINTER(ct.c_int)
_texts, _state = ct.POINTER(ct.c_char_p), ct.c_void_p
_states = ct.POINTER(ct.c_void_p)

# Arguments after the component, of all functions that take one and return a status.
ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "fmi2SetDebugLogging": (_flag, _size, _texts),
    "fmi2SetupExperiment": (_flag, ct.c_double, ct.c_double, _flag, ct.c_double),
    "fmi2EnterInitializationMode": (),
    "fmi2ExitInitializationMode": (),
    "fmi2Terminate": (),
    "fmi2Reset": (),
    "fmi2GetReal": (_references, _size, _reals),
    "fmi2GetInteger": (_references, _size, _integers),
    "fmi2GetBoolean": (_references, _size, _integers),
    "fmi2GetString": (_references, _size, _texts),
    "fmi2SetReal": (_references, _size, _reals),
    "fmi2SetInteger": (_references, _size, _integers),
    "fmi2SetBoolean": (_references, _size, _integers),
    "fmi2SetString": (_references, _size, _texts),
    "fmi2GetFMUstate": (_states,),
    "fmi2SetFMUstate": (_state,),
    "fmi2FreeFMUstate": (_states,),
    "fmi2SerializedFMUstateSize": (_state, ct.POINTER(_size)),
    "fmi2SerializeFMUstate": (_state, ct.c_char_p, _size),
    "fmi2DeSerializeFMUstate": (ct.c_char_p, _size, _states),
    "fmi2GetDirectionalDerivative": (_references, _size, _references, _size, _reals, _reals),
    "fmi2SetRealInputDerivatives": (_references, _size, _integers, _reals),
    "fmi2GetRealOutputDerivatives": (_references, _size, _integers, _reals),
    "fmi2DoStep": (ct.c_double, ct.c_double, _flag),
    "fmi2CancelStep": (),
    "fmi2GetStatus": (_flag, _integers),
    "fmi2GetRealStatus": (_flag, _reals),
    "fmi2GetIntegerStatus": (_flag, _integers),
    "fmi2GetBooleanStatus": (_flag, _integers),
    "fmi2GetStringStatus": (_flag, _texts),
}
# The other four of the 34 functions: result and arguments.
OTHERS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "fmi2GetTypesPlatform": (_text, ()),
    "fmi2GetVersion": (_text, ()),
    "fmi2Instantiate": (_component, (_text, _flag, _text, _text, ct.POINTER(Callbacks), _flag, _flag)),
    "fmi2FreeInstance": (None, (_component,)),
}
FUNCTIONS = (*OTHERS, *ARGUMENTS)


@dataclass(frozen=True)
class Message:
    """What a logger received; `raw` is the printf format, `text` what printf makes of it."""

    name: str
    status: int
    category: str
    raw: bytes

    @property
    def text(self) -> str:
        """The message as a reader sees it."""
        return self.raw.replace(b"%%", b"%").decode()

    @property
    def is_safe_format(self) -> bool:
        """Whether printf without arguments prints `text`: every percent sign is doubled."""
        return re.fullmatch(rb"(?:[^%]|%%)*", self.raw) is not None


class Log(list[Message]):
    """A list of messages and the C callback that fills it."""

    def __init__(self) -> None:
        super().__init__()
        self.callback = Logger(self._receive)

    def _receive(self, _environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.append(Message(name.decode(), status, category.decode(), message))


class Binary:
    """The shared library in an FMU.

    Attributes
    ----------
    variables
        fmpy's scalar variables by name, in the order of modelDescription.xml.
    log_categories
        Declared categories of messages.
    """

    def __init__(self, fmu: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(fmu))
        self.variables = {v.name: v for v in self.description.modelVariables}
        if self.description.guid is None or self.description.coSimulation is None:
            raise RuntimeError(f"{fmu.name} has no GUID or is not for co-simulation.")
        self.guid = self.description.guid.encode()
        self.name: str = str(self.description.coSimulation.modelIdentifier)
        self.interpolates = bool(self.description.coSimulation.canInterpolateInputs)
        fmpy.extract(str(fmu), unzipdir=str(folder))
        categories = etree.parse(folder / "modelDescription.xml").iterfind("LogCategories/Category")
        self.log_categories = {category.attrib["name"] for category in categories}
        self.path = folder / "binaries" / fmpy.platform / f"{self.name}{fmpy.sharedLibraryExtension}"
        self.library = ct.CDLL(str(self.path))
        for function, arguments in ARGUMENTS.items():
            self._declare(function, ct.c_int, (_component, *arguments))
        for function, (result, arguments) in OTHERS.items():
            self._declare(function, result, arguments)

    def __getitem__(self, function: str) -> Any:
        """The C function of that name."""
        return getattr(self.library, function)

    def create(self, log: Log | None = None, **options: Any) -> int | None:
        """Component of a new instance, or None; `options` replace arguments of fmi2Instantiate."""
        callbacks = Callbacks()
        if log is not None:
            callbacks.logger = log.callback
        arguments: dict[str, Any] = {
            "name": b"unit",
            "kind": CO_SIMULATION,
            "guid": self.guid,
            "location": b"file:///nowhere/resources",
            "callbacks": ct.byref(callbacks),
            "visible": 0,
            "logging": 1,
        }
        return self["fmi2Instantiate"](*(arguments | options).values())

    def names(self, *causalities: str, type: str | None = None, variability: str | None = None) -> list[str]:
        """Names of the variables of these causalities, and of that type and variability.

        Reals that stand for Booleans or Integers are of no type.
        """
        return [
            v.name
            for v in self.variables.values()
            if v.causality in causalities
            and (type is None or v.type == type == kind(v))
            and (variability is None or v.variability == variability)
        ]

    def starts(self, *causalities: str) -> dict[str, float]:
        """Start values as numbers, by name."""
        return {name: start_value(self.variables[name]) for name in self.names(*causalities)}

    def _declare(self, function: str, result: Any, arguments: Sequence[Any]) -> None:
        pointer = getattr(self.library, function)
        pointer.restype, pointer.argtypes = result, arguments


class Instance:
    """One instance; a context manager that frees it."""

    def __init__(self, binary: Binary, *, start: Mapping[str, float] | None = None, **options: Any) -> None:
        self.binary = binary
        self.log = Log()
        self.component = binary.create(self.log, **options)
        if self.component is None:
            raise RuntimeError(f"{binary.name} was not instantiated: {self.log}")
        self.time = 0.0
        require_ok(self.set(start or {}), self)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.free()

    def free(self) -> None:
        """Free the instance; also twice."""
        if self.component is not None:
            self.binary["fmi2FreeInstance"](self.component)
            self.component = None

    def call(self, function: str, *arguments: Any) -> int:
        """Status of a function."""
        return self.binary[function](self.component, *arguments)

    @property
    def last(self) -> str:
        """Text of the last message, empty if there is none."""
        return self.log[-1].text if self.log else ""

    def set(self, values: Mapping[str, float]) -> int:
        """Set variables by name, one call per type; the first status that is not OK."""
        for type, c_type in (("Real", ct.c_double), ("Integer", ct.c_int), ("Boolean", ct.c_int)):
            names = [name for name in values if self.binary.variables[name].type == type]
            if not names:
                continue
            numbers = array(c_type, (values[n] if type == "Real" else int(values[n]) for n in names))
            status = self.call(f"fmi2Set{type}", self.references(*names), len(names), numbers)
            if status != OK:
                return status
        return OK

    def get(self, *names: str) -> np.ndarray:
        """Values by name, float64, shape (len(names),)."""
        return np.array([self._get(self.binary.variables[name]) for name in names])

    def outputs(self) -> np.ndarray:
        """All outputs in their order, float64."""
        return self.get(*self.binary.names("output"))

    def references(self, *names: str) -> Any:
        """C array of value references."""
        return array(ct.c_uint, (self.binary.variables[name].valueReference for name in names))

    def setup(self, t0: float = 0.0, stop: float | None = None) -> int:
        """fmi2SetupExperiment, without tolerance."""
        self.time = t0
        return self.call("fmi2SetupExperiment", 0, 0.0, t0, int(stop is not None), stop or 0.0)

    def enter(self, t0: float = 0.0, stop: float | None = None) -> Self:
        """Up to initialization mode."""
        require_ok(self.setup(t0, stop), self)
        require_ok(self.call("fmi2EnterInitializationMode"), self)
        return self

    def initialize(self, t0: float = 0.0, stop: float | None = None) -> Self:
        """Up to step complete."""
        self.enter(t0, stop)
        require_ok(self.call("fmi2ExitInitializationMode"), self)
        return self

    def step(self, h: float, t: float | None = None) -> int:
        """fmi2DoStep from `t`, by default from the end of the previous step."""
        start = self.time if t is None else t
        status = self.call("fmi2DoStep", start, h, 1)
        if status == OK:
            self.time = start + h
        return status

    def to(self, phase: str) -> Self:
        """Go from instantiated to one of `PHASES`."""
        if phase == "instantiated":
            return self
        self.enter()
        if phase == "initialization mode":
            return self
        require_ok(self.call("fmi2ExitInitializationMode"), self)
        if phase == "step complete":
            return self
        if phase == "terminated":
            require_ok(self.call("fmi2Terminate"), self)
            return self
        assert phase == "error"
        assert self.step(1e9) == ERROR, "1e13 ticks or sub-steps must be too many"
        return self

    def blob(self) -> bytes:
        """The serialized state."""
        state, size = ct.c_void_p(), ct.c_size_t()
        require_ok(self.call("fmi2GetFMUstate", ct.byref(state)), self)
        require_ok(self.call("fmi2SerializedFMUstateSize", state, ct.byref(size)), self)
        buffer = ct.create_string_buffer(size.value)
        require_ok(self.call("fmi2SerializeFMUstate", state, buffer, size.value), self)
        require_ok(self.call("fmi2FreeFMUstate", ct.byref(state)), self)
        return buffer.raw

    def restore(self, blob: bytes) -> int:
        """Deserialize and set a state; the status of the former, the latter must succeed."""
        state = ct.c_void_p()
        status = self.call("fmi2DeSerializeFMUstate", blob, len(blob), ct.byref(state))
        if status == OK:
            require_ok(self.call("fmi2SetFMUstate", state), self)
            require_ok(self.call("fmi2FreeFMUstate", ct.byref(state)), self)
            time = ct.c_double()
            if self.call("fmi2GetRealStatus", 2, ct.byref(time)) == OK:
                self.time = time.value
        return status

    def _get(self, variable: Any) -> float:
        number = ct.c_double() if variable.type == "Real" else ct.c_int()
        reference = array(ct.c_uint, [variable.valueReference])
        require_ok(self.call(f"fmi2Get{variable.type}", reference, 1, ct.byref(number)), self)
        return float(number.value)


def kind(variable: Any) -> str:
    """Type of a variable, or the type that a Real stands for."""
    declared = str(variable.declaredType.name) if variable.declaredType is not None else ""
    return {"BooleanAsReal": "Boolean", "IntegerAsReal": "Integer"}.get(declared, str(variable.type))


def array(c_type: Any, values: Iterable[Any]) -> Any:
    """C array of the values."""
    numbers = list(values)
    return (c_type * len(numbers))(*numbers)


def start_value(variable: Any) -> float:
    """Start of an input or parameter as a number."""
    if variable.type == "Boolean":
        return float(variable.start == "true")
    return float(variable.start)


def require_ok(status: int, instance: Instance) -> None:
    """Raise unless a call that prepares a test succeeded."""
    if status != OK:
        raise RuntimeError(f"{instance.binary.name}: status {status}: {instance.last}")
