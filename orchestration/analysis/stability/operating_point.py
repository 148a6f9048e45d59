"""Units at an operating point, to be stepped from there as often as one likes.

The operating point is where the coupled system is after initialization, or after running on with
Gauss-Seidel. Every unit's state is saved there (fmi2GetFMUstate), and freed at the end.
"""

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from orchestration.errors import SimulationError, SystemDescriptionError
from orchestration.fmi.codes import INTERPOLATES, REAL, SAVES_STATE, WORST_ACCEPTED
from orchestration.fmi.instance import Instance
from orchestration.fmi.native_calls import call_do_step, call_rates, call_state, call_transfer
from orchestration.master.flatten import Assembly, assemble
from orchestration.master.initialization import initialize, opened
from orchestration.master.kernel import fixed_step
from orchestration.master.kernel.codes import CALL_NAMES, Column
from orchestration.master.kernel.step_program import operations_of_step
from orchestration.system.system import Component, System


class Probe:
    """A unit with its state saved.

    Parameters
    ----------
    inputs, outputs
        Names of the Real variables that are moved and watched.
    time
        Of the saved state, s.
    u
        Values of the inputs there, shape (n_inputs,).
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
        """Of the component."""
        return self.component.name

    def run(self, h: float, steps: Sequence[np.ndarray]) -> np.ndarray | None:
        """Step from the saved state.

        Parameters
        ----------
        h
            Step, s.
        steps
            For each step the inputs' values, and if they are to move their first, second, ... derivatives
            too: shape (order + 1, n_inputs).

        Returns
        -------
        ndarray or None
            Outputs at the end of each step, shape (n_steps, n_outputs); None if a step fails.
        """
        unit = self.instance
        y = np.empty((len(steps), len(self.outputs)))
        status = call_state(unit.address("fmi2SetFMUstate"), unit.component, self._state.value or 0)
        set_, get, step = (unit.address(f"fmi2{name}") for name in ("SetReal", "GetReal", "DoStep"))
        references, watched = self._input_references, self._output_references
        for k, inputs in enumerate(steps):
            values = np.ascontiguousarray(inputs, float)
            if references.size and status <= WORST_ACCEPTED:
                status = call_transfer(
                    set_, unit.component, references.ctypes.data, references.size, values.ctypes.data
                )
                if len(values) > 1 and status <= WORST_ACCEPTED:
                    status = self._move(values[1:])
            if status <= WORST_ACCEPTED:
                status = call_do_step(step, unit.component, self.time + k * h, h)
            if watched.size and status <= WORST_ACCEPTED:
                status = call_transfer(get, unit.component, watched.ctypes.data, watched.size, y[k].ctypes.data)
            if status > WORST_ACCEPTED:
                return None
        return y if np.isfinite(y).all() else None

    def close(self) -> None:
        """Return to the saved state and free it."""
        if self._state.value:
            self.instance.status("fmi2SetFMUstate", self._state)
            self.instance.status("fmi2FreeFMUstate", ctypes.byref(self._state))

    def _move(self, rates: np.ndarray) -> int:
        """Hand over derivatives, shape (order, n_inputs); returns the status."""
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
        return np.array([self.component.variable(name).reference for name in names], np.uint32)


@contextmanager
def operating_point(system: System, step: float, at: float) -> Iterator[list[Probe]]:
    """Probes of all components, in their order, `at` seconds into a run with steps of `step`.

    Parameters
    ----------
    step, at
        s; `at` is rounded down to an instant at which every sampled unit ticks.

    Raises
    ------
    SystemDescriptionError
        If a unit cannot save its state; naming all of these.
    SimulationError
        If the run fails.
    """
    unable = [c.name for c in system.components if not c.description.can(SAVES_STATE)]
    if unable:
        msg = (
            f"{', '.join(unable)}: canGetAndSetFMUstate is false, so no step can be repeated from one state;"
            " units that can save their state are needed."
        )
        raise SystemDescriptionError(msg)
    common = int(np.lcm.reduce([1, *system.steps_per_tick(step).values()]))
    n = int(at / (common * step) + 1e-9) * common
    with opened(system) as instances, ExitStack() as stack:
        assembly = assemble(system, instances, None)
        initialize(system, instances, assembly, 0.0)
        if n > 0:
            _run_on(instances, assembly, n, step)
        probes = []
        for component, instance in zip(system.components, instances, strict=True):
            probes.append(Probe(instance, component, connected(system, component.name), n * step))
            stack.callback(probes[-1].close)
        _fill_inputs(system, probes, assembly)
        yield probes


def connected(system: System, name: str) -> tuple[list[str], list[str]]:
    """Connected Real inputs and outputs of a component, in the order of its variables."""
    variables = system.component(name).description.variables.values()
    inputs = {c.input for c in system.connections if c.target == name}
    outputs = {c.output for c in system.connections if c.source == name}
    reals = [variable.name for variable in variables if variable.type == REAL]
    return [n for n in reals if n in inputs], [n for n in reals if n in outputs]


def _fill_inputs(system: System, probes: Sequence[Probe], assembly: Assembly) -> None:
    """Let every probe's inputs be what their sources show."""
    sources = {(c.target, c.input): f"{c.source}.{c.output}" for c in system.connections}
    for probe in probes:
        shown = [assembly.real_outputs[sources[probe.name, name]] for name in probe.inputs]
        probe.u[:] = assembly.plan.reals[shown]


def _run_on(instances: Sequence[Instance], assembly: Assembly, n: int, step: float) -> None:
    """Make n steps of the coupled system from t = 0 with Gauss-Seidel; record nothing."""
    operations = operations_of_step(assembly.plan, sequential=True)
    times, no_rows = step * np.arange(n + 1), np.empty((0, len(assembly.columns)))
    k, j, status = fixed_step.run(operations, assembly.plan, (times, np.array([step])), (0, n), no_rows, n + 1)
    if k < n:
        failed = operations[int(j)]
        name, where = CALL_NAMES[Column(failed.call)], f" at t = {times[k]:.9g} s"
        raise SimulationError(instances[failed.subject].failure(name, status, where))
