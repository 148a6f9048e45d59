"""Instances of a system's components, brought through FMI 2.0's initialization."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from orchestration.errors import InitializationError
from orchestration.fmi.codes import REAL, WORST_ACCEPTED, accepted
from orchestration.fmi.instance import Instance
from orchestration.fmi.library import needed_to_run
from orchestration.master.algebraic_loops import solve_loops
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.flat_system import (
    CALL_NAMES,
    END_DISCRETE,
    END_REAL,
    FIRST_DISCRETE,
    FIRST_REAL,
    copy_links,
    get_outputs,
    set_inputs,
)
from orchestration.sandbox.archive import unpacked
from orchestration.system.system import Component, System


@contextmanager
def opened(system: System) -> Iterator[list[Instance]]:
    """Instantiate every component, in order; all are freed at the end.

    Raises
    ------
    ArchiveError, InitializationError
    """
    with ExitStack() as stack:
        folders = {
            path: stack.enter_context(unpacked(path, needed_to_run))
            for path in dict.fromkeys(c.description.path for c in system.components)
        }
        instances = []
        for component in system.components:
            folder = folders[component.description.path]
            instance = Instance.open(component.name, component.description, folder)
            stack.callback(instance.close)
            scales = {
                component.variable(c.input).reference: c.scale
                for c in system.connections
                if c.target == component.name and not c.scale.trivial
            }
            if scales:
                instance.scale_inputs(scales)
            instances.append(instance)
        yield instances


def initialize(system: System, instances: Sequence[Instance], assembly: Assembly, t0: float) -> None:
    """Set start values, propagate outputs to inputs in initialization mode, and leave it.

    Outputs are transferred until nothing changes, so a chain of any length settles; what does not
    settle so is an algebraic loop, and solved. Afterwards the plan's outputs hold row 0.

    Raises
    ------
    InitializationError
        If a call fails, or an algebraic loop has no solution near the start values.
    """
    for component, instance in zip(system.components, instances, strict=True):
        set_values(component, instance, component.start)
        instance.set_up(t0)
        instance.call("fmi2EnterInitializationMode")
    _propagate(system, instances, assembly)
    for instance in instances:
        instance.call("fmi2ExitInitializationMode")
    _get_all(instances, assembly)


def set_values(component: Component, instance: Instance, values: Mapping[str, float]) -> None:
    """Set variables of an instance, one by one.

    Raises
    ------
    InitializationError
        If the unit refuses a value.
    """
    for name, value in values.items():
        variable = component.variable(name)
        number = int(value) if variable.type != REAL else value
        status = instance.set(variable.type, [variable.reference], [number])
        if not accepted(status):
            raise InitializationError(instance.failure(f"fmi2Set{variable.type}", status))


def _propagate(system: System, instances: Sequence[Instance], assembly: Assembly) -> None:
    plan = assembly.plan
    _get_all(instances, assembly)
    # A chain passes through each connection at most once; anything longer is an algebraic loop.
    for _ in range(len(system.connections) + 1):
        before = plan.reals.copy(), plan.discretes.copy()
        for i, instance in enumerate(instances):
            _transfer(assembly, i)
            _raise_failure(instance, *set_inputs(plan.table, i))
        _get_all(instances, assembly)
        if _same(before[0], plan.reals) and _same(before[1], plan.discretes):
            return

    def evaluate(i: int | None) -> None:
        for k in range(len(instances)) if i is None else (i,):
            row = plan.table[k]
            copy_links(plan.discrete_links, row[FIRST_DISCRETE], row[END_DISCRETE], plan.discretes)
            _raise_failure(instances[k], *set_inputs(plan.table, k))
            _raise_failure(instances[k], *get_outputs(plan.table, k))

    solve_loops(system.name, assembly, evaluate)
    settled = plan.discretes.copy()
    evaluate(None)
    if not _same(settled, plan.discretes):
        msg = f"System {system.name}: Integer or Boolean outputs do not settle during initialization."
        raise InitializationError(msg)


def _transfer(assembly: Assembly, i: int) -> None:
    """Copy what the sources of component i show to its inputs."""
    plan = assembly.plan
    row = plan.table[i]
    copy_links(plan.real_links, row[FIRST_REAL], row[END_REAL], plan.reals)
    copy_links(plan.discrete_links, row[FIRST_DISCRETE], row[END_DISCRETE], plan.discretes)


def _get_all(instances: Sequence[Instance], assembly: Assembly) -> None:
    for i, instance in enumerate(instances):
        _raise_failure(instance, *get_outputs(assembly.plan.table, i))


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    """Bitwise equality, so that NaN equals itself."""
    return a.tobytes() == b.tobytes()


def _raise_failure(instance: Instance, call: int, status: int) -> None:
    if status > WORST_ACCEPTED:
        raise InitializationError(instance.failure(CALL_NAMES[call], status, " during initialization"))
