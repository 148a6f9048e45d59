"""An instance of an FMU, which gives typed calls before a run and addresses of functions for the compiled loops."""

import ctypes
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestration.errors import InitializationError, SystemDescriptionError, warn_caller
from orchestration.fmi.codes import (
    BOOLEAN,
    INTEGER,
    REAL,
    SAVES_STATE,
    SERIALIZES_STATE,
    STRING,
    Status,
    accepted,
    status_name,
)
from orchestration.fmi.deferred import raise_kept
from orchestration.fmi.description import Description
from orchestration.fmi.display import listed
from orchestration.fmi.experiment import UNKNOWN, Experiment
from orchestration.fmi.library import Library
from orchestration.fmi.loading import MOST_FUNCTIONS, loaded, told_of_tool
from orchestration.fmi.logging import Messages, callbacks, listen
from orchestration.fmi.signatures import CO_SIMULATION
from orchestration.fmi.units import Linear
from orchestration.sandbox.guard import ProcessChangedWarning

if TYPE_CHECKING:
    from orchestration.fmi.input_scaling import ScaledInputs
    from orchestration.sandbox.remote import RemoteProcess

C_TYPES = {REAL: ctypes.c_double, INTEGER: ctypes.c_int, BOOLEAN: ctypes.c_int, STRING: ctypes.c_char_p}


class Instance:
    """An instance of an FMU, created by fmi2Instantiate.

    Parameters
    ----------
    library
        A loaded library. `close` does not unload it; an instance from `open` unloads its own library.
    name
        Name of the instance, used in messages.
    identity
        GUID of the FMU, and URL of its resources.
    messages
        Receives the texts that the FMU logs.
    announce
        Receives the name of each function before the call, and an empty text after it.

    Attributes
    ----------
    worst
        Worst status that `status` returned.
    failed_in
        Function that failed within a call that stands for several functions; the next sentence names it.
    scaled
        Stand-in for the FMU if inputs are converted; see `orchestration.fmi.input_scaling`.

    Raises
    ------
    InitializationError
        If fmi2Instantiate returns no instance.
    """

    description: Description
    """Description of the FMU; None unless the instance comes from `open`."""

    def __init__(
        self,
        library: Library,
        name: str,
        identity: tuple[str, str],
        *,
        messages: Messages | None = None,
        announce: Callable[[str], None] | None = None,
    ) -> None:
        self.library, self.name = library, name
        self.messages = Messages() if messages is None else messages
        self.scaled: ScaledInputs | None = None
        self.worst = int(Status.OK)
        self.failed_in = ""
        self._announce, self._unloads, self._overwrites = announce, False, False
        self._identity = identity
        self._callbacks = callbacks(self.messages)
        self._handle = self._instantiated()

    @classmethod
    def open(
        cls,
        name: str,
        description: Description,
        folder: Path,
        *,
        messages: Messages | None = None,
        process: "RemoteProcess | None" = None,
    ) -> "Instance":
        """Load the library of an unpacked FMU and create an instance.

        The library is loaded in `process`, if there is one, which ends with the instance; see
        `orchestration.fmi.remote_library`.

        Raises
        ------
        ArchiveError
            If there is no library for this machine, or it does not load or lacks a function.
        InitializationError
            If fmi2Instantiate returns no instance.
        """
        with told_of_tool(description):
            library = loaded(name, description, folder.absolute(), process)
            resources = (folder.absolute() / "resources").as_uri()
            try:
                instance = cls(library, name, (description.guid, resources), messages=messages)
            except BaseException:
                library.close()
                raise
        instance.description, instance._unloads = description, True
        return instance

    @property
    def formalities(self) -> list[str]:
        """Sentences on rules of form that the library breaks, and that no step needs."""
        missing = self.library.lacks()
        return [f"Its library does not export {listed(missing, MOST_FUNCTIONS)}."] if missing else []

    @property
    def component(self) -> int:
        """Address of the instance, for functions that `address` gave."""
        return self.scaled.component if self.scaled else self._handle or 0

    @property
    def isolated(self) -> bool:
        """Whether the FMU lives in a process of its own."""
        return self.library.isolated

    @property
    def handle(self) -> int:
        """Address of the instance for the library's own functions, which convert no inputs."""
        return self._handle or 0

    @property
    def is_open(self) -> bool:
        """Whether the instance has not been freed yet."""
        return self._handle is not None

    def address(self, function: str) -> int:
        """Address of an FMI function, to be called with `component`."""
        return self.scaled.address(function) if self.scaled else self.library.address(function)

    def scale_inputs(self, scales: Mapping[int, Linear]) -> None:
        """Convert Real inputs, given by value reference, in all later calls by address."""
        from orchestration.fmi.input_scaling import ScaledInputs

        n_inputs = len(self.description.of_causality("input"))
        self.scaled = ScaledInputs(self._handle or 0, self.library.address, scales, n_inputs)

    def call(self, function: str, *arguments: Any) -> None:
        """Call an FMI function with the instance as first argument, before the first step.

        Raises
        ------
        InitializationError
            Unless the status is fmi2OK or fmi2Warning.
        """
        status = self.status(function, *arguments)
        if not accepted(status):
            raise InitializationError(self.failure(function, status))

    def status(self, function: str, *arguments: Any) -> int:
        """Call an FMI function with the instance as first argument; returns the fmi2Status."""
        listen()
        self.messages.begin_call()
        status = self._call(function, self._handle, *arguments)
        self.worst = max(self.worst, status)
        raise_kept()
        return status

    def ask(self, function: str, kind: int, answer: Any) -> int | None:
        """Ask for a status of a kind, an fmi2StatusKind; returns the fmi2Status, None if there is no such function."""
        if self.library.lacks([function]):
            return None
        status: int = self._call(function, self._handle, kind, answer)
        raise_kept()
        return status

    def failure(self, function: str, status: int, where: str = "") -> str:
        """Return a sentence that names a call, how it ended, and the messages of this call."""
        function, self.failed_in = self.failed_in or function, ""
        how = self.library.ending or f"returned {status_name(status)}"
        return f"{self.name}: {function} {how}{where}; {self.messages.last()}."

    def set(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> int:
        """Set variables of a type by value reference, texts as bytes; returns the fmi2Status.

        A `ProcessChangedWarning` tells of an FMU that writes into the values. In a run the values that it is given are
        those of other components.
        """
        array = (C_TYPES[kind] * len(values))(*values)
        before = bytes(array)
        status = self.status(f"fmi2Set{kind}", c_references(references), len(references), array)
        if bytes(array) != before and not self._overwrites:
            self._overwrites = True
            msg = (
                f"{self.name}: fmi2Set{kind} writes into the values that it is given to read. Without isolation these"
                " are the outputs of other components, so results of this run may be wrong; isolate the component."
            )
            warn_caller(msg, ProcessChangedWarning)
        return status

    def get(self, kind: str, references: Sequence[int]) -> tuple[int, list[Any]]:
        """Get variables of a type by value reference; returns the fmi2Status and the values."""
        array = (C_TYPES[kind] * len(references))()
        status = self.status(f"fmi2Get{kind}", c_references(references), len(references), array)
        return status, list(array)

    def set_up(self, start_time: float, experiment: Experiment = UNKNOWN) -> None:
        """Tell the FMU of an experiment from a start time, s: its stop time and its tolerance, if they are known.

        Raises
        ------
        InitializationError
        """
        tolerance, stop_time = experiment.told
        self.call("fmi2SetupExperiment", *tolerance, start_time, *stop_time)

    def save(self) -> Any:
        """Save the state: as bytes if the FMU serializes it, else as an fmi2FMUstate, which `free_state` frees.

        Raises
        ------
        SystemDescriptionError
            If the FMU does not save states.
        InitializationError
            If a call fails.
        """
        if not self.description.can(SAVES_STATE):
            msg = f"{self.name}: {self.description.path.name} does not declare {SAVES_STATE}; it cannot be saved."
            raise SystemDescriptionError(msg)
        state, size = ctypes.c_void_p(), ctypes.c_size_t()
        self.call("fmi2GetFMUstate", ctypes.byref(state))
        if not self.description.can(SERIALIZES_STATE):
            return state
        try:
            self.call("fmi2SerializedFMUstateSize", state, ctypes.byref(size))
            buffer = ctypes.create_string_buffer(size.value)
            self.call("fmi2SerializeFMUstate", state, buffer, size)
            return buffer.raw
        finally:
            self.call("fmi2FreeFMUstate", ctypes.byref(state))

    def restore(self, state: Any) -> None:
        """Restore a state that `save` returned.

        Raises
        ------
        InitializationError
            If a call fails, for example because the state is of another FMU.
        """
        if not isinstance(state, bytes):
            self.call("fmi2SetFMUstate", state)
            return
        fresh = ctypes.c_void_p()
        self.call("fmi2DeSerializeFMUstate", state, len(state), ctypes.byref(fresh))
        try:
            self.call("fmi2SetFMUstate", fresh)
        finally:
            self.call("fmi2FreeFMUstate", ctypes.byref(fresh))

    def free_state(self, state: Any) -> None:
        """Free a state that `save` returned, unless it is bytes or freed already."""
        if not isinstance(state, bytes) and state:
            self.status("fmi2FreeFMUstate", ctypes.byref(state))

    @property
    def is_lost(self) -> bool:
        """Whether the FMU must not be called any more: it returned fmi2Fatal, or its process has ended."""
        return self.worst == Status.FATAL or bool(self.library.ending)

    def reset(self) -> None:
        """Bring the FMU back to what it was when it was instantiated, by fmi2Reset, and forget its messages.

        Raises
        ------
        InitializationError
            If the call fails.
        """
        self.forget()
        self.call("fmi2Reset")

    def renew(self) -> None:
        """Free the instance and create another in its place; the library stays loaded, and inputs are not scaled.

        Raises
        ------
        InitializationError
            If fmi2Instantiate returns no instance.
        """
        handle, self._handle, self.scaled = self._handle, None, None
        if handle is not None:
            self._call("fmi2FreeInstance", handle)
            raise_kept()
        self.forget()
        self._handle = self._instantiated()

    def forget(self) -> None:
        """Forget what the FMU has logged and returned so far, since another run begins."""
        self.messages.forget()
        self.worst, self.failed_in = int(Status.OK), ""

    def close(self) -> None:
        """Free the instance, and unload the library if it is the instance's own; a second call does nothing.

        After fmi2Fatal the FMU is not called any more, as FMI demands.
        """
        handle, self._handle = self._handle, None
        try:
            if handle is not None and self.worst != Status.FATAL:
                self._call("fmi2FreeInstance", handle)
                raise_kept()
        finally:
            if self._unloads:
                self.library.close()

    def _instantiated(self) -> int:
        """Call fmi2Instantiate; an instance that nobody will get, because a callback was interrupted, is freed.

        Raises
        ------
        InitializationError
            If there is no instance.
        """
        guid, resources = (text.encode() for text in self._identity)
        pointer = ctypes.byref(self._callbacks)
        arguments = (self.name.encode(), CO_SIMULATION, guid, resources, pointer, 0, 1)  # invisible, with logging
        handle: int | None = self._call("fmi2Instantiate", *arguments)
        try:
            raise_kept()
        except BaseException:
            if handle:
                self._call("fmi2FreeInstance", handle)
            raise
        if not handle:
            msg = f"{self.name}: fmi2Instantiate {self.library.ending or 'failed'}; {self.messages.last()}."
            raise InitializationError(msg)
        return handle

    def _call(self, function: str, *arguments: Any) -> Any:
        c_function = self.library.function(function)
        if self._announce is None:
            return c_function(*arguments)
        self._announce(function)
        result = c_function(*arguments)
        self._announce("")
        return result


def c_references(numbers: Iterable[int]) -> Any:
    """C array of value references."""
    references = list(numbers)
    return (ctypes.c_uint * len(references))(*references)
