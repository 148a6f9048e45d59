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
from orchestration.master.kernel.flat_system import (
    CALL_NAMES,
    DO_STEP,
    END_DISCRETE,
    END_REAL,
    FIRST_DISCRETE,
    FIRST_REAL,
    copy_links,
    get_outputs,
    set_inputs,
)
from orchestration.system.system import Component, System


class SavedComponent:
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
def operating_point(system: System, step: float, at: float) -> Iterator[list[SavedComponent]]:
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
        for k in range(n):
            _step(instances, assembly, k * step, step)
        saved = []
        for component, instance in zip(system.components, instances, strict=True):
            saved.append(SavedComponent(instance, component, connected(system, component.name), n * step))
            stack.callback(saved[-1].close)
        _fill_inputs(system, saved, assembly)
        yield saved


def connected(system: System, name: str) -> tuple[list[str], list[str]]:
    """Connected Real inputs and outputs of a component, in the order of its variables."""
    variables = system.component(name).description.variables.values()
    inputs = {c.input for c in system.connections if c.target == name}
    outputs = {c.output for c in system.connections if c.source == name}
    reals = [variable.name for variable in variables if variable.type == REAL]
    return [n for n in reals if n in inputs], [n for n in reals if n in outputs]


def _fill_inputs(system: System, saved: Sequence[SavedComponent], assembly: Assembly) -> None:
    """Let every one's inputs be what their sources show."""
    sources = {(c.target, c.input): f"{c.source}.{c.output}" for c in system.connections}
    for one in saved:
        shown = [assembly.real_outputs[sources[one.name, name]] for name in one.inputs]
        one.u[:] = assembly.plan.reals[shown]


def _step(instances: Sequence[Instance], assembly: Assembly, t: float, h: float) -> None:
    """One step of the coupled system, unit by unit."""
    plan = assembly.plan
    for i, instance in enumerate(instances):
        row = plan.table[i]
        copy_links(plan.real_links, row[FIRST_REAL], row[END_REAL], plan.reals)
        copy_links(plan.discrete_links, row[FIRST_DISCRETE], row[END_DISCRETE], plan.discretes)
        call, status = set_inputs(plan.table, i)
        if status <= WORST_ACCEPTED:
            call, status = DO_STEP, call_do_step(row[DO_STEP], instance.component, t, h)
        if status <= WORST_ACCEPTED:
            call, status = get_outputs(plan.table, i)
        if status > WORST_ACCEPTED:
            raise SimulationError(instance.failure(CALL_NAMES[call], status, f" at t = {t:.9g} s"))
