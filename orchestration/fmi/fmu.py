"""Opens a single FMU and drives it with arrays of inputs, without a system.

    from orchestration import Fmu

    with Fmu("Plant.fmu", q_start=[0.3, 1.0], dq_start=[0.0, 0.0]) as plant:
        rows = plant.drive(1e-3, {"tau": np.zeros((100, 2))})
        rows["q"]  # shape (100, 2)

Any FMI 2.0 co-simulation FMU for this machine can be opened, whichever tool wrote it. A name is that of a variable,
``tau[1]``, or of an array, ``tau``; see `orchestration.fmi.arrays`.

Over step k, from t_k to t_k + h, the inputs are those of row k, set at t_k; row k of the outputs is what the
FMU shows at the end of the step.
"""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from os import PathLike
from types import TracebackType
from typing import Any, Self
from weakref import finalize

import numpy as np

from orchestration.errors import InitializationError, SignalError, SimulationError, printable
from orchestration.fmi.arrays import Signals, Value
from orchestration.fmi.codes import Status, accepted
from orchestration.fmi.description import Variable, read_description
from orchestration.fmi.display import Variables, escaped, variables_html
from orchestration.fmi.experiment import Experiment
from orchestration.fmi.given import a_number, a_path
from orchestration.fmi.instance import Instance
from orchestration.fmi.library import needed_to_run
from orchestration.fmi.logging import Messages
from orchestration.fmi.saved_state import SavedState, with_head, without_head
from orchestration.fmi.start_values import by_time
from orchestration.fmi.step_times import as_times, number_of_steps, require_step
from orchestration.sandbox.archive import unpacked
from orchestration.sandbox.guard import Guard

_REMEDY = "run it as a component of a System with isolate=True"


class Fmu:
    """An FMU, initialized and ready to step; a context manager that closes it.

    Parameters
    ----------
    path
        The .fmu file.
    start
        Start values by name: a number, a text, or an array (k,) for an array of k variables.
    start_time
        Time of the initialization, s.
    stop_time
        Last time of the experiment, s, if the FMU is to know it.
    tolerance
        Relative tolerance that the FMU is told. Default: that of its default experiment, if any.
    **values
        More start values, for names that Python can write.

    Attributes
    ----------
    name
        Model name, which begins the messages of errors.
    messages
        What the FMU logged, oldest first.
    steps
        Number of steps done.

    Raises
    ------
    ArchiveError
        If there is no such file, or it is not an FMU for co-simulation with FMI 2.0 on this machine.
    InitializationError
        If the FMU refuses its start values.
    SignalError
        If a start value has a wrong name, shape or type.

    Examples
    --------
    >>> import numpy as np
    >>> from orchestration import Fmu, scenario
    >>> file = scenario("fig2")["plant"].path  # any FMU of yours
    >>> with Fmu(file, q_start=[0.3, 1.0], dq_start=[0.0, 0.0]) as plant:
    ...     rows = plant.drive(1e-3, {"tau": np.full((100, 2), 0.5)})  # N.m, a row for each step of 1 ms
    ...     print(plant, rows["q"].shape, rows["q"][-1].round(4))
    <Fmu Plant at t = 0.1 s> (100, 2) [0.2995 1.0033]

    Without a ``with`` block, close it yourself:

    >>> plant = Fmu(file)
    >>> plant.variables["m[1]"].unit, plant.time
    ('kg', 0.0)
    >>> before = plant.save()
    >>> plant.step(1e-3)
    >>> plant.restore(before)
    >>> plant.close()
    """

    def __init__(
        self,
        path: str | PathLike[str],
        start: Mapping[str, Value] | None = None,
        /,
        *,
        start_time: float = 0.0,
        stop_time: float | None = None,
        tolerance: float | None = None,
        **values: Value,
    ) -> None:
        self.path = a_path("An FMU", path)
        self.description = read_description(self.path)
        self.name = self.description.model_name
        self.messages, self.steps = Messages(None), 0
        self._signals = Signals(self.name, self.description.variables)
        self._origin = a_number(f"{self.name}: the start time", start_time, SignalError)
        self._h, self._k = 0.0, 0
        self._saved: list[Any] = []
        self._initialized, self._guard = False, Guard(_REMEDY)
        with self._guard.over([self.name], "while it was opened"), ExitStack() as opened:
            folder = opened.enter_context(unpacked(self.description.path, needed_to_run))
            self._instance = Instance.open(self.name, self.description, folder, messages=self.messages)
            opened.callback(_free, self._instance, self._guard)
            others, inputs = by_time(self.description, {**(start or {}), **values})
            self.set(others)
            given = (("stop time", stop_time), ("tolerance", tolerance or self.description.experiment.tolerance))
            numbers = (None if v is None else a_number(f"{self.name}: the {what}", v, SignalError) for what, v in given)
            known = Experiment(None, *numbers).told
            self._call("fmi2SetupExperiment", *known[0], self.time, *known[1])
            self._call("fmi2EnterInitializationMode")
            self.set(inputs)
            self._call("fmi2ExitInitializationMode")
            self._opened = opened.pop_all()
        # Frees an FMU that nobody closes, such as one whose program went on after an error.
        self._forgotten = finalize(self, self._opened.close)
        self._initialized = True

    def __repr__(self) -> str:
        state = f"at t = {self.time:.12g} s" if self._instance.is_open else "closed"
        return printable(f"<Fmu {self.name} {state}>")

    def _repr_html_(self) -> str:
        state = f"at t = {self.time:.12g} s" if self._instance.is_open else "closed"
        table = variables_html(self.variables, {})
        return f"<div><p><b>FMU {escaped(self.name)}</b> {state}; {escaped(self.path.name)}</p>{table}</div>"

    @property
    def variables(self) -> Mapping[str, Variable]:
        """All variables by name."""
        return Variables(self.description.variables)

    @property
    def time(self) -> float:
        """Time of the FMU, s: t0 + k h for k equal steps, not a sum."""
        return self._origin + self._k * self._h

    def outputs(self) -> dict[str, np.ndarray]:
        """Outputs as they are now, by name, float64: of shape (), arrays of shape (k,).

        Examples
        --------
        >>> from orchestration import Fmu, scenario
        >>> with Fmu(scenario("fig2")["plant"].path) as plant:
        ...     print(plant.outputs()["dq"].round(3), plant.outputs()["gap"].round(3))  # rad/s, m
        [2.094 0.   ] -2.95
        """
        return {name: values[0] for name, values in self._signals.grouped(self._row()[None, :]).items()}

    def set(self, values: Mapping[str, Value] | None = None, /, **more: Value) -> None:
        """Set inputs, or tunable parameters, by name: a number, or an array (k,) for an array of k variables.

        One element goes as ``set({"tau[1]": 2.5})``.

        Raises
        ------
        SimulationError
            If the FMU refuses.
        SignalError
            If a name, a shape or a type is wrong; then nothing is set.

        Examples
        --------
        >>> from orchestration import Fmu, scenario
        >>> with Fmu(scenario("fig2")["plant"].path) as plant:
        ...     plant.set(tau=[0.5, 0.0])  # N.m
        ...     plant.set({"tau[2]": 0.1})
        """
        given = {**(values or {}), **more}
        rows = {name: self._signals.rows(name, [value]) for name, value in given.items()}
        for kind, references, (row,) in self._signals.calls(rows):
            self._set(kind, references, row)

    def step(self, h: float) -> None:
        """Advance by one step of h seconds.

        Raises
        ------
        SimulationError
            If the FMU does not accept the step.
        SignalError
            If h is not positive.

        Examples
        --------
        >>> from orchestration import Fmu, scenario
        >>> with Fmu(scenario("fig2")["plant"].path) as plant:
        ...     while plant.outputs()["x[1]"] > 1.4:  # m
        ...         plant.step(1e-3)
        ...     print(f"{plant.time:.3f} s")
        0.377 s
        """
        require_step(self.name, self.time, h)
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
            Length of the n steps, s; or all n + 1 communication points, s, the first of them the FMU's time.
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
        SimulationError
            If the FMU refuses a call; says at which time and step.
        SignalError
            If a name, a shape, a type or a time is wrong; then nothing has been done.

        Examples
        --------
        >>> import numpy as np
        >>> from orchestration import Fmu, scenario
        >>> times = np.linspace(0.0, 0.5, 501)  # s
        >>> torques = np.column_stack([np.sin(times[:-1]), np.zeros(500)])  # N.m
        >>> with Fmu(scenario("fig2")["plant"].path) as plant:
        ...     rows = plant.drive(times, {"tau": torques})
        >>> rows["q"].shape, rows["gap"].shape
        ((500, 2), (500,))
        """
        rows = {name: self._signals.rows(name, value, driven=True) for name, value in (inputs or {}).items()}
        points = as_times(self.name, times)
        n = number_of_steps(self.name, points, self.time, [len(values) for values in rows.values()])
        wrong = [f"{name} has {len(values)}" for name, values in rows.items() if len(values) != n]
        if wrong:
            msg = f"{self.name}: {n} steps, but {', '.join(wrong)} rows; an input has one row per step."
            raise SignalError(msg)
        calls = self._signals.calls(rows)
        table = np.empty((n, len(self._signals.outputs)))
        with self._guard.over([self.name], f"in a step after t = {self.time:.9g} s"):
            for k in range(n):
                for kind, references, values in calls:
                    self._set(kind, references, values[k])
                if points.ndim == 0:
                    self.step(float(points))
                else:
                    self._do_step(float(points[k + 1]) - self.time)
                    self._origin, self._h, self._k = float(points[k + 1]), 0.0, 0
                table[k] = self._row()
        return self._signals.grouped(table)

    def save(self) -> bytes | SavedState:
        """The state, time included: bytes if the FMU serializes, which another process may restore.

        Raises
        ------
        SystemDescriptionError
            If the FMU saves no state.
        SimulationError
            If a call fails.

        Examples
        --------
        >>> from orchestration import Fmu, scenario
        >>> with Fmu(scenario("fig2")["plant"].path) as plant:
        ...     plant.step(1e-3)
        ...     state = plant.save()
        ...     plant.step(1e-3)
        ...     plant.restore(state)
        ...     print(plant.time)
        0.001
        """
        self._require_open()
        with self._guard.over_call(self.name, "fmi2GetFMUstate"):
            state = self._instance.save()
        if not isinstance(state, bytes):
            self._saved.append(state)
        return with_head(state, self.description.guid, (self._origin, self._h, self._k, self.steps), self)

    def restore(self, state: bytes | SavedState) -> None:
        """Go back to a state that `save` returned.

        Raises
        ------
        SignalError
            If it is the state of another FMU.
        SimulationError
            If the FMU refuses it.
        """
        self._require_open()
        own, clock = without_head(self.name, self.description.guid, state, self)
        with self._guard.over_call(self.name, "fmi2SetFMUstate"):
            self._instance.restore(own)
        self._origin, self._h, self._k, self.steps = clock

    def close(self) -> None:
        """Terminate and free the instance, and remove what was unpacked; again does nothing.

        Raises
        ------
        SimulationError
            If the FMU does not terminate; it is freed nevertheless.
        """
        initialized, self._initialized = self._initialized, False
        self._forgotten.detach()
        with self._guard.over([self.name], "while it was closed"), self._opened:
            if self._instance.worst != Status.FATAL:
                for state in self._saved:
                    self._instance.free_state(state)
            self._saved.clear()
            if initialized and self._instance.worst <= Status.WARNING:
                self._call("fmi2Terminate")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _do_step(self, h: float) -> None:
        self._call("fmi2DoStep", self.time, h, 1)
        self.steps += 1

    def _row(self) -> np.ndarray:
        """All outputs, float64, shape (number of outputs,)."""
        outputs = self._signals.outputs
        row = np.empty(len(outputs))
        for kind in dict.fromkeys(v.type for v in outputs):
            places = [i for i, v in enumerate(outputs) if v.type == kind]
            self._require_open()
            with self._guard.over_call(self.name, f"fmi2Get{kind}"):
                status, row[places] = self._instance.get(kind, [outputs[i].reference for i in places])
            self._require_accepted(f"fmi2Get{kind}", status)
        return row

    def _set(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        self._require_open()
        with self._guard.over_call(self.name, f"fmi2Set{kind}"):
            status = self._instance.set(kind, references, values)
        self._require_accepted(f"fmi2Set{kind}", status)

    def _call(self, function: str, *arguments: Any) -> None:
        self._require_open()
        with self._guard.over_call(self.name, function):
            status = self._instance.status(function, *arguments)
        self._require_accepted(function, status)

    def _require_open(self) -> None:
        if not self._instance.is_open:
            msg = f"{self.name} is closed; open it again, as Fmu({self.path.name!r})."
            raise SimulationError(msg)

    def _require_accepted(self, function: str, status: int) -> None:
        if not accepted(status):
            where = f" at t = {self.time:.12g} s (step {self.steps})"
            error = SimulationError if self._initialized else InitializationError
            raise error(self._instance.failure(function, status, where))


def _free(instance: Instance, guard: Guard) -> None:
    """Free an instance, also one that nobody has closed."""
    with guard.over_call(instance.name, "fmi2FreeInstance"):
        instance.close()
