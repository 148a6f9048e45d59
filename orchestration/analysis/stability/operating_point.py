"""The operating point of a coupled system: its components with saved states, for repeated experiments.

The operating point is the state of the system after initialization, or after a run by the Gauss-Seidel
algorithm. The state of every component is saved there (fmi2GetFMUstate). Every experiment starts from the
saved state. All saved states are freed at the end.
"""

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from orchestration.errors import SimulationError, SystemDescriptionError
from orchestration.fmi.codes import INTERPOLATES, REAL, SAVES_STATE, WORST_ACCEPTED
from orchestration.fmi.display import listed
from orchestration.fmi.instance import Instance
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.native_calls import call_do_step, call_rates, call_state, call_transfer
from orchestration.master.flatten import Assembly, assemble
from orchestration.master.initialization import initialize, opened
from orchestration.master.kernel import fixed_step
from orchestration.master.kernel.codes import CALL_NAMES, Column
from orchestration.master.kernel.step_program import operations_of_step
from orchestration.master.safeguard import exposed
from orchestration.sandbox.guard import Guard
from orchestration.system.system import Component, System


class SavedComponent:
    """A component whose state is saved, so that an experiment can start from the same state many times.

    Parameters
    ----------
    instance
        Running instance of the component's FMU.
    component
        Member of the system.
    ports
        Names of the Real inputs that an experiment changes, and of the Real outputs that it records.
    time
        Time of the saved state, s.

    Attributes
    ----------
    inputs, outputs
        The two tuples of `ports`.
    u
        Values of the inputs at the operating point, shape (n_inputs,), in the units of the inputs.

    Raises
    ------
    SimulationError
        If the FMU fails to save its state.
    """

    def __init__(
        self, instance: Instance, component: Component, ports: tuple[Sequence[str], Sequence[str]], time: float
    ) -> None:
        self.component, self.instance, self.time = component, instance, time
        self.inputs, self.outputs = tuple(ports[0]), tuple(ports[1])
        self.interpolates = component.description.can(INTERPOLATES)
        self.u = np.zeros(len(self.inputs))
        self._input_references = self._references(self.inputs)
        self._output_references = self._references(self.outputs)
        self._state = ctypes.c_void_p()
        instance.call("fmi2GetFMUstate", ctypes.byref(self._state))

    @property
    def name(self) -> str:
        """Name of the component."""
        return self.component.name

    def run(self, h: float, steps: np.ndarray) -> np.ndarray | None:
        """Run several steps from the saved state, and record the outputs.

        Parameters
        ----------
        h
            Step, s.
        steps
            Inputs of each step, shape (n_steps, order + 1, n_inputs): values at the start of the step,
            then the first, second, ... derivatives in time. An order of 0 holds the inputs during a step.

        Returns
        -------
        ndarray or None
            Outputs at the end of each step, shape (n_steps, n_outputs); None if a step fails.
        """
        instance = self.instance
        y = np.empty((len(steps), len(self.outputs)))
        status = call_state(instance.address("fmi2SetFMUstate"), instance.component, self._state.value or 0)
        set_, get, step = (instance.address(f"fmi2{name}") for name in ("SetReal", "GetReal", "DoStep"))
        references, watched = self._input_references, self._output_references
        for k, inputs in enumerate(steps):
            values = np.ascontiguousarray(inputs, float)
            if references.size and status <= WORST_ACCEPTED:
                status = call_transfer(
                    set_, instance.component, references.ctypes.data, references.size, values.ctypes.data
                )
                if len(values) > 1 and status <= WORST_ACCEPTED:
                    status = self._move(values[1:])
            if status <= WORST_ACCEPTED:
                status = call_do_step(step, instance.component, self.time + k * h, h)
            if watched.size and status <= WORST_ACCEPTED:
                status = call_transfer(get, instance.component, watched.ctypes.data, watched.size, y[k].ctypes.data)
            if status > WORST_ACCEPTED:
                return None
        return y if np.isfinite(y).all() else None

    def close(self) -> None:
        """Restore the saved state, and free the memory of the saved state."""
        if self._state.value:
            self.instance.status("fmi2SetFMUstate", self._state)
            self.instance.status("fmi2FreeFMUstate", ctypes.byref(self._state))

    def _move(self, rates: np.ndarray) -> int:
        """Set the time derivatives of the inputs, shape (order, n_inputs), and return the FMI status."""
        order = np.repeat(np.arange(1, len(rates) + 1, dtype=np.int32), len(self.inputs))
        references = np.tile(self._input_references, len(rates))
        return call_rates(
            self.instance.address("fmi2SetRealInputDerivatives"),
            self.instance.component,
            references.ctypes.data,
            references.size,
            order.ctypes.data,
            np.ascontiguousarray(rates).ctypes.data,
        )

    def _references(self, names: Sequence[str]) -> np.ndarray:
        """Value references of variables, for the calls of the FMU."""
        return np.array([self.component.variable(name).reference for name in names], np.uint32)


@contextmanager
def operating_point(
    system: System, step: float, at: float, isolation: Isolation | None = None, guard: Guard | None = None
) -> Iterator[list[SavedComponent]]:
    """Bring a system to its operating point, and save the states of all components there.

    Parameters
    ----------
    system
        System whose components can save their states.
    step
        Communication step of the run to the operating point, s.
    at
        Time of the operating point, s. It is rounded down to an instant at which every sampled component
        ticks.
    isolation
        Which FMUs live in processes of their own.
    guard
        Puts back what an FMU changes in this process, at the end of the context too. Default: a guard of its own.

    Yields
    ------
    list of SavedComponent
        All components, in the order of the system. They can be used within the context only.

    Raises
    ------
    SystemDescriptionError
        If a component cannot save its state; the message names all such components.
    SimulationError
        If the run to the operating point fails, or a connected output is not finite there.
    """
    unable = [c.name for c in system.components if not c.description.can(SAVES_STATE)]
    if unable:
        msg = (
            f"{', '.join(unable)}: canGetAndSetFMUstate is false, so no step can be repeated from one state;"
            " components that can save their state are needed."
        )
        raise SystemDescriptionError(msg)
    common = int(np.lcm.reduce([1, *system.steps_per_tick(step).values()]))
    n = int(at / (common * step) + 1e-9) * common
    guard = guard or Guard()
    with opened(system, isolation, guard) as instances, ExitStack() as stack:
        assembly = assemble(system, instances, None)
        initialize(system, instances, assembly, 0.0, guard=guard)
        stack.enter_context(guard.over(exposed(instances), "while its stability was judged"))
        if n > 0:
            _run_on(instances, assembly, n, step)
        _require_finite(system, assembly, n * step)
        saved = []
        for component, instance in zip(system.components, instances, strict=True):
            saved.append(SavedComponent(instance, component, connected(system, component.name), n * step))
            stack.callback(saved[-1].close)
        _fill_inputs(system, saved, assembly)
        yield saved


def connected(system: System, name: str) -> tuple[list[str], list[str]]:
    """Names of the connected Real inputs and outputs of a component, in the order of its variables.

    Reals that stand for Booleans or Integers are left out, because such values cannot be moved a little.
    """
    variables = system.component(name).description.variables.values()
    inputs = {c.input for c in system.connections if c.target == name}
    outputs = {c.output for c in system.connections if c.source == name}
    reals = [variable.name for variable in variables if variable.type == REAL and not variable.stands_for]
    return [n for n in reals if n in inputs], [n for n in reals if n in outputs]


def _require_finite(system: System, assembly: Assembly, time: float) -> None:
    """Refuse an operating point, at a time in s, at which a connected output is not finite."""
    names = dict.fromkeys(system.sources.values())
    values = {name: assembly.plan.reals[assembly.real_outputs[name]] for name in names if name in assembly.real_outputs}
    wrong = [f"{name} = {value:g}" for name, value in values.items() if not np.isfinite(value)]
    if wrong:
        msg = f"{listed(wrong)} at t = {time:.9g} s: a verdict on stability needs finite values; choose another time."
        raise SimulationError(msg)


def _fill_inputs(system: System, saved: Sequence[SavedComponent], assembly: Assembly) -> None:
    """Set the inputs `u` of every component to the connected outputs."""
    sources = {(c.target, c.input): f"{c.source}.{c.output}" for c in system.connections}
    for one in saved:
        shown = [assembly.real_outputs[sources[one.name, name]] for name in one.inputs]
        one.u[:] = assembly.plan.reals[shown]


def _run_on(instances: Sequence[Instance], assembly: Assembly, n: int, step: float) -> None:
    """Make n steps of the coupled system from t = 0 by the Gauss-Seidel algorithm, without a record."""
    operations = operations_of_step(assembly.plan, sequential=True)
    times, no_rows = step * np.arange(n + 1), np.empty((0, len(assembly.columns)))
    k, j, status = fixed_step.run(operations, assembly.plan, (times, np.array([step])), (0, n), no_rows, n + 1)
    if k < n:
        failed = operations[int(j)]
        name, where = CALL_NAMES[Column(failed.call)], f" at t = {times[k]:.9g} s"
        raise SimulationError(instances[failed.subject].failure(name, status, where))
