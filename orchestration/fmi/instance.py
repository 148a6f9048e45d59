"""An FMU as the master sees it: its description, and instances with addresses of its functions."""

import ctypes
import itertools
import platform
import re
import sys
import threading
from collections.abc import Collection, Mapping
from contextlib import chdir
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from orchestration.errors import ArchiveError, InitializationError, SystemDescriptionError
from orchestration.fmi.codes import BOOLEAN, CAPABILITIES, INTEGER, STRING, WORST_ACCEPTED, status_name
from orchestration.fmi.units import BASE_UNITS, Linear, UnitDefinition, defined
from orchestration.sandbox.archive import screen

if TYPE_CHECKING:
    from orchestration.fmi.input_scaling import ScaledInputs

SAMPLE_TIME = "sample_time"
KEPT_MESSAGES = 5
_LOADING = threading.Lock()  # fmpy changes the working directory while it loads a library
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)


@dataclass(frozen=True)
class Variable:
    """A scalar variable of an FMU; `unit` is empty where none is declared.

    Attributes
    ----------
    direct
        Whether an output declares that it depends on an input at the same instant.
    relative
        Whether it is a difference, to which the offset of its unit does not apply.
    declared
        Its name in the FMU, if the component goes by another one; see `Description.renamed`.
    """

    name: str
    reference: int
    type: str
    causality: str
    variability: str
    unit: str
    start: float | None
    description: str = ""
    direct: bool = False
    relative: bool = False
    declared: str = ""

    @property
    def fmu_name(self) -> str:
        """Its name in the FMU."""
        return self.declared or self.name


@dataclass(frozen=True)
class Description:
    """What modelDescription.xml says, as far as a co-simulation needs it.

    Attributes
    ----------
    capabilities
        Names of the flags of the co-simulation element that are true.
    """

    path: Path
    model_name: str
    identifier: str
    guid: str
    variables: Mapping[str, Variable]
    units: Mapping[str, UnitDefinition]
    capabilities: frozenset[str] = frozenset()

    def can(self, capability: str) -> bool:
        """Whether a capability flag of the co-simulation element, such as `SAVES_STATE`, is true."""
        return capability in self.capabilities

    def of_causality(self, causality: str) -> list[Variable]:
        """Variables of a causality, in their order, without strings."""
        return [v for v in self.variables.values() if v.causality == causality and v.type != STRING]

    def unit(self, variable: Variable) -> UnitDefinition | None:
        """The unit of a variable; None if it declares none."""
        return defined(variable.unit, self.units)

    def renamed(self, names: Mapping[str, str]) -> "Description":
        """The same FMU with other names for its variables, by the names in the FMU.

        Raises
        ------
        SystemDescriptionError
            If two variables get one name.
        """
        if not names:
            return self
        variables: dict[str, Variable] = {}
        for variable in self.variables.values():
            name = names.get(variable.fmu_name, variable.fmu_name)
            if name in variables:
                both = f"{variables[name].fmu_name} and {variable.fmu_name}"
                msg = f"{self.model_name}: {both} would both be called {name}; map the other one too."
                raise SystemDescriptionError(msg)
            declared = "" if name == variable.fmu_name else variable.fmu_name
            variables[name] = replace(variable, name=name, declared=declared)
        return replace(self, variables=variables)


def read_description(path: Path) -> Description:
    """Screen an FMU and read its description; read again only when the file has changed.

    Raises
    ------
    ArchiveError
        If the archive is unsafe, or no FMI 2.0 co-simulation FMU.
    """
    path = path.resolve()
    if not path.is_file():
        msg = f"{path}: there is no such FMU."
        raise ArchiveError(msg)
    status = path.stat()
    return _read_description(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=256)
def _read_description(path: Path, modified: int, size: int) -> Description:  # noqa: ARG001 - the cache's key
    import fmpy

    screen(path)
    try:
        raw = fmpy.read_model_description(str(path))
    except Exception as error:  # fmpy raises bare Exception
        msg = f"{path} is no valid FMU: {error}"
        raise ArchiveError(msg) from error
    if raw.fmiVersion != "2.0" or raw.coSimulation is None:
        kind = "model exchange" if raw.coSimulation is None else "co-simulation"
        msg = f"{path} is an FMI {raw.fmiVersion} FMU for {kind}; one of FMI 2.0 for co-simulation is needed."
        raise ArchiveError(msg)
    identifier = raw.coSimulation.modelIdentifier
    if not _IDENTIFIER.fullmatch(identifier):
        msg = f"{path}: the model identifier {identifier!r} is no C identifier."
        raise ArchiveError(msg)
    direct = {x.variable.name for x in raw.outputs if _depends_on_input(x)}
    variables = {v.name: _variable(v, direct) for v in raw.modelVariables}
    units = {u.name: _unit(u) for u in raw.unitDefinitions}
    capabilities = frozenset(name for name in CAPABILITIES if getattr(raw.coSimulation, name, False))
    return Description(path, raw.modelName, identifier, raw.guid, variables, units, capabilities)


def _depends_on_input(unknown: Any) -> bool:
    return any(variable.causality == "input" for variable in unknown.dependencies or ())


def _variable(raw: Any, direct: Collection[str]) -> Variable:
    unit = raw.unit or (raw.declaredType.unit if raw.declaredType is not None else None) or ""
    kind = INTEGER if raw.type == "Enumeration" else raw.type
    start = None if raw.start is None or kind == STRING else parse_value(raw.start, kind)
    causality = raw.causality or "local"
    variability = raw.variability or "continuous"
    return Variable(
        name=raw.name,
        reference=raw.valueReference,
        type=kind,
        causality=causality,
        variability=variability,
        unit=unit,
        start=start,
        description=raw.description or "",
        direct=raw.name in direct,
        relative=bool(raw.relativeQuantity or getattr(raw.declaredType, "relativeQuantity", False)),
    )


def _unit(raw: Any) -> UnitDefinition:
    base = raw.baseUnit
    if base is None:
        return UnitDefinition(raw.name, None)
    exponents = tuple((n, int(getattr(base, n))) for n in BASE_UNITS if int(getattr(base, n) or 0))
    return UnitDefinition(raw.name, exponents, float(base.factor or 1), float(base.offset or 0))


def parse_value(text: Any, kind: str) -> float:
    """A start value as a number; Booleans are 0 or 1.

    Raises
    ------
    ValueError
        If the text is no value of that type.
    """
    if kind == BOOLEAN:
        values = {"true": 1.0, "1": 1.0, "1.0": 1.0, "false": 0.0, "0": 0.0, "0.0": 0.0}
        return values[str(text).strip().lower()]
    number = float(text)
    if kind == INTEGER and not (number.is_integer() and -(2**31) <= number < 2**31):
        msg = f"{text!r} is no integer of 32 bits"  # ctypes would wrap a longer one
        raise ValueError(msg)
    return number


def needed_to_run(entry: str) -> bool:
    """Whether an archive's entry is used when the FMU runs; sources and documentation are not."""
    return not entry.startswith(("sources/", "documentation/"))


def library_path(folder: Path, description: Description) -> Path:
    """The shared library for this machine in an unpacked FMU.

    Raises
    ------
    ArchiveError
        Naming the platforms that the FMU has.
    """
    arm = platform.machine().lower() in ("arm64", "aarch64")
    names, extension = {
        "linux": (("aarch64-linux",) if arm else ("linux64", "x86_64-linux"), ".so"),
        "darwin": (("aarch64-darwin", "darwin64") if arm else ("darwin64", "x86_64-darwin"), ".dylib"),
        "win32": (("win64", "x86_64-windows"), ".dll"),
    }[sys.platform]
    for name in names:
        path = folder / "binaries" / name / f"{description.identifier}{extension}"
        if path.is_file():
            return path
    binaries = folder / "binaries"
    present = sorted(p.name for p in binaries.iterdir()) if binaries.is_dir() else []
    has = ", ".join(present) or "none"
    msg = f"{description.path} has no binary for {names[0]}, this machine; it has {has}."
    raise ArchiveError(msg)


_loggers: "WeakValueDictionary[int, Instance]" = WeakValueDictionary()
_environments = itertools.count(1)


@dataclass(eq=False)
class Instance:
    """An instance of an FMU in an unpacked folder.

    Attributes
    ----------
    name
        Of the component, used in messages.
    messages
        The last texts that the FMU logged.
    scaled
        Stands before the FMU if inputs are converted on the way in; see `orchestration.fmi.input_scaling`.
    """

    name: str
    description: Description
    slave: Any = None
    messages: list[str] = field(default_factory=list)
    scaled: "ScaledInputs | None" = None
    _callbacks: Any = None

    @classmethod
    def open(cls, name: str, description: Description, folder: Path) -> "Instance":
        """Load the library and instantiate.

        Raises
        ------
        ArchiveError, InitializationError
        """
        from fmpy.fmi2 import FMU2Slave

        instance = cls(name, description)
        library = library_path(folder, description)
        try:
            with _LOADING, chdir(Path.cwd()):  # fmpy does not change back when it fails
                instance.slave = FMU2Slave(
                    guid=description.guid,
                    modelIdentifier=description.identifier,
                    unzipDirectory=str(folder),
                    libraryPath=str(library),
                    instanceName=name,
                )
        except Exception as error:  # fmpy raises bare Exception
            msg = f"{name}: {description.path.name} cannot be loaded: {error}"
            raise ArchiveError(msg) from error
        instance._instantiate()
        return instance

    @property
    def component(self) -> int:
        """Address of the instance, for functions that `address` gave."""
        return self.scaled.component if self.scaled else self._handle

    def address(self, function: str) -> int:
        """Address of an FMI function, to be called with `component`."""
        return self.scaled.address(function) if self.scaled else self._address(function)

    def scale_inputs(self, scales: Mapping[int, Linear]) -> None:
        """From now on convert Real inputs, by value reference, in what is called by address."""
        from orchestration.fmi.input_scaling import ScaledInputs

        n_inputs = len(self.description.of_causality("input"))
        self.scaled = ScaledInputs(self._handle, self._address, scales, n_inputs)

    def call(self, function: str, *arguments: Any) -> None:
        """Call an FMI function with the component as first argument, before the first step.

        Raises
        ------
        InitializationError
            Unless the status is fmi2OK or fmi2Warning.
        """
        status = self.status(function, *arguments)
        if status > WORST_ACCEPTED:
            raise InitializationError(self.failure(function, status))

    def status(self, function: str, *arguments: Any) -> int:
        """Call an FMI function with the component as first argument; returns the fmi2Status."""
        c_function = getattr(self.slave.dll, function)
        c_function.restype = ctypes.c_int
        return c_function(ctypes.c_void_p(self._handle), *arguments)

    def failure(self, function: str, status: int, where: str = "") -> str:
        """The sentence that says which call returned what, and the instance's last message."""
        last = f'its last message: "{self.messages[-1]}"' if self.messages else "it logged nothing"
        return f"{self.name}: {function} returned {status_name(status)}{where}; {last}."

    def close(self) -> None:
        """Free the instance and the library."""
        if self.slave is not None and self.slave.component:
            self.slave.freeInstance()
            self.slave.component = None

    @property
    def _handle(self) -> int:
        component = self.slave.component
        return int(getattr(component, "value", component))

    def _address(self, function: str) -> int:
        return int(ctypes.cast(getattr(self.slave.dll, function), ctypes.c_void_p).value or 0)

    def _instantiate(self) -> None:
        from fmpy.fmi2 import (
            calloc,
            fmi2CallbackAllocateMemoryTYPE,
            fmi2CallbackFreeMemoryTYPE,
            fmi2CallbackFunctions,
            free,
        )
        from fmpy.logging import addLoggerProxy

        environment = next(_environments)
        _loggers[environment] = self
        callbacks = fmi2CallbackFunctions()
        with _LOADING:  # one logger for the whole process, or the proxy would call one that is gone
            callbacks.logger = _c_logger()
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        callbacks.componentEnvironment = environment
        addLoggerProxy(ctypes.byref(callbacks))  # formats printf arguments before calling ours
        self._callbacks = callbacks
        try:
            self.slave.instantiate(callbacks=callbacks, loggingOn=True)
        except Exception as error:  # fmpy raises bare Exception
            self.slave.component = None
            last = f'its last message: "{self.messages[-1]}"' if self.messages else "it logged nothing"
            msg = f"{self.name}: fmi2Instantiate failed; {last}."
            raise InitializationError(msg) from error


@cache
def _c_logger() -> Any:
    """The logger of all instances; fmpy's proxy knows one at a time, so the environment tells them apart."""
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE

    def log(environment: Any, name: Any, status: int, category: Any, message: Any) -> None:  # noqa: ARG001
        instance = _loggers.get(environment or 0)
        if instance is not None:
            text = (message or b"").decode(errors="replace").strip()
            instance.messages[:] = [*instance.messages, text][-KEPT_MESSAGES:]

    return fmi2CallbackLoggerTYPE(log)
