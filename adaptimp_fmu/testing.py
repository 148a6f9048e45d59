"""Helpers for people who test a component of their own; needs pytest.

    pytest_plugins = ["adaptimp_fmu.testing"]  # or: from adaptimp_fmu.testing import fmu

    def test_the_arm_stays_where_it_is(fmu):
        plant = fmu("Plant.fmu", q_start=[0.3, 1.0], dq_start=[0.0, 0.0])
        outputs = plant.drive(1e-3, {"tau": np.zeros((100, 2))})
        np.testing.assert_allclose(outputs["q"], np.tile([0.3, 1.0], (100, 1)))

`open_fmu` loads any FMI 2.0 co-simulation FMU for this machine, whatever tool wrote it. A name is
that of a variable, ``tau[1]``, or of an array, ``tau``: all variables ``tau[i]`` in the order of i,
which counts from 1, or from 0, without a hole.

Over step k, from t_k to t_k + h, the inputs are those of row k, set at t_k; row k of the outputs is
what the unit shows at the end of the step.
"""

import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy import fmi2
from fmpy.fmi1 import FMICallException

from adaptimp_fmu.errors import FmuError, SignalError
from adaptimp_fmu.listening import failure, last_message, listen, register
from adaptimp_fmu.signals import arrays, listed, typed

try:
    import pytest
except ModuleNotFoundError as error:
    _msg = "adaptimp_fmu.testing needs pytest, which is not installed; install it: pip install pytest."
    raise ModuleNotFoundError(_msg, name="pytest") from error

FATAL = 4
GRID_TOLERANCE = 1e-9  # by which, in steps, a first time may miss the unit's; that of the units' own ticks
_SETTERS = {"Real": "setReal", "Integer": "setInteger", "Enumeration": "setInteger", "Boolean": "setBoolean"}

Value = float | str | Sequence[float] | np.ndarray
Calls = list[tuple[str, list[int], list[list[Any]]]]  # FMI function, value references, values by row


def open_fmu(path: str | PathLike[str], /, **start: Value) -> "OpenedFmu":
    """Load an FMU and initialize it at t = 0, for use in a ``with`` statement.

    Parameters
    ----------
    path
        The .fmu file.
    **start
        Start values by name: a number, a text, or an array (k,) for an array of k variables. One
        element goes as ``**{"p_start[2]": 2.5}``.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    FmuError
        If it is no FMU for co-simulation with FMI 2.0 on this machine, or refuses its start values.
    SignalError
        If a start value has a wrong name, shape or type.
    """
    return OpenedFmu(path, start)


class OpenedFmu:
    """An instance of an FMU, initialized and ready to step; see `open_fmu`.

    Parameters
    ----------
    path
        The .fmu file.
    start
        Start values by name.
    start_time
        Time of the initialization, s.

    Attributes
    ----------
    name
        Model name, which begins the messages of errors.
    messages
        What the unit logged, oldest first.
    steps
        Number of steps done.
    """

    def __init__(
        self, path: str | PathLike[str], start: Mapping[str, Value] | None = None, *, start_time: float = 0.0
    ) -> None:
        self.path = Path(path)
        self.name = self.path.stem
        self.messages: list[str] = []
        self.steps = 0
        self._origin, self._h, self._k = float(start_time), 0.0, 0
        self._worst = 0
        self._initialized = False
        self._opened = ExitStack()
        try:
            self._load()
            self.set(**(start or {}))
            self._call("setupExperiment", startTime=self.time)
            self._call("enterInitializationMode")
            self._call("exitInitializationMode")
        except BaseException:
            self._opened.close()
            raise
        self._initialized = True

    @property
    def time(self) -> float:
        """Time of the unit, s: t0 + k h for k equal steps, not a sum."""
        return self._origin + self._k * self._h

    def outputs(self) -> dict[str, np.ndarray]:
        """Outputs as they are now, by name, float64: of shape (), arrays of shape (k,)."""
        return {name: values[0] for name, values in self._grouped(self._row()[None, :]).items()}

    def set(self, /, **values: Value) -> None:
        """Set inputs, or tunable parameters: a number, or an array (k,) for an array of k variables.

        Raises
        ------
        FmuError
            If the unit refuses.
        SignalError
            If a name, a shape or a type is wrong; then nothing is set.
        """
        rows = {name: self._rows(name, [value]) for name, value in values.items()}
        for setter, references, (row,) in self._setters(rows):
            self._call(setter, references, row)

    def step(self, h: float) -> None:
        """Advance by one step of h seconds.

        Raises
        ------
        FmuError
            If the unit does not accept the step.
        SignalError
            If h is not positive.
        """
        self._require_step(h)
        self._do_step(float(h))
        if h != self._h:
            self._origin, self._h, self._k = self.time, float(h), 0
        self._k += 1

    def drive(
        self, times: float | Sequence[float] | np.ndarray, inputs: Mapping[str, np.ndarray] | None = None
    ) -> dict[str, np.ndarray]:
        """Step through arrays of inputs.

        Parameters
        ----------
        times
            Length of the n steps, s; or all n + 1 communication points, s, the first of them the
            unit's time.
        inputs
            Inputs, or tunable parameters, by name: row k is set before step k; shape (n,), arrays of
            k variables (n, k). What is not among them keeps its value.

        Returns
        -------
        dict
            Outputs after each step by name, float64, shape (n,); arrays of k variables also by
            their base name, shape (n, k). Texts are left out.

        Raises
        ------
        FmuError
            If the unit refuses a call; says at which time and step.
        SignalError
            If a name, a shape, a type or a time is wrong; then nothing has been done.
        """
        rows = {name: self._rows(name, value, driven=True) for name, value in (inputs or {}).items()}
        points = np.asarray(times, dtype=float)
        n = self._number_of_steps(points, [len(values) for values in rows.values()])
        wrong = [f"{name} has {len(values)}" for name, values in rows.items() if len(values) != n]
        if wrong:
            msg = f"{self.name}: {n} steps, but {', '.join(wrong)} rows; an input has one row per step."
            raise SignalError(msg)
        setters = self._setters(rows)
        table = np.empty((n, len(self._output_variables)))
        for k in range(n):
            for setter, references, values in setters:
                self._call(setter, references, values[k])
            if points.ndim == 0:
                self.step(float(points))
            else:
                self._do_step(float(points[k + 1]) - self.time)
                self._origin, self._h, self._k = float(points[k + 1]), 0.0, 0
            table[k] = self._row()
        return self._grouped(table)

    def close(self) -> None:
        """Terminate and free the instance, and remove what was unpacked; again does nothing.

        Raises
        ------
        FmuError
            If the unit does not terminate; it is freed nevertheless.
        """
        try:
            if self._initialized and self._worst == 0:
                self._call("terminate")
        finally:
            self._initialized = False
            self._opened.close()

    def __enter__(self) -> "OpenedFmu":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _load(self) -> None:
        """Unpack, load and instantiate."""
        if not self.path.is_file():
            msg = f"{self.path.absolute()}: no such FMU."
            raise FileNotFoundError(msg)
        folder = self._opened.enter_context(tempfile.TemporaryDirectory(prefix="adaptimp-"))
        try:
            description = fmpy.read_model_description(str(self.path))
            fmpy.extract(str(self.path), folder)
        except Exception as error:  # fmpy raises bare Exception
            msg = f"{self.path} is no FMU that fmpy can read: {error}"
            raise FmuError(msg) from error
        if not description.fmiVersion.startswith("2.") or description.coSimulation is None:
            msg = f"{self.path} is no co-simulation FMU of FMI 2.0; it is of FMI {description.fmiVersion}."
            raise FmuError(msg)
        self.name = description.modelName
        self._index(description.modelVariables)
        try:
            self._slave: Any = fmi2.FMU2Slave(
                guid=description.guid,
                unzipDirectory=folder,
                modelIdentifier=description.coSimulation.modelIdentifier,
                instanceName=self.name,
            )
        except Exception as error:  # fmpy raises bare Exception
            present = sorted(p.name for p in (Path(folder) / "binaries").glob("*"))
            msg = (
                f"{self.path}: no binary that loads on {fmpy.platform}; it has {', '.join(present) or 'none'}: {error}"
            )
            raise FmuError(msg) from error
        self._opened.callback(self._free)
        self._instantiate()

    def _instantiate(self) -> None:
        environment = register(self)
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
        self._callbacks.componentEnvironment = environment
        self._proxied = fmi2.fmi2CallbackFunctions()  # the struct that the unit knows is not touched again
        listen(self._callbacks)
        try:
            self._slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:  # fmpy raises bare Exception
            self._slave.component = None
            msg = f"{self.name}: fmi2Instantiate failed; {last_message(self)}."
            raise FmuError(msg) from error

    def _free(self) -> None:
        """Free the instance, unless nothing may be called any more, and unload the library."""
        if self._slave.component is None or self._worst == FATAL:
            self._slave.freeLibrary()
        else:
            self._slave.freeInstance()
        self._slave = None

    def _index(self, variables: Iterable[Any]) -> None:
        """Find the variables and the arrays."""
        self._variables = {v.name: v for v in variables}
        self._arrays = arrays(self._variables)
        self._driven = [
            name
            for name, v in self._variables.items()
            if v.causality == "input" or (v.causality == "parameter" and v.variability == "tunable")
        ]
        self._output_variables = [v for v in self._variables.values() if v.causality == "output" and v.type in _SETTERS]
        places = {v.name: i for i, v in enumerate(self._output_variables)}
        self._output_places: dict[str, int | list[int]] = dict(places)
        for base, elements in self._arrays.items():
            if all(name in places for name in elements):
                self._output_places[base] = [places[name] for name in elements]

    def _rows(self, name: str, value: Any, *, driven: bool = False) -> np.ndarray:
        """Values by row, shape (n, k), for the k variables of a name; `driven` ones must be inputs or tunable."""
        elements = self._elements(name)
        if driven and not set(elements) <= set(self._driven):
            msg = f"{self.name} has no input {name}; its inputs and tunable parameters are {listed(self._driven)}."
            raise SignalError(msg)
        try:
            array = np.asarray(value)
            array = array if array.dtype.kind == "U" else array.astype(float)
        except (TypeError, ValueError) as error:
            msg = f"{self.name}: {name} takes numbers, not {value!r}."
            raise SignalError(msg) from error
        shape = () if name in self._variables else (len(elements),)
        if array.ndim != 1 + len(shape) or array.shape[1:] != shape:
            needed, given = (("n", *shape), array.shape) if driven else (shape, array.shape[1:])
            text = f"({', '.join(map(str, needed))}{',' * (len(needed) == 1)})"
            msg = f"{self.name}: {name} takes an array of shape {text}, not {given}."
            raise SignalError(msg)
        return array.reshape(len(array), -1)

    def _elements(self, name: str) -> list[str]:
        """Names of the variables behind a name."""
        if name in self._variables:
            return [name]
        if name in self._arrays:
            return self._arrays[name]
        msg = f"{self.name} has no variable {name}; it has {listed(self._variables)}."
        raise SignalError(msg)

    def _setters(self, rows: Mapping[str, np.ndarray]) -> Calls:
        """The calls that set values; of shape (n, k) for each name."""
        by_setter: defaultdict[str, tuple[list[int], list[list[Any]]]] = defaultdict(lambda: ([], []))
        given: dict[str, str] = {}
        for name, values in rows.items():
            for element, column in zip(self._elements(name), values.T, strict=True):
                if given.setdefault(element, name) != name:
                    msg = f"{self.name}: {element} is given twice, also by {given[element]}."
                    raise SignalError(msg)
                variable = self._variables[element]
                references, columns = by_setter[_SETTERS.get(variable.type, "setString")]
                references.append(variable.valueReference)
                columns.append([typed(self.name, variable, value) for value in column.tolist()])
        return [
            (setter, references, [list(row) for row in zip(*columns, strict=True)])
            for setter, (references, columns) in by_setter.items()
        ]

    def _number_of_steps(self, points: np.ndarray, lengths: Sequence[int]) -> int:
        """From the communication points, which are checked, or else from the inputs."""
        if points.ndim == 0:
            self._require_step(float(points))
            if not lengths:
                msg = f"{self.name}: without inputs, drive needs all communication points, not the step alone."
                raise SignalError(msg)
            return lengths[0]
        if points.ndim != 1 or len(points) < 2 or not np.isfinite(points).all() or not np.all(np.diff(points) > 0):
            msg = f"{self.name}: times must be n + 1 finite, increasing communication points; got {points}."
            raise SignalError(msg)
        if abs(points[0] - self.time) > GRID_TOLERANCE * (points[1] - points[0]):
            msg = f"{self.name}: times begin at {points[0]:.12g} s, but the unit is at t = {self.time:.12g} s."
            raise SignalError(msg)
        return len(points) - 1

    def _require_step(self, h: float) -> None:
        if not (np.isfinite(h) and h > 0):
            msg = f"{self.name}: a step of {h!r} s at t = {self.time:.12g} s; it must be positive and finite."
            raise SignalError(msg)

    def _do_step(self, h: float) -> None:
        self._call("doStep", currentCommunicationPoint=self.time, communicationStepSize=h)
        self.steps += 1

    def _row(self) -> np.ndarray:
        """All outputs, float64, shape (number of outputs,)."""
        row = np.empty(len(self._output_variables))
        for kind in {v.type for v in self._output_variables}:
            places = [i for i, v in enumerate(self._output_variables) if v.type == kind]
            references = [self._output_variables[i].valueReference for i in places]
            row[places] = self._call(_SETTERS[kind].replace("set", "get"), references)
        return row

    def _grouped(self, table: np.ndarray) -> dict[str, np.ndarray]:
        return {name: table[:, place].copy() for name, place in self._output_places.items()}

    def _call(self, function: str, *arguments: Any, **named: Any) -> Any:
        """Call the unit, by fmpy's name of the function."""
        if self._slave is None:
            msg = f"{self.name} is closed."
            raise FmuError(msg)
        listen(self._proxied)
        try:
            return getattr(self._slave, function)(*arguments, **named)
        except FMICallException as error:
            self._worst = max(self._worst, error.status)
            raise FmuError(failure(self, error)) from error


@pytest.fixture
def fmu() -> Iterator[Callable[..., OpenedFmu]]:
    """Opens FMUs as `open_fmu` does; they are freed after the test."""
    with ExitStack() as opened:

        def open_one(path: str | PathLike[str], /, **start: Value) -> OpenedFmu:
            return opened.enter_context(open_fmu(path, **start))

        yield open_one
